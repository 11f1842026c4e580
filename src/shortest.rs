//! Numbers as people and files read them.

use std::fmt::{Display, Formatter, Result};

/// A number in the fewest digits that give it back, with an exponent where it is very
/// large or small: 1e200, not 201 digits. Every number in a message is printed this way: one that the standard
/// library prints takes 27 kB of the FMU's binary.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shortest(pub f64);

impl Display for Shortest {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> Result {
        let mut digits = zmij::Buffer::new();
        let digits = digits.format(self.0);
        let digits = digits.strip_suffix(".0").unwrap_or(digits);
        let (sign, size) = match digits.strip_prefix('-') {
            Some(size) => ("-", size),
            None => ("", digits),
        };
        // As the standard library has it: 1e-5, not 0.00001, and 1e200, not 1e+200.
        if let Some(figures) = size.strip_prefix("0.0000") {
            let (first, rest) = figures.split_at(1);
            let point = if rest.is_empty() { "" } else { "." };
            return write!(formatter, "{sign}{first}{point}{rest}e-5");
        }
        digits
            .split('+')
            .try_for_each(|part| formatter.write_str(part))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_is_short_and_comes_back() {
        for (number, text) in [
            (1000.0, "1000"),
            (0.05, "0.05"),
            (0.0001, "0.0001"),
            (1e-5, "1e-5"),
            (-3.25e-5, "-3.25e-5"),
            (9.5e-6, "9.5e-6"),
            (1e15, "1000000000000000"),
            (1e16, "1e16"),
            (-1e200, "-1e200"),
            (0.0, "0"),
            (5e-324, "5e-324"),
            (f64::INFINITY, "inf"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(Shortest(number).to_string(), text);
        }
        assert_eq!(Shortest(0.1 + 0.2).to_string().parse(), Ok(0.1 + 0.2));
    }
}

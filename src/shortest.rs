//! Numbers as people and files read them.

use std::fmt::{Display, Formatter, Result};

/// A number in the fewest digits that give it back, with an exponent where it is very
/// large or small: 1e200, not 201 digits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shortest(pub f64);

impl Display for Shortest {
    fn fmt(&self, formatter: &mut Formatter<'_>) -> Result {
        let digits = format!("{:?}", self.0);
        formatter.write_str(digits.strip_suffix(".0").unwrap_or(&digits))
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
            (-1e200, "-1e200"),
            (5e-324, "5e-324"),
            (f64::INFINITY, "inf"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(Shortest(number).to_string(), text);
        }
        assert_eq!(Shortest(0.1 + 0.2).to_string().parse(), Ok(0.1 + 0.2));
    }
}

//! The GUID: a hash, by the compiler, of what the description says.

use super::LOG_CATEGORIES;
use crate::model::Model;
use crate::model::variables::{Access, Kind, Variable};

/// `{8-4-4-4-12}` hexadecimal digits.
pub type Text = [u8; 38];

/// The GUID as a text.
///
/// # Panics
/// If it is not ASCII; at compile time.
#[must_use]
pub const fn text(digits: &Text) -> &str {
    match std::str::from_utf8(digits) {
        Ok(text) => text,
        Err(_) => panic!("a GUID is ASCII"),
    }
}

/// The GUID that ties the binary of a model to its description. It follows from the table
/// of variables, the log categories and the version: a changed table cannot
/// keep it, and the same table gives the same one on each build.
#[must_use]
pub const fn of<M: Model>() -> Text {
    let hash = table::<M>();
    let mut text = *b"{00000000-0000-0000-0000-000000000000}";
    let (mut place, mut digit) = (1, 0);
    while digit < 32 {
        if text[place] == b'-' {
            place += 1;
        }
        text[place] = b"0123456789abcdef"[(hash >> (124 - 4 * digit)) as usize & 0xf];
        place += 1;
        digit += 1;
    }
    text
}

const fn table<M: Model>() -> u128 {
    let mut hash = Hash::new()
        .text(M::IDENTIFIER)
        .text(env!("CARGO_PKG_VERSION"));
    let mut i = 0;
    while i < M::VARIABLES.len() {
        hash = hash.variable(&M::VARIABLES[i]);
        i += 1;
    }
    let mut i = 0;
    while i < M::ALIASES.len() {
        let alias = &M::ALIASES[i];
        hash = hash.text(alias.name).text(alias.description).text(alias.of);
        i += 1;
    }
    let mut i = 0;
    while i < LOG_CATEGORIES.len() {
        hash = hash.text(LOG_CATEGORIES[i].0).text(LOG_CATEGORIES[i].1);
        i += 1;
    }
    hash.0
}

/// FNV-1a of 128 bits (G. Fowler, L. C. Noll, K.-P. Vo).
struct Hash(u128);

impl Hash {
    const fn new() -> Hash {
        Hash(0x6c62272e07bb014262b821756295c58d)
    }

    const fn byte(self, byte: u8) -> Hash {
        Hash((self.0 ^ byte as u128).wrapping_mul(0x0000000001000000000000000000013b))
    }

    const fn bytes(mut self, bytes: &[u8]) -> Hash {
        let mut i = 0;
        while i < bytes.len() {
            self = self.byte(bytes[i]);
            i += 1;
        }
        self
    }

    /// A text and its end.
    const fn text(self, text: &str) -> Hash {
        self.bytes(text.as_bytes()).byte(0)
    }

    const fn number(self, number: Option<f64>) -> Hash {
        match number {
            Some(value) => self.byte(1).bytes(&value.to_bits().to_le_bytes()),
            None => self.byte(0),
        }
    }

    const fn variable<M: Model>(self, variable: &Variable<M>) -> Hash {
        let hash = self
            .text(variable.name)
            .text(variable.description)
            .byte(variable.causality as u8)
            .byte(variable.variability as u8)
            .text(variable.unit.name)
            .number(variable.start);
        let hash = match variable.kind {
            Kind::Real { min, max, nominal } => hash
                .byte(1)
                .number(Some(min))
                .number(Some(max))
                .number(Some(nominal)),
            Kind::Boolean => hash.byte(2),
            Kind::Enumeration(enumeration) => {
                let mut hash = hash.byte(3).text(enumeration.name);
                let mut i = 0;
                while i < enumeration.items.len() {
                    let (name, meaning) = enumeration.items[i];
                    hash = hash.text(name).text(meaning);
                    i += 1;
                }
                hash
            }
        };
        let hash = match variable.derivative_of {
            Some(state) => hash.byte(1).text(state),
            None => hash.byte(0),
        };
        match variable.access {
            Access::Input { .. } => hash.byte(1),
            Access::Setting { .. } => hash.byte(2),
            Access::Result { dependencies, .. } => hash
                .byte(3)
                .texts(dependencies.now)
                .texts(dependencies.at_start),
        }
    }

    const fn texts(mut self, texts: &[&str]) -> Hash {
        let mut i = 0;
        while i < texts.len() {
            self = self.text(texts[i]);
            i += 1;
        }
        self.byte(0)
    }
}

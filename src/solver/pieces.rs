//! The segments of a motion that are kept, one after another without a gap.

use serde::{Deserialize, Serialize};

use super::State;
use super::double::Double;
use super::segment::Segment;

/// Pieces kept to find an orbit; an orbit near a saddle takes about 20.
pub const CAPACITY: usize = 48;

/// A segment and the time at which it begins, counted from the trajectory's origin.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Piece {
    /// Time at which it begins.
    pub begin: Double,
    /// The motion from there on.
    pub segment: Segment,
}

impl Piece {
    /// Time at which it ends.
    pub fn end(&self) -> Double {
        self.begin.plus(self.segment.length())
    }
}

/// The pieces in use. Stored as a plain list of them, so that a state that is
/// saved holds no more than is needed.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(into = "Vec<Piece>", try_from = "Vec<Piece>")]
pub struct Pieces {
    /// One more than are kept, to solve the next one in.
    held: [Piece; CAPACITY + 1],
    count: usize,
}

impl Pieces {
    /// No piece.
    pub fn none() -> Pieces {
        let nothing = Piece {
            begin: Double::ZERO,
            segment: Segment::nothing(State {
                position: 0.0,
                rate: 0.0,
            }),
        };
        Pieces {
            held: [nothing; CAPACITY + 1],
            count: 0,
        }
    }

    /// Number of pieces in use.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Forgets all pieces.
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// The pieces in use.
    pub fn list(&self) -> &[Piece] {
        &self.held[..self.count]
    }

    /// A piece in use.
    pub fn piece(&mut self, index: usize) -> &mut Piece {
        &mut self.held[index]
    }

    /// The last piece.
    pub fn last(&mut self) -> Option<&mut Piece> {
        self.held[..self.count].last_mut()
    }

    /// A segment that is not in use, to solve the next one in beside the
    /// others, which stand until it is done.
    pub fn spare(&mut self) -> &mut Segment {
        &mut self.held[self.count].segment
    }

    /// Takes the spare segment into use, after the others or in place of them.
    pub fn take_spare(&mut self, begin: Double, after_others: bool) {
        if after_others && self.count < CAPACITY {
            self.held[self.count].begin = begin;
            self.count += 1;
        } else {
            self.held.swap(0, self.count);
            self.held[0].begin = begin;
            self.count = 1;
        }
    }

    /// The piece of `time`, looked for from the piece `near` on; at a border
    /// the one before if `near` lies before.
    pub fn find(&self, time: Double, near: usize) -> usize {
        let pieces = self.list();
        let mut index = near;
        while index + 1 < pieces.len() && time.since(pieces[index + 1].begin) > 0.0 {
            index += 1;
        }
        while index > 0 && time.since(pieces[index].begin) < 0.0 {
            index -= 1;
        }
        index
    }
}

impl From<Pieces> for Vec<Piece> {
    fn from(pieces: Pieces) -> Vec<Piece> {
        pieces.list().to_vec()
    }
}

impl TryFrom<Vec<Piece>> for Pieces {
    type Error = &'static str;

    fn try_from(list: Vec<Piece>) -> Result<Pieces, &'static str> {
        if list.len() > CAPACITY {
            return Err("more pieces than a trajectory keeps");
        }
        let mut pieces = Pieces::none();
        let mut end = Double::ZERO;
        for mut piece in list {
            let follows = piece.begin.since(end).abs() <= 1e-9 * piece.segment.length();
            if !(piece.segment.is_sound() && follows) {
                return Err("a piece of the trajectory is damaged");
            }
            piece.segment.expand();
            end = piece.end();
            pieces.held[pieces.count] = piece;
            pieces.count += 1;
        }
        Ok(pieces)
    }
}

//! The segments of a motion that are kept, one after another without a gap.

use serde::{Deserialize, Serialize};

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

/// The pieces in use.
#[derive(Debug, Serialize, Deserialize)]
#[serde(into = "Vec<Piece>", try_from = "Vec<Piece>")]
pub struct Pieces {
    /// With room for as many as are kept, so that none is ever allocated later.
    held: Vec<Piece>,
}

impl Clone for Pieces {
    fn clone(&self) -> Pieces {
        let mut pieces = Pieces::none();
        pieces.held.extend_from_slice(&self.held);
        pieces
    }
}

impl Pieces {
    /// No piece.
    pub fn none() -> Pieces {
        Pieces {
            held: Vec::with_capacity(CAPACITY),
        }
    }

    /// Number of pieces in use.
    pub fn count(&self) -> usize {
        self.held.len()
    }

    /// Forgets all pieces.
    pub fn clear(&mut self) {
        self.held.clear();
    }

    /// The pieces in use.
    pub fn list(&self) -> &[Piece] {
        &self.held
    }

    /// A piece in use.
    pub fn piece(&mut self, index: usize) -> &mut Piece {
        &mut self.held[index]
    }

    /// The last piece.
    pub fn last(&mut self) -> Option<&mut Piece> {
        self.held.last_mut()
    }

    /// Adds a piece, if there is room for it.
    pub fn push(&mut self, piece: Piece) {
        if self.held.len() < CAPACITY {
            self.held.push(piece);
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
        pieces.held
    }
}

impl TryFrom<Vec<Piece>> for Pieces {
    type Error = &'static str;

    fn try_from(mut list: Vec<Piece>) -> Result<Pieces, &'static str> {
        if list.len() > CAPACITY {
            return Err("more pieces than a trajectory keeps");
        }
        let mut before: Option<Piece> = None;
        for piece in &mut list {
            let follows = match before {
                Some(last) => {
                    piece.begin == last.end() && piece.segment.begins_in(last.segment.end())
                }
                None => piece.begin == Double::ZERO,
            };
            if !(piece.segment.is_sound() && follows) {
                return Err("a piece of the trajectory is damaged");
            }
            piece.segment.expand();
            before = Some(*piece);
        }
        list.reserve_exact(CAPACITY - list.len());
        Ok(Pieces { held: list })
    }
}

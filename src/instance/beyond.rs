//! Results that lead beyond the largest number. They are discarded: a host computes with what it is handed with OK.

use super::Fault;
use crate::model::{Model, View};
use crate::shortest::Shortest;

/// Whether this value of the variable in this place is +inf and says that there is none. It looks the variable up
/// again, so that nothing has to be kept for it where results are finite.
#[cold]
#[inline(never)]
pub(super) fn means_none<M: Model>(references: &[u32], place: usize, value: f64) -> bool {
    let reference = references.get(place);
    reference.is_some_and(|&reference| M::VARIABLES[reference as usize].has(value))
}

/// Why one of these results is no finite number.
#[cold]
pub(super) fn one_cannot_be_worked_out<M: Model>(view: &View<M>, references: &[u32]) -> Fault {
    let name = references
        .iter()
        .map(|&reference| &M::VARIABLES[reference as usize])
        .find(|variable| !variable.has(variable.value(view)))
        .map_or("a result", |variable| variable.name);
    cannot_be_worked_out(view, name)
}

/// Why a result is no finite number: there is no motion at the state, or the result or what it is worked out from
/// overflows.
#[cold]
pub(super) fn cannot_be_worked_out<M: Model>(view: &View<M>, result: &str) -> Fault {
    Fault::discard(match M::check_state(view) {
        Err(why) => format!("{why}; try a shorter step"),
        Ok(()) => format!(
            "{result} cannot be worked out at {}: it leads beyond the largest number, {}; {}",
            view.state_in_words(),
            Shortest(f64::MAX),
            M::excess(view).unwrap_or_else(|| {
                "try a shorter step, or parameters nearer to their typical sizes".into()
            })
        ),
    })
}

//! A motion followed substep by substep, for who needs each of them.

use super::{Failure, Progress, Trajectory};
use crate::arithmetic::double_double::DoubleDouble;
use crate::solver::Equation;
use crate::solver::dense_output::Segment;

impl Trajectory {
    /// Follows the motion over one substep of 16 nodes from `clock`, no longer than `most`, and
    /// returns it; the clock moves with it. Where it meets a limit the trajectory stands there, and
    /// the substep goes beyond.
    ///
    /// # Errors
    /// [`Failure::SubstepTooShort`] where the integration cannot go on.
    pub fn advance_by_substep<E: Equation>(
        &mut self,
        equation: &E,
        clock: &mut DoubleDouble,
        most: f64,
    ) -> Result<(Segment, Progress), Failure> {
        let state = self.state();
        self.stand_at(*clock, state);
        let local = equation.seen_from(clock);
        let substep = self
            .step(&local, state, [true, false], most)
            .map_err(|length| Failure::SubstepTooShort { length, after: 0.0 })?;
        let mut segment = Segment::new(state, substep.end, &substep.series);
        segment.expand();
        let contact = self
            .settings
            .limits
            .first_contact(&mut segment, substep.reach(state.position));
        let (progress, passed, end) = match contact {
            None => (Progress::Whole, segment.length(), segment.end()),
            Some((limit, after)) => (
                Progress::Stopped { limit, after },
                after,
                segment.state(after),
            ),
        };
        *clock = clock.plus(passed).renormalized();
        self.stand_at(*clock, end);
        Ok((segment, progress))
    }
}

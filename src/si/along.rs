//! The quantities as they change in a direction, by the same formulas in dual numbers.

use super::Si;
use super::sample::{Basis, Sample, own};
use super::scene::{BRANCHES, described, internal, place};
use crate::actuator::device::Source;
use crate::actuator::device::equation::Load;
use crate::actuator::drive::TURN;
use crate::actuator::scales::Scales;
use crate::arithmetic::jet::Dual;
use crate::arithmetic::number::Number;
use crate::model::{Direction, View};
use crate::solver::coupled::Stage;

impl View<'_, Si> {
    /// The present and its derivative in a direction, exact to rounding. A parameter whose 0 means "none" does not
    /// change from there.
    pub(super) fn sample_along(&self, direction: &Direction<Si>) -> Sample<Dual> {
        let (basis, stage) = self.basis();
        let (scene, change) = (self.scene, &direction.scene);
        let stiffening =
            std::array::from_fn(|k| Dual::new(scene.stiffening[k], change.stiffening[k]));
        let device = scene.device.along(&change.device);
        let described = described(device, scene.source(), stiffening);
        let basis = Basis {
            device: described.nondimensional_along(),
            scales: Scales::along(&described),
            stack: described.layers * described.thickness,
            drive: basis.drive,
            time: basis.time,
            origin: basis.origin,
        };
        let held = self.is_held();
        let [follows, moves] =
            [self.is_held_at_a_stretch(), held].map(|at_rest| f64::from(!at_rest));
        let (state, changed) = (self.state(), &direction.state);
        let [now, slopes] = [own(&state), own(changed)];
        let own: [Dual; 1 + BRANCHES] = std::array::from_fn(|k| Dual::new(now[k], slopes[k]));
        let rate = Dual::new(state.motion.rate, moves * changed.motion.rate);
        let [charge, dashpots @ ..] = own;
        let moved = Stage {
            position: Dual::new(stage.position, follows * changed.motion.position),
            rate: rate * basis.scales.time,
            internal: internal(&basis.device, charge / basis.scales.charge, &dashpots),
        };
        let [source, source_rate] = self.source_along(direction);
        let unit = basis.scales.source(scene.source());
        let offset = self.time.since(scene.since);
        let load = Load {
            source: source / unit,
            prestress: Dual::new(scene.force.at(offset), change.force.at(0.0)) / basis.scales.force,
        };
        let rate = source_rate * basis.scales.time / unit;
        basis.sample(&basis.local(), load, rate, &moved, None, (held, own))
    }

    /// What the source imposes, in its unit, and its rate per second.
    fn source_along(&self, direction: &Direction<Si>) -> [Dual; 2] {
        let (scene, change) = (self.scene, &direction.scene);
        let source = scene.source();
        let offset = self.time.since(scene.since);
        let input = scene.source_input();
        let value = Dual::new(input.at(offset), change.sources[place(source)].at(0.0));
        let rate = Dual::constant(input.at(Dual::new(offset, 1.0)).slope());
        if source != Source::Voltage {
            return [value, rate];
        }
        let amplitude = Dual::new(scene.alternating[0], change.alternating[0]);
        let [sine, slope] = self.oscillation(direction);
        [value + amplitude * sine, rate + amplitude * slope]
    }

    /// The sine of the built-in voltage, and its rate per second, also where its amplitude is 0.
    fn oscillation(&self, direction: &Direction<Si>) -> [Dual; 2] {
        let [_, frequency, _] = self.scene.alternating;
        let [_, faster, ahead] = direction.scene.alternating;
        let turned = if direction.from_now_on {
            0.0
        } else {
            self.time.value()
        };
        let turn = TURN.high;
        let angle = Dual::new(
            self.scene.oscillation().angle(*self.time) + self.scene.lead,
            turn * faster * turned + ahead,
        );
        let quarter = Dual::constant(0.25 * turn);
        let speed = Dual::new(turn * frequency, turn * faster);
        [angle.sin(), speed * (angle + quarter).sin()]
    }
}

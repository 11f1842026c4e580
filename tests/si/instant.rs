//! Several changes at one instant: what follows depends neither on their order nor on the kind of FMU.

use super::host::Host;
use super::integrator::Integrator;

type Change = (&'static str, f64);

/// Lengths of the host's steps before an instant and after it.
const STEP: f64 = 5e-9;
const STEPS: usize = 60;

/// Both kinds of FMU, with these values. The second integrates with the classical Runge–Kutta method.
struct Pair {
    ours: Host,
    theirs: Integrator,
}

impl Pair {
    fn begun(values: &[Change]) -> Pair {
        let mut all = vec![("record_energy", 1.0), ("eta", 0.01)];
        all.extend(values);
        Pair {
            ours: Host::begun(&all),
            theirs: Integrator::begun(&all),
        }
    }

    fn advance(&mut self) {
        self.ours.step(STEPS as f64 * STEP);
        for _ in 0..STEPS {
            self.theirs.step(STEP);
        }
    }

    /// Makes the changes at the present instant, an event of the second. Each kind of FMU is read in between.
    fn change(&mut self, changes: &[Change]) {
        self.theirs.host.instance.enter_event_mode();
        for (name, value) in changes {
            for host in [&mut self.ours, &mut self.theirs.host] {
                host.set(name, *value).expect(name);
                assert!(host.get("charge").is_finite());
            }
        }
        self.agree("charge", 1e-11);
        self.theirs.handle_events();
    }

    /// Makes the changes. The charge that is a state afterwards must be the one of before to this part.
    fn change_with_the_charge_kept(&mut self, changes: &[Change], part: f64) {
        let before = self.agree("charge", 1e-11);
        self.change(changes);
        let after = self.agree("charge_state", 1e-11);
        assert!(
            (after / before - 1.0).abs() < part,
            "{changes:?}: {before} {after}"
        );
    }

    fn agree(&self, name: &str, size: f64) -> f64 {
        let [a, b] = [&self.ours, &self.theirs.host].map(|host| host.get(name));
        assert!((a - b).abs() < 1e-7 * size, "{name}: {a} {b}");
        a
    }

    fn agree_in_everything(&self) {
        for (name, size) in [
            ("lambda", 1.0),
            ("charge", 1e-11),
            ("supply_current", 1e-5),
            ("lost_resistance", 1e-9),
            ("supplied_electrical", 1e-9),
        ] {
            self.agree(name, size);
        }
    }
}

/// All orders of these changes.
fn orders(changes: &[Change]) -> Vec<Vec<Change>> {
    if changes.is_empty() {
        return vec![Vec::new()];
    }
    let mut all = Vec::new();
    for k in 0..changes.len() {
        let mut rest = changes.to_vec();
        let first = rest.remove(k);
        for mut order in orders(&rest) {
            order.insert(0, first);
            all.push(order);
        }
    }
    all
}

/// The charge that becomes a state is the one that was on the electrodes before the instant: no time has passed in
/// which the new source could have brought another.
#[test]
fn a_resistance_switched_on_finds_the_charge_of_before() {
    let changes = [("voltage", 300.0), ("R_s", 1e7), ("V_ac", 50.0)];
    for order in orders(&changes) {
        let mut pair = Pair::begun(&[("f_ac", 3e5)]);
        pair.advance();
        pair.change_with_the_charge_kept(&order, 1e-7);
        pair.agree_in_everything();
        pair.advance();
        pair.agree_in_everything();
    }
}

/// At the start time too.
#[test]
fn at_the_start_it_finds_the_charge_of_the_start() {
    for order in orders(&[("voltage", 300.0), ("R_s", 1e7)]) {
        let mut pair = Pair::begun(&[]);
        pair.change_with_the_charge_kept(&order, 1e-12);
        pair.advance();
        pair.agree_in_everything();
    }
}

/// A resistance that is switched off and on again at one instant changes nothing, whatever is set in between.
#[test]
fn a_resistance_switched_off_for_no_time_keeps_the_charge() {
    let mut pair = Pair::begun(&[("R_s", 1e7)]);
    pair.advance();
    pair.change_with_the_charge_kept(&[("R_s", 0.0), ("voltage", 200.0), ("R_s", 2e7)], 1e-7);
    pair.advance();
    pair.agree_in_everything();
}

/// Where the actuator is held, the electrodes follow the source until the resistance is there.
#[test]
fn a_resistance_switched_on_while_held_finds_the_charge_of_before() {
    let mut host = Host::begun(&[("voltage", 900.0), ("lambda_max", 1.3)]);
    host.step(3e-6);
    assert_eq!(host.get("pulled_in"), 1.0);
    host.set("voltage", 100.0).expect("a voltage");
    host.step(1e-6);
    let before = host.get("charge");
    host.set("R_s", 1e6).expect("a resistance");
    for step in [0.0, 1e-6, 1e-6] {
        if step > 0.0 {
            host.step(step);
        }
        for name in ["charge", "charge_state"] {
            let after = host.get(name);
            assert!((after / before - 1.0).abs() < 1e-12, "{name}: {after}");
        }
    }
}

/// A host may say more than once that it handles an event.
#[test]
fn an_event_that_is_entered_again_is_the_same() {
    let mut pair = Pair::begun(&[]);
    pair.advance();
    let before = pair.agree("charge", 1e-11);
    let host = &mut pair.theirs.host;
    host.instance.enter_event_mode();
    host.set("voltage", 500.0).expect("a voltage");
    host.instance.enter_event_mode();
    host.set("R_s", 1e6).expect("a resistance");
    let after = host.get("charge_state");
    assert!((after / before - 1.0).abs() < 1e-7, "{before} {after}");
}

/// An ideal source in the place of a resistance meets the charge that is there, and exchanges the energy of a jump.
#[test]
fn a_resistance_switched_off_exchanges_the_energy_of_a_jump() {
    for order in orders(&[("voltage", 500.0), ("R_s", 0.0)]) {
        let mut pair = Pair::begun(&[("R_s", 1e7)]);
        pair.advance();
        pair.change(&order);
        pair.advance();
        pair.agree_in_everything();
    }
}

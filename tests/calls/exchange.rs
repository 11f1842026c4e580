//! Model exchange: a host that integrates by itself, its events and its records.

use super::*;

pub const EXCHANGE: fmi2Type = fmi2Type_fmi2ModelExchange;

/// An event info with nothing in it.
pub fn no_info() -> fmi2EventInfo {
    fmi2EventInfo {
        newDiscreteStatesNeeded: 7,
        terminateSimulation: 7,
        nominalsOfContinuousStatesChanged: 7,
        valuesOfContinuousStatesChanged: 7,
        nextEventTimeDefined: 7,
        nextEventTime: f64::NAN,
    }
}

impl Host {
    pub fn fill(
        &self,
        function: unsafe extern "C" fn(fmi2Component, *mut f64, usize) -> fmi2Status,
    ) -> [f64; 2] {
        let mut values = [f64::NAN; 2];
        let status = unsafe { function(self.component, values.as_mut_ptr(), 2) };
        assert_eq!(status, OK, "{}", self.last_line());
        values
    }

    pub fn put(&self, time: f64, states: [f64; 2]) {
        unsafe {
            assert_eq!(fmi2SetTime(self.component, time), OK);
            assert_eq!(
                fmi2SetContinuousStates(self.component, states.as_ptr(), 2),
                OK
            );
        }
    }

    fn slope(&self, time: f64, states: [f64; 2]) -> [f64; 2] {
        self.put(time, states);
        self.fill(fmi2GetDerivatives)
    }

    /// Handles an event at the present state.
    fn event(&self) -> fmi2EventInfo {
        let (c, mut info) = (self.component, no_info());
        unsafe {
            assert_eq!(fmi2EnterEventMode(c), OK);
            assert_eq!(fmi2NewDiscreteStates(c, &mut info), OK);
            assert_eq!(fmi2EnterContinuousTimeMode(c), OK);
        }
        info
    }
}

/// The classical Runge-Kutta method through model exchange, against
/// co-simulation: of fourth order towards it, with the built-in voltage.
#[test]
fn a_host_that_integrates_gets_the_motion_of_the_co_simulation() {
    let settings = [
        ("phi", 0.3),
        ("S", 0.2),
        ("c", 5.0),
        ("E_s", 0.1),
        ("phi_ac", 0.2),
        ("omega_ac", 0.9),
    ];
    let instance = Host::in_phase("stepping");
    for (name, value) in settings {
        assert_eq!(instance.set(name, value), OK);
    }
    assert_eq!(instance.step(0.0, 10.0), OK);
    let error = |count: u32| {
        let host = Host::in_phase_of(EXCHANGE, "event");
        for (name, value) in settings {
            assert_eq!(host.set(name, value), OK);
        }
        assert_eq!(unsafe { fmi2EnterContinuousTimeMode(host.component) }, OK);
        let mut x = host.fill(fmi2GetContinuousStates);
        assert_eq!(x, [1.0, 0.0]);
        let h = 10.0 / f64::from(count);
        for step in 0..count {
            let t = h * f64::from(step);
            let ahead = |k: [f64; 2], part: f64| [0, 1].map(|i| x[i] + part * h * k[i]);
            let k1 = host.slope(t, x);
            let k2 = host.slope(t + 0.5 * h, ahead(k1, 0.5));
            let k3 = host.slope(t + 0.5 * h, ahead(k2, 0.5));
            let k4 = host.slope(t + h, ahead(k3, 1.0));
            x = [0, 1].map(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]));
        }
        host.put(10.0, x);
        assert_eq!(host.get("lambda"), x[0]);
        (x[0] - instance.get("lambda")).abs()
    };
    let (coarse, fine) = (error(200), error(400));
    assert!(
        fine < 1e-7 && (coarse / fine).log2() > 3.7,
        "{coarse} and {fine}"
    );
}

#[test]
fn a_collapse_is_an_event_after_which_the_actuator_is_held() {
    for (beyond, limit) in [
        (10.0 + 1e-9, 10.0),
        (10.0 - 1e-9, 10.0),
        (0.05 - 1e-12, 0.05),
    ] {
        let host = Host::in_phase_of(EXCHANGE, "continuous");
        assert_eq!(host.fill(fmi2GetEventIndicators), [1.0 - 0.05, 10.0 - 1.0]);
        let rate = if limit > 1.0 { 2.0 } else { -2.0 };
        host.put(3.5, [beyond, rate]);
        let info = host.event();
        assert_eq!(info.valuesOfContinuousStatesChanged, 1);
        assert_eq!(
            (info.terminateSimulation, info.newDiscreteStatesNeeded),
            (0, 0)
        );
        assert_eq!(
            (
                info.nextEventTimeDefined,
                info.nominalsOfContinuousStatesChanged
            ),
            (0, 0)
        );
        assert_eq!(host.fill(fmi2GetContinuousStates), [limit, 0.0]);
        assert_eq!(host.fill(fmi2GetDerivatives), [0.0, 0.0]);
        assert_eq!(host.fill(fmi2GetEventIndicators), [9.95, 9.95]);
        assert_eq!(host.get("pull_in_time"), 3.5);
        assert!(
            host.last_line().contains("on_pull_in = hold"),
            "{}",
            host.last_line()
        );
        let again = host.event();
        assert_eq!(again.valuesOfContinuousStatesChanged, 0);
    }
}

/// A host that finds no crossings is told after its step.
#[test]
fn a_step_beyond_a_limit_asks_for_an_event() {
    let host = Host::in_phase_of(EXCHANGE, "continuous");
    let completed = || unsafe {
        let (mut event, mut terminate) = (7, 7);
        assert_eq!(
            fmi2CompletedIntegratorStep(host.component, 1, &mut event, &mut terminate),
            OK
        );
        assert_eq!(terminate, 0);
        event
    };
    host.put(1.0, [9.9, 1.0]);
    assert_eq!(completed(), 0);
    assert_eq!(host.event().valuesOfContinuousStatesChanged, 0);
    host.put(1.1, [10.1, 1.0]);
    assert_eq!(completed(), 1);
    assert_eq!(host.event().valuesOfContinuousStatesChanged, 1);
    assert_eq!(completed(), 0);
}

#[test]
fn a_collapse_that_terminates_asks_the_host_to() {
    let host = Host::in_phase_of(EXCHANGE, "initialization");
    unsafe {
        assert_eq!(
            fmi2SetInteger(host.component, &reference("on_pull_in"), 1, &2),
            OK
        );
        assert_eq!(fmi2ExitInitializationMode(host.component), OK);
        assert_eq!(fmi2EnterContinuousTimeMode(host.component), OK);
    }
    let completed = || unsafe {
        let (mut event, mut terminate) = (7, 7);
        assert_eq!(
            fmi2CompletedIntegratorStep(host.component, 1, &mut event, &mut terminate),
            OK
        );
        assert_eq!(terminate, 0);
        event
    };
    // What the last step has come to can be read before the event that ends the simulation;
    // a step that the host takes back has come to nothing.
    for (time, stretch, collapsed) in [(1.9, 9.9, 0), (2.1, 10.1, 1), (1.95, 9.95, 0)] {
        host.put(time, [stretch, 1.0]);
        assert_eq!(host.get("collapsed"), 0.0);
        assert_eq!(completed(), collapsed);
        assert_eq!(host.get("collapsed"), f64::from(collapsed));
    }
    host.put(2.0, [10.0, 1.0]);
    assert_eq!(completed(), 1);
    assert_eq!(host.get("collapsed"), 1.0);
    assert_eq!(host.get("pull_in_time"), 2.0);
    for _ in 0..2 {
        let info = host.event();
        assert_eq!(
            (
                info.terminateSimulation,
                info.valuesOfContinuousStatesChanged
            ),
            (1, 0)
        );
    }
    assert_eq!(host.fill(fmi2GetContinuousStates), [10.0, 1.0]);
    assert_eq!(host.get("pull_in_time"), 2.0);
}

/// A state in the shape of a sine, λ = 1.2 + 0.1 sin t, sampled so that no sample is
/// an extreme: what lies between completed steps is found on their cubic.
#[test]
fn extremes_are_recorded_at_completed_steps() {
    let recorded = |steps: u32, window: Option<f64>| {
        let host = Host::in_phase_of(EXCHANGE, "initialization");
        let c = host.component;
        unsafe {
            assert_eq!(fmi2SetBoolean(c, &reference("record_extremes"), 1, &1), OK);
            assert_eq!(fmi2ExitInitializationMode(c), OK);
        }
        let at = |time: f64| [1.2 + 0.1 * time.sin(), 0.1 * time.cos()];
        assert_eq!(host.set("lambda", at(0.3)[0]), OK);
        assert_eq!(host.set("lambda_dot", at(0.3)[1]), OK);
        assert_eq!(unsafe { fmi2EnterContinuousTimeMode(c) }, OK);
        let h = 6.5 / f64::from(steps);
        for k in 1..=steps {
            let time = h * f64::from(k);
            // A trial that is given up leaves nothing.
            host.put(time, [3.0, 0.1]);
            host.put(time, at(0.3 + time));
            assert_eq!(
                unsafe { fmi2CompletedIntegratorStep(c, 1, &mut 0, &mut 0) },
                OK
            );
            if let Some(window) = window.filter(|_| k == steps / 2) {
                assert_eq!(host.set("extremes_window", window), OK);
            }
        }
        ["lambda_lowest", "lambda_highest"].map(|name| host.get(name))
    };
    let error = |steps: u32| {
        let [lowest, highest] = recorded(steps, None);
        (lowest - 1.0).abs().max((highest - 1.3).abs())
    };
    // From λ = 1 on, where it stood at the start.
    assert!((recorded(20, None)[1] - 1.3).abs() < 1e-4);
    let (coarse, fine) = (error(20), error(80));
    assert!(fine < 1e-6 && coarse < 1e-3, "{coarse} and {fine}");
    // From 3.55 on: the largest is that at the end, the smallest 1.1 of the sine.
    let [lowest, highest] = recorded(80, Some(1.0));
    assert!((lowest - 1.1).abs() < 1e-6, "{lowest}");
    assert!(
        (highest - (1.2 + 0.1 * 6.8_f64.sin())).abs() < 1e-12,
        "{highest}"
    );
}

/// The phase of the built-in voltage runs on where its frequency changes.
#[test]
fn a_changed_frequency_leaves_the_present_voltage_as_it_is() {
    for kind in [EXCHANGE, fmi2Type_fmi2CoSimulation] {
        let phase = if kind == EXCHANGE {
            "continuous"
        } else {
            "stepping"
        };
        let host = Host::in_phase_of(kind, phase);
        let (mut time, mut angle, mut frequency) = (0.0, 0.7, 0.5);
        for (name, value) in [("phi_ac", 0.3), ("phase_ac", 0.7)] {
            assert_eq!(host.set(name, value), OK);
        }
        for k in 0..100 {
            assert_eq!(host.set("omega_ac", frequency), OK);
            let expected = 0.3 * f64::sin(angle);
            let found = host.get("phi_total");
            assert!((found - expected).abs() < 1e-13, "{found} and {expected}");
            let step = 1.0 + f64::from(k % 7);
            if kind == EXCHANGE {
                host.put(time + step, [1.0, 0.0]);
            } else {
                assert_eq!(host.step(time, step), OK);
            }
            time += step;
            angle += frequency * step;
            frequency = 0.1 + f64::from(k * k % 11) / 8.0;
        }
        assert_eq!(host.get("phase_ac"), 0.7);
    }
}

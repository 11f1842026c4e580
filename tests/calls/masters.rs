//! What masters do that the standard leaves open, or did not mean.

use super::*;

const EXPERIMENT_WITHOUT_STOP: fn(fmi2Component) -> fmi2Status =
    |c| unsafe { fmi2SetupExperiment(c, 0, f64::NAN, 0.0, 0, f64::NEG_INFINITY) };

fn initialize(host: &Host) {
    unsafe {
        assert_eq!(fmi2EnterInitializationMode(host.component), OK);
        assert_eq!(fmi2ExitInitializationMode(host.component), OK);
    }
}

/// fmuCheck and fmi-sim set inputs and start values before they set up the
/// experiment; others do it after; ecos and OMSimulator in initialization mode;
/// one that has no experiment to set up leaves the call out.
#[test]
fn values_may_be_set_whenever_before_the_first_step() {
    fn values(host: &Host) {
        assert_eq!(host.set("phi", 0.6), OK);
        assert_eq!(host.set("E_s", 0.2), OK);
        assert_eq!(host.set("lambda_start", 1.1), OK);
    }
    let orders: [fn(&Host); 4] = [
        |host| {
            values(host);
            assert_eq!(EXPERIMENT_WITHOUT_STOP(host.component), OK);
            initialize(host);
        },
        |host| {
            assert_eq!(EXPERIMENT_WITHOUT_STOP(host.component), OK);
            values(host);
            initialize(host);
        },
        |host| unsafe {
            assert_eq!(EXPERIMENT_WITHOUT_STOP(host.component), OK);
            assert_eq!(fmi2EnterInitializationMode(host.component), OK);
            values(host);
            assert_eq!(fmi2ExitInitializationMode(host.component), OK);
        },
        |host| {
            values(host);
            initialize(host);
        },
    ];
    let results = orders.map(|order| {
        let host = Host::new();
        order(&host);
        assert_eq!(host.get("lambda"), 1.1);
        assert_eq!(host.step(0.0, 7.7), OK);
        host.get("lambda").to_bits()
    });
    assert_eq!(results, [results[0]; 4]);
}

/// libcosim, fmusim and fmuCheck read every variable in one call for each type,
/// libcosim in initialization mode already; OMSimulator reads after it has set
/// an input and before the step.
#[test]
fn everything_can_be_read_at_once_and_after_setting_without_a_step() {
    for phase in ["initialization", "stepping"] {
        let host = Host::in_phase(phase);
        assert_eq!(host.set("phi", 0.3), OK);
        let real =
            |row: &&dielectric_elastomer_actuator::model::variables::Variable<Nondimensional>| {
                matches!(
                    row.kind,
                    dielectric_elastomer_actuator::model::variables::Kind::Real { .. }
                )
            };
        let references: Vec<u32> = VARIABLES
            .iter()
            .filter(real)
            .map(|row| reference(row.name))
            .collect();
        let mut values = vec![f64::NAN; references.len()];
        let count = references.len();
        let (c, from, to) = (host.component, references.as_ptr(), values.as_mut_ptr());
        assert_eq!(unsafe { fmi2GetReal(c, from, count, to) }, OK);
        assert!(values.iter().all(|value| !value.is_nan()), "{values:?}");
        assert_eq!(host.get("phi_total"), 0.3);
        assert!(host.get("lambda_ddot") > 0.0);
    }
}

/// libcosim counts in nanoseconds; others add up h, or take the difference of
/// two rounded times for it.
#[test]
fn communication_points_may_be_rounded() {
    let times: [fn(i32) -> f64; 3] = [
        |k| f64::from(k) * 0.1,
        |k| (0..k).fold(0.0, |time, _| time + 0.1),
        |k| f64::from(k * 100_000_000) * 1e-9,
    ];
    let mut results = Vec::new();
    for time in times {
        let host = Host::new();
        assert_eq!(
            unsafe { fmi2SetupExperiment(host.component, 0, 0.0, 0.0, 1, 2.0) },
            OK
        );
        initialize(&host);
        assert_eq!(host.set("phi", 0.6), OK);
        for k in 0..20 {
            let (from, to) = (time(k), time(k + 1));
            assert_eq!(host.step(from, to - from), OK, "{}", host.last_line());
        }
        results.push(host.get("lambda"));
    }
    for result in &results {
        assert!((result - results[0]).abs() < 1e-12, "{results:?}");
    }
}

/// cofmupy never terminates; others run again after they have.
#[test]
fn an_instance_may_be_freed_in_any_phase_and_reset_after_termination() {
    for (kind, phases) in KINDS {
        for phase in phases {
            drop(Host::in_phase_of(kind, phase));
        }
    }
    let host = Host::in_phase("terminated");
    assert_eq!(unsafe { fmi2Reset(host.component) }, OK);
    initialize(&host);
    assert_eq!(host.step(0.0, 1.0), OK);
}

/// Names with blanks or paths; resources by any URI, or by none.
#[test]
fn names_and_locations_may_be_strange() {
    let guid = CString::new(Nondimensional::GUID).expect("no NUL");
    for name in [
        c"my actuator",
        c"/a/b c/d.fmu",
        c"aktuator \xc3\xa4 100%s%n",
    ] {
        for location in [c"file:///fmu/a", c"file:/fmu/a%20b", c"file:////fmu", c""] {
            let host = Host::located(name.as_ptr(), location.as_ptr(), guid.as_ptr());
            assert!(!host.component.is_null());
            assert_eq!(host.set("phi", f64::NAN), ERROR);
            assert!(host.last_line().contains("phi = NaN"));
        }
        let nowhere = Host::located(name.as_ptr(), null(), guid.as_ptr());
        assert!(!nowhere.component.is_null());
    }
}

/// Instances share nothing: each may live in a thread of its own, or move to
/// another one.
#[test]
fn instances_in_several_threads_do_not_disturb_each_other() {
    fn may_move<T: Send>() {}
    may_move::<dielectric_elastomer_actuator::nondimensional::Instance>();
    let run = || {
        let host = Host::in_phase("stepping");
        assert_eq!(host.set("phi", 0.6), OK);
        for step in 0..200 {
            assert_eq!(host.step(0.3 * f64::from(step), 0.3), OK);
        }
        host.get("lambda").to_bits()
    };
    let alone = run();
    let together: Vec<u64> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..8).map(|_| scope.spawn(run)).collect();
        threads
            .into_iter()
            .map(|thread| thread.join().expect("no panic"))
            .collect()
    });
    assert_eq!(together, [alone; 8]);
}

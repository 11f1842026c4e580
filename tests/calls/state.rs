//! Saving, restoring and serializing an instance.

use std::time::Duration;

use proptest::prelude::*;
use proptest::sample::Index;
use proptest::test_runner::TestCaseError;

use super::script::{CONTENTS, seal};
use super::*;

/// Processor time in which a few steps are made whatever their numbers: each of them may take a
/// second (see `MOST_SUBSTEPS` of the trajectory).
const PATIENCE: Duration = Duration::from_secs(20);

impl Host {
    /// Goes on from these bytes; the first status that is not OK.
    fn restore(&self, bytes: &[u8]) -> fmi2Status {
        let (c, mut state) = (self.component, null_mut());
        unsafe {
            let read = fmi2DeSerializeFMUstate(c, bytes.as_ptr().cast(), bytes.len(), &mut state);
            if read != OK {
                assert!(state.is_null());
                return read;
            }
            let set = fmi2SetFMUstate(c, state);
            assert_eq!(fmi2FreeFMUstate(c, &mut state), OK);
            set
        }
    }

    /// An instance ready to step, which records extremes or not.
    fn recording(extremes: bool) -> Host {
        let host = Host::in_phase("initialization");
        let (c, record) = (host.component, i32::from(extremes));
        unsafe {
            assert_eq!(
                fmi2SetBoolean(c, &reference("record_extremes"), 1, &record),
                OK
            );
            assert_eq!(fmi2ExitInitializationMode(c), OK);
        }
        host
    }

    /// Steps of all lengths have statuses that are not fatal, within reasonable time,
    /// and what is read with OK is a number.
    fn goes_on(&self) -> Result<(), TestCaseError> {
        let begin = processor_time::of_this_thread();
        for step in [1e-3, 0.1, 1.0, 30.0] {
            for reference in 0..VARIABLES.len() as u32 {
                let mut value = 0.0;
                let status = unsafe { fmi2GetReal(self.component, &reference, 1, &mut value) };
                prop_assert!(
                    status != OK || !value.is_nan(),
                    "{}",
                    VARIABLES[reference as usize].name
                );
            }
            let status = self.step(self.time(), step);
            prop_assert!(status <= ERROR, "status {status}: {}", self.last_line());
        }
        prop_assert!(processor_time::of_this_thread() - begin < PATIENCE);
        Ok(())
    }

    fn motion(&self) -> [u64; 5] {
        [
            "lambda",
            "lambda_dot",
            "phi_total",
            "lambda_highest",
            "pull_in_time",
        ]
        .map(|name| self.get(name).to_bits())
    }
}

/// What a host may do between two communication points.
#[derive(Clone, Debug)]
enum Deed {
    Set(&'static str, f64),
    Slope(f64, f64),
    Step(f64),
}

impl Deed {
    fn run(&self, host: &Host, time: &mut f64) -> fmi2Status {
        match *self {
            Deed::Set(name, value) => host.set(name, value),
            Deed::Slope(first, second) => unsafe {
                let (orders, values) = ([1, 2], [first, second]);
                fmi2SetRealInputDerivatives(
                    host.component,
                    [0, 0].as_ptr(),
                    2,
                    orders.as_ptr(),
                    values.as_ptr(),
                )
            },
            Deed::Step(step) => {
                let status = host.step(*time, step);
                *time += step;
                status
            }
        }
    }
}

fn deeds() -> impl Strategy<Value = Vec<Deed>> {
    let names = [
        "phi", "S", "c", "gamma_s", "tau_s", "E_s", "phi_ac", "omega_ac",
    ];
    let deed = prop_oneof![
        1 => (prop::sample::select(names.to_vec()), 0.01..0.7)
            .prop_map(|(name, value)| Deed::Set(name, value)),
        1 => (-0.05..0.05, -0.01..0.01).prop_map(|(first, second)| Deed::Slope(first, second)),
        6 => prop_oneof![0.001..0.1, 0.1..3.0, 3.0..60.0].prop_map(Deed::Step),
    ];
    prop::collection::vec(deed, 1..25)
}

/// What may be done to the contents of a saved state.
#[derive(Clone, Debug)]
enum Change {
    /// A byte at any place.
    Byte(Index, u8),
    /// A number at any place.
    Number(Index, f64),
    /// A number that is there is multiplied, and something is added.
    Scale(Index, f64, f64),
    /// It loses or gains a bit.
    Flip(Index, u32),
    /// It is put in the place of another.
    Copy(Index, Index),
}

impl Change {
    fn make(&self, contents: &mut [u8]) {
        let number = |place: usize| {
            f64::from_le_bytes(contents[place..place + 8].try_into().expect("8 bytes"))
        };
        let anywhere = 0..contents.len() - 8;
        // Where bytes look like a number they mostly are one.
        let looks = |place: &usize| (1e-20..1e20).contains(&number(*place).abs());
        let places: Vec<usize> = anywhere.clone().filter(looks).collect();
        let at = |index: &Index| places[index.index(places.len())];
        let (place, new) = match self {
            Change::Byte(place, byte) => {
                contents[place.index(contents.len())] = *byte;
                return;
            }
            Change::Number(place, number) => (place.index(anywhere.len()), *number),
            Change::Scale(place, by, more) => (at(place), number(at(place)) * by + more),
            Change::Flip(place, bit) => {
                let bits = number(at(place)).to_bits() ^ (1 << bit);
                (at(place), f64::from_bits(bits))
            }
            Change::Copy(from, to) => (at(to), number(at(from))),
        };
        contents[place..place + 8].copy_from_slice(&new.to_le_bytes());
    }
}

/// Changes that are made together.
fn changes() -> impl Strategy<Value = Vec<Change>> {
    let index = any::<Index>;
    let factor = prop_oneof![Just(1.0), Just(-1.0), 0.0..2.0, 0.999..1.001];
    let change = prop_oneof![
        2 => (index(), any::<u8>()).prop_map(|(place, byte)| Change::Byte(place, byte)),
        1 => (index(), prop::num::f64::ANY)
            .prop_map(|(place, number)| Change::Number(place, number)),
        2 => (index(), factor, prop_oneof![Just(0.0), -1e-6..1e-6, -10.0..10.0])
            .prop_map(|(place, by, more)| Change::Scale(place, by, more)),
        2 => (index(), 0..64_u32).prop_map(|(place, bit)| Change::Flip(place, bit)),
        1 => (index(), index()).prop_map(|(from, to)| Change::Copy(from, to)),
    ];
    prop::collection::vec(change, 1..4)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    /// Restored in an instance that was never set up, or in the same one after
    /// it has gone elsewhere, the motion goes on as if nothing had happened.
    #[test]
    fn a_restored_motion_goes_on_bit_for_bit(
        before in deeds(),
        after in deeds(),
        extremes in any::<bool>(),
    ) {
        let host = Host::recording(extremes);
        let mut time = 0.0;
        for deed in &before {
            deed.run(&host, &mut time);
        }
        let bytes = host.serialized();
        let fresh = Host::new();
        prop_assert_eq!(fresh.restore(&bytes), OK);
        prop_assert_eq!(fresh.serialized(), bytes.clone());
        let follow = |host: &Host| {
            let mut time = time;
            after.iter().map(|deed| (deed.run(host, &mut time), host.motion())).collect::<Vec<_>>()
        };
        let uninterrupted = follow(&host);
        prop_assert_eq!(follow(&fresh), uninterrupted.clone());
        prop_assert_eq!(host.restore(&bytes), OK);
        prop_assert_eq!(follow(&host), uninterrupted);
    }

    /// Bytes with a right checksum and wrong contents are refused, or give an
    /// instance that goes on without harm.
    #[test]
    fn hostile_contents_do_no_harm(
        before in deeds(),
        recorded in any::<bool>(),
        changes in prop::collection::vec(changes(), 1..20),
    ) {
        let host = Host::recording(recorded);
        let mut time = 0.0;
        for deed in &before {
            deed.run(&host, &mut time);
        }
        let bytes = host.serialized();
        for changes in changes {
            let mut forged = bytes.clone();
            for change in &changes {
                change.make(&mut forged[CONTENTS..]);
            }
            seal(&mut forged);
            let other = Host::in_phase("stepping");
            let untouched = other.serialized();
            if other.restore(&forged) == OK {
                other.goes_on()?;
            } else {
                prop_assert_eq!(other.serialized(), untouched);
            }
        }
    }
}

#[test]
fn damaged_bytes_are_refused_and_change_nothing() {
    let host = Host::in_phase("stepping");
    assert_eq!(host.set("phi", 0.6), OK);
    assert_eq!(host.step(0.0, 30.0), OK);
    let bytes = host.serialized();
    let other = Host::in_phase("stepping");
    let untouched = other.serialized();
    for place in 0..bytes.len() {
        let mut damaged = bytes.clone();
        damaged[place] ^= 1 << (place % 8);
        assert_eq!(other.restore(&damaged), ERROR, "byte {place}");
        assert_eq!(other.restore(&bytes[..place]), ERROR, "{place} bytes");
    }
    let mut longer = bytes.clone();
    longer.push(0);
    assert_eq!(other.restore(&longer), ERROR);
    let mut trailing = longer.clone();
    seal(&mut trailing);
    assert_eq!(other.restore(&trailing), ERROR);
    assert!(
        other.last_line().contains("too long"),
        "{}",
        other.last_line()
    );
    let mut version = bytes.clone();
    version[9] += 1;
    assert_eq!(other.restore(&version), ERROR);
    assert!(
        other.last_line().contains("another version"),
        "{}",
        other.last_line()
    );
    assert_eq!(other.serialized(), untouched);
    assert_eq!(other.restore(&bytes), OK);
    assert_eq!(other.get("lambda"), host.get("lambda"));
}

#[test]
fn every_phase_is_saved_and_restored() {
    for (kind, phases) in KINDS {
        for phase in phases {
            let host = Host::in_phase_of(kind, phase);
            let other = Host::of(kind);
            let bytes = host.serialized();
            assert_eq!(other.restore(&bytes), OK, "{phase}: {}", other.last_line());
            assert_eq!(other.serialized(), bytes);
            for (name, function, ..) in TABLE {
                assert_eq!(other.restore(&bytes), OK);
                assert_eq!(host.restore(&bytes), OK);
                let (a, b) = (function(host.component), function(other.component));
                assert_eq!(a, b, "{name} in {phase}");
            }
        }
    }
    let exchange = Host::in_phase_of(fmi2Type_fmi2ModelExchange, "event");
    assert_eq!(
        exchange.restore(&Host::in_phase("stepping").serialized()),
        ERROR
    );
    assert!(exchange.last_line().contains("another kind of FMU"));
}

#[test]
fn a_state_is_small_and_its_memory_is_used_again() {
    let host = Host::in_phase("stepping");
    let c = host.component;
    assert_eq!(host.set("phi_ac", 0.3), OK);
    assert_eq!(host.set("omega_ac", 0.1438), OK);
    assert_eq!(host.step(0.0, 100.0), OK);
    assert!(
        host.serialized().len() < 1024,
        "{}",
        host.serialized().len()
    );
    unsafe {
        let mut state = null_mut();
        assert_eq!(fmi2GetFMUstate(c, &mut state), OK);
        let first = state;
        let stretch = host.get("lambda");
        assert_eq!(host.step(100.0, 1.0), OK);
        let later = host.get("lambda");
        assert_eq!(fmi2GetFMUstate(c, &mut state), OK);
        assert_eq!(state, first, "the state that was there is overwritten");
        assert_eq!(host.step(101.0, 1.0), OK);
        assert_eq!(fmi2SetFMUstate(c, state), OK);
        assert_eq!(host.get("lambda"), later);
        assert_ne!(later, stretch);
        assert_eq!(fmi2FreeFMUstate(c, &mut state), OK);
        assert_eq!(fmi2FreeFMUstate(c, &mut state), OK);
        assert_eq!(fmi2FreeFMUstate(c, null_mut()), OK);
    }
}

#[test]
fn null_states_and_wrong_sizes_are_refused() {
    let host = Host::in_phase("stepping");
    let (c, mut state) = (host.component, null_mut());
    unsafe {
        assert_eq!(fmi2GetFMUstate(c, null_mut()), ERROR);
        assert_eq!(fmi2SetFMUstate(c, null_mut()), ERROR);
        assert_eq!(fmi2SerializedFMUstateSize(c, null_mut(), &mut 0), ERROR);
        assert_eq!(fmi2SerializeFMUstate(c, null_mut(), null_mut(), 0), ERROR);
        assert_eq!(fmi2DeSerializeFMUstate(c, null(), 9, &mut state), ERROR);
        assert_eq!(fmi2DeSerializeFMUstate(c, null(), 0, &mut state), ERROR);
        assert!(state.is_null());
        assert_eq!(fmi2GetFMUstate(c, &mut state), OK);
        assert_eq!(fmi2SerializedFMUstateSize(c, state, null_mut()), ERROR);
        let mut few = [0u8; 10];
        let target = few.as_mut_ptr().cast();
        assert_eq!(fmi2SerializeFMUstate(c, state, target, 10), ERROR);
        assert_eq!(few, [0; 10]);
        let good = host.serialized();
        let bytes = good.as_ptr().cast();
        assert_eq!(
            fmi2DeSerializeFMUstate(c, bytes, good.len(), null_mut()),
            ERROR
        );
        assert_eq!(fmi2FreeFMUstate(c, &mut state), OK);
    }
}

/// A host that says that it will not go back may be believed or not: both give
/// the same motion, and a host that has not said so can go back.
#[test]
fn steps_are_the_same_whether_the_host_may_go_back_or_not() {
    let run = |no_set_prior: i32| {
        let host = Host::in_phase("stepping");
        let (c, mut state) = (host.component, null_mut());
        assert_eq!(host.set("phi", 0.6), OK);
        unsafe {
            for step in 0..20 {
                let time = 0.7 * f64::from(step);
                assert_eq!(fmi2GetFMUstate(c, &mut state), OK);
                if no_set_prior == 0 {
                    // A trial step that is taken back.
                    assert_eq!(fmi2DoStep(c, time, 1.4, 0), OK);
                    assert_eq!(fmi2SetFMUstate(c, state), OK);
                }
                assert_eq!(fmi2DoStep(c, time, 0.7, no_set_prior), OK);
            }
            assert_eq!(fmi2FreeFMUstate(c, &mut state), OK);
        }
        host.motion()
    };
    assert_eq!(run(0), run(1));
}

/// A state read from bytes is a new one, whatever the result held before: nothing, or another state of the host.
#[test]
fn bytes_are_read_into_a_new_state() {
    let host = Host::in_phase("stepping");
    let c = host.component;
    let early = host.serialized();
    assert_eq!(host.step(0.0, 2.0), OK);
    let (mut late, mut read) = (null_mut(), std::ptr::without_provenance_mut(0x1234));
    unsafe {
        assert_eq!(fmi2GetFMUstate(c, &mut late), OK);
        let (data, size) = (early.as_ptr().cast(), early.len());
        assert_eq!(fmi2DeSerializeFMUstate(c, data, size, &mut read), OK);
        let mut other = late;
        assert_eq!(fmi2DeSerializeFMUstate(c, data, size, &mut other), OK);
        assert!(other != late && other != read);
        assert_eq!(fmi2SetFMUstate(c, read), OK);
        assert_eq!(host.time(), 0.0);
        assert_eq!(fmi2SetFMUstate(c, late), OK);
        assert_eq!(host.time(), 2.0);
        for mut state in [late, read, other] {
            assert_eq!(fmi2FreeFMUstate(c, &mut state), OK);
        }
    }
}

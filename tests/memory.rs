//! What an instance costs the host's memory.
#![allow(unsafe_code)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

use dielectric_elastomer_actuator::instance::Type;
use dielectric_elastomer_actuator::nondimensional::Instance;
use dielectric_elastomer_actuator::nondimensional::value_reference;
use dielectric_elastomer_actuator::si;

/// The system's allocator, counted.
struct Counting;

thread_local! {
    /// Calls and bytes of this thread, once it counts: the one that waits for it allocates too.
    static COUNTED: Cell<Option<[usize; 2]>> = const { Cell::new(None) };
}

/// Calls and bytes so far.
fn counted() -> [usize; 2] {
    if COUNTED.get().is_none() {
        COUNTED.set(Some([0; 2]));
    }
    COUNTED.get().unwrap_or_default()
}

// SAFETY: everything is passed on to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if let Some([calls, bytes]) = COUNTED.get() {
            COUNTED.set(Some([calls + 1, bytes + layout.size()]));
        }
        // SAFETY: the caller owes us what it owes `System`, to which everything is passed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller owes us what it owes `System`, to which everything is passed on.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

const LARGEST_INSTANCE: usize = 64 * 1024;

const LARGEST_REAL_INSTANCE: usize = 96 * 1024;

#[test]
fn an_instance_is_small_and_allocates_nothing_once_initialized() {
    let reference = |name: &str| value_reference(name).expect("a variable");
    let read = [
        reference("lambda"),
        reference("hamiltonian"),
        reference("phi_pull_in"),
    ];

    let [_, before] = counted();
    let mut instance = Instance::new();
    instance.enter_initialization();
    instance
        .exit_initialization()
        .expect("the start values are good");
    let [calls, bytes] = counted();
    let size = bytes - before + size_of::<Instance>();
    assert!(size < LARGEST_INSTANCE, "{size} bytes");

    let (mut time, mut sum) = (0.0, 0.0);
    for step in 0..1000 {
        // Constant, changing, polynomial and alternating inputs in turn.
        let value = 0.3 + 0.01 * f64::from(step % 7);
        if step % 5 == 0 {
            instance
                .set(Type::Real, &[reference("phi")], |_| value)
                .expect("allowed");
        }
        if step % 11 == 0 {
            instance
                .set_input_derivatives(&[0], &[1], &[1e-3])
                .expect("allowed");
        }
        if step == 500 {
            instance
                .set(
                    Type::Real,
                    &[reference("phi_ac"), reference("omega_ac")],
                    |_| 0.1,
                )
                .expect("allowed");
        }
        instance.do_step(time, 0.7).expect("a step");
        time += 0.7;
        instance
            .get(Type::Real, &read, |_, value| sum += value)
            .expect("readable");
    }
    assert!(sum.is_finite());
    assert_eq!(counted()[0], calls);
}

/// The real actuator with everything beyond the paper: its parameters change on the way, and every
/// threshold is read.
#[test]
fn a_real_actuator_allocates_nothing_once_initialized() {
    let reference = |name: &str| si::value_reference(name).expect("a variable");
    let read = [
        "lambda",
        "supply_current",
        "energy_elastic",
        "lost_power",
        "V_pull_in_static",
        "V_pull_in_from_rest",
        "V_pull_in_glassy_dynamic",
        "pull_in_margin",
        "frequency",
    ]
    .map(reference);
    for branches in [0.0, 1e5] {
        let [_, before] = counted();
        let mut instance = si::Instance::new();
        let set = |instance: &mut si::Instance, name: &str, value: f64| {
            instance
                .set(Type::Real, &[reference(name)], |_| value)
                .expect("allowed");
        };
        for (name, value) in [
            ("R_s", 1e7),
            ("eta", 0.05),
            ("mu_1", branches),
            ("tau_1", 1e-6),
            ("gamma_s", 0.0),
            ("tau_s", 0.0),
            ("E_s", 0.0),
            ("extremes_window", 1.0),
        ] {
            set(&mut instance, name, value);
        }
        instance.enter_initialization();
        instance.exit_initialization().expect("a start");
        let [calls, bytes] = counted();
        let size = bytes - before + size_of::<si::Instance>();
        assert!(size < LARGEST_REAL_INSTANCE, "{size} bytes");
        let (mut time, mut sum) = (0.0, 0.0);
        for step in 0..300 {
            if step % 5 == 0 {
                set(&mut instance, "voltage", 300.0 + f64::from(step % 7));
            }
            if step == 120 {
                set(&mut instance, "eta", 0.05 + 1e-4 * f64::from(step));
                set(&mut instance, "extremes_window", f64::from(step));
            }
            instance.do_step(time, 3e-7).expect("a step");
            time += 3e-7;
            instance
                .get(Type::Real, &read, |_, value| sum += value)
                .expect("readable");
        }
        assert!(sum.is_finite());
        assert_eq!(counted()[0], calls);
    }
}

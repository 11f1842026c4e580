//! What an instance costs the host's memory.
#![allow(unsafe_code)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::atomic::{AtomicUsize, Ordering};

use dielectric_elastomer_actuator::instance::Type;
use dielectric_elastomer_actuator::nondimensional::Instance;
use dielectric_elastomer_actuator::nondimensional::value_reference;

/// The system's allocator, counted.
struct Counting;

static CALLS: AtomicUsize = AtomicUsize::new(0);
static BYTES: AtomicUsize = AtomicUsize::new(0);

thread_local! {
    /// Whether this is the thread of the test: the one that waits for it allocates too.
    static COUNTED: Cell<bool> = const { Cell::new(false) };
}

// SAFETY: everything is passed on to the system's allocator.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        if COUNTED.get() {
            CALLS.fetch_add(1, Ordering::Relaxed);
            BYTES.fetch_add(layout.size(), Ordering::Relaxed);
        }
        // SAFETY: the caller's promise.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        // SAFETY: the caller's promise.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

const LARGEST_INSTANCE: usize = 64 * 1024;

#[test]
fn an_instance_is_small_and_allocates_nothing_once_initialized() {
    let reference = |name: &str| value_reference(name).expect("a variable");
    let read = [
        reference("lambda"),
        reference("hamiltonian"),
        reference("phi_pull_in"),
    ];

    COUNTED.set(true);
    let before = BYTES.load(Ordering::Relaxed);
    let mut instance = Instance::new();
    instance.enter_initialization();
    instance
        .exit_initialization()
        .expect("the start values are good");
    let size = BYTES.load(Ordering::Relaxed) - before + size_of::<Instance>();
    assert!(size < LARGEST_INSTANCE, "{size} bytes");

    let calls = CALLS.load(Ordering::Relaxed);
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
    assert_eq!(CALLS.load(Ordering::Relaxed), calls);
}

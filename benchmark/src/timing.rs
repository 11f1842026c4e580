//! How long something takes.
#![expect(unsafe_code, reason = "this module asks for the clock of a thread")]

use std::time::Duration;

/// A measurement is the median over this many batches: a batch in which the
/// machine did something else does not count.
pub const BATCHES: usize = 7;

/// Seconds that one call of `run` takes, measured for at least `least`.
pub fn seconds_per_call(least: Duration, mut run: impl FnMut()) -> f64 {
    let batch = least / BATCHES as u32;
    let mut calls = 1_u32;
    loop {
        let passed = time(calls, &mut run);
        if passed >= batch {
            break;
        }
        let wanted = 1.2 * batch.as_secs_f64() / passed.as_secs_f64().max(1e-9);
        calls = (f64::from(calls) * wanted.clamp(1.5, 100.0)).ceil() as u32;
    }
    let batches = [(); BATCHES].map(|()| time(calls, &mut run).as_secs_f64());
    median(batches) / f64::from(calls)
}

fn time(calls: u32, run: &mut impl FnMut()) -> Duration {
    let begin = processor_time();
    for _ in 0..calls {
        run();
    }
    processor_time() - begin
}

/// The time for which a processor has worked on this thread: others on a busy machine do not count.
pub fn processor_time() -> Duration {
    let mut time = libc::timespec {
        tv_sec: 0,
        tv_nsec: 0,
    };
    // SAFETY: a place for the time.
    let status = unsafe { libc::clock_gettime(libc::CLOCK_THREAD_CPUTIME_ID, &raw mut time) };
    assert_eq!(status, 0, "no clock of the thread");
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
}

/// The middle one.
pub fn median(mut values: [f64; BATCHES]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[BATCHES / 2]
}

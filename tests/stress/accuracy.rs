//! The accuracy that is promised: at each communication point the error is at most
//! [`allowed::TOLERANCES`] tolerances times K, by which the exact motion amplifies an error
//! from any communication point to this one.
//!
//! *Error* is the larger of the relative error of the stretch and the error of the rate
//! times T = √((c + 2)/6). K is the norm of the solution of the variational equation in
//! the same units.

use std::fs::read_to_string;

use dielectric_elastomer_actuator::instance::Type;
use dielectric_elastomer_actuator::nondimensional::{Instance, value_reference};

use super::doubled::Doubled;
use super::scenes::{KINDS, Kind, Scene};
use super::*;

/// Stretches in which a motion is compared.
const COMPARED: std::ops::RangeInclusive<f64> = 0.15..=8.0;

/// Amplification beyond which a motion is chaotic or escapes.
const MOST_AMPLIFIED: f64 = 1e6;

/// The actuator as a host drives it.
struct Host {
    instance: Instance,
    load: Load,
}

impl Host {
    fn new(scene: &Scene) -> Host {
        let mut host = Host {
            instance: Instance::new(),
            load: Load::constant(0.0, 0.0),
        };
        let [surface_energy, surface_tension, surface_elasticity] = scene.actuator.surface;
        for (name, value) in [
            ("c", scene.actuator.aspect),
            ("gamma_s", surface_energy),
            ("tau_s", surface_tension),
            ("E_s", surface_elasticity),
            ("lambda_start", scene.start[0]),
            ("lambda_dot_start", scene.start[1]),
            ("lambda_min", WIDE.lower),
            ("lambda_max", WIDE.upper),
        ] {
            host.set(name, value);
        }
        host.instance
            .setup_experiment(scene.tolerance, scene.start_time, None)
            .expect("legal");
        host.instance.enter_initialization();
        host.change(&scene.load);
        host.instance.exit_initialization().expect("legal");
        host
    }

    fn set(&mut self, name: &str, value: f64) {
        let reference = value_reference(name).expect("a variable");
        self.instance
            .set(Type::Real, &[reference], |_| value)
            .expect("a legal value");
    }

    fn change(&mut self, load: &Load) {
        for (name, derivatives) in [("phi", load.voltage), ("S", load.prestress)] {
            self.set(name, derivatives[0]);
            let orders = 1 + derivatives[1..]
                .iter()
                .rposition(|d| *d != 0.0)
                .map_or(0, |k| k + 1);
            let reference = value_reference(name).expect("a variable");
            let order: Vec<i32> = (1..orders as i32).collect();
            let references = vec![reference; order.len()];
            self.instance
                .set_input_derivatives(&references, &order, &derivatives[1..orders])
                .expect("legal derivatives");
        }
        for (k, name) in ["phi_ac", "omega_ac", "phase_ac"].into_iter().enumerate() {
            if load.harmonic[k] != self.load.harmonic[k] {
                self.set(name, load.harmonic[k]);
            }
        }
        self.load = *load;
    }

    fn step(&mut self, length: f64) {
        let time = self.instance.last_successful_time();
        let outcome = self.instance.do_step(time, length);
        assert!(matches!(outcome, Ok(None)), "{outcome:?}");
    }

    fn state(&self) -> [f64; 2] {
        let references = ["lambda", "lambda_dot"].map(|name| value_reference(name).expect("one"));
        let mut values = [f64::NAN; 2];
        self.instance
            .get(Type::Real, &references, |place, value| {
                values[place] = value
            })
            .expect("numbers");
        values
    }
}

type Matrix = [[f64; 2]; 2];

/// Amplification by the exact motion to the present communication point from each one
/// before.
struct Amplification {
    from: Vec<Matrix>,
}

impl Amplification {
    /// Goes on by a step over which the state changes by `factor` with the state before.
    fn pass(&mut self, factor: Matrix) {
        for matrix in &mut self.from {
            let product =
                |i: usize, j: usize| factor[i][0] * matrix[0][j] + factor[i][1] * matrix[1][j];
            *matrix = [0, 1].map(|i| [0, 1].map(|j| product(i, j)));
        }
        self.from.push([[1.0, 0.0], [0.0, 1.0]]);
    }

    fn largest(&self) -> f64 {
        let norm = |m: &Matrix| largest(m.map(|row| row[0].abs() + row[1].abs()));
        largest(self.from.iter().map(norm))
    }
}

/// The error at a communication point.
#[derive(Clone, Copy, Default)]
pub struct Miss {
    /// In tolerances times the amplification, less what rounding excuses.
    pub ratio: f64,
    error: f64,
    amplification: f64,
    step: usize,
}

impl std::fmt::Display for Miss {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(
            f,
            "error {:e} after step {}, amplification {}: {} tolerances per amplification",
            self.error, self.step, self.amplification, self.ratio
        )
    }
}

/// What came of a scene.
#[derive(Clone, Copy)]
pub struct Played {
    /// Where the error is worst.
    pub worst: Miss,
    /// How many steps were compared.
    pub compared: usize,
    /// Stretch and rate at the end.
    pub end: [f64; 2],
}

/// Plays a scene as long as its motion can be compared.
pub fn play(scene: &Scene) -> Played {
    let unit = scene.actuator.time_scale();
    let tolerance = scene.tolerance.unwrap_or(1e-10);
    let mut host = Host::new(scene);
    let mut exact = Taylor::starting(
        scene.start.map(Doubled::from),
        Doubled::from(scene.start_time),
    );
    let mut load = scene.load;
    let mut amplification = Amplification {
        from: vec![[[1.0, 0.0], [0.0, 1.0]]],
    };
    let mut worst = Miss::default();
    let mut passed = 0.0;
    let mut compared = 0;
    for (index, step) in scene.steps.iter().enumerate() {
        if let Some(change) = step.change {
            exact.set_inputs(&load, &change);
            load = change;
        }
        let before = exact.stretch.value();
        let mut varied = exact.varied();
        if !exact.advance_within(&scene.actuator, &load, step.length, COMPARED)
            || !varied.advance_within(&scene.actuator, &load, step.length, COMPARED)
        {
            break;
        }
        if step.change.is_some() {
            host.change(&load);
        }
        host.step(step.length);
        passed += step.length / unit;
        let [exact_stretch, exact_rate] = exact.state();
        let [a, b] = varied.stretch.along;
        let [c, d] = varied.rate.along;
        amplification.pass([
            [a * before / exact_stretch, b / unit / exact_stretch],
            [c * unit * before, d],
        ]);
        let [stretch, rate] = host.state();
        let error = largest([
            (stretch - exact_stretch) / exact_stretch,
            (rate - exact_rate) * unit,
        ]);
        let amplification = amplification.largest();
        assert!(!(error / amplification).is_nan());
        if amplification > MOST_AMPLIFIED {
            break;
        }
        compared += 1;
        let rounding = allowed::ROUNDING + allowed::ROUNDING_WITH_TIME * passed;
        let ratio = (error / amplification - rounding).max(0.0) / tolerance;
        if ratio >= worst.ratio {
            worst = Miss {
                ratio,
                error,
                amplification,
                step: index,
            };
        }
    }
    Played {
        worst,
        compared,
        end: host.state(),
    }
}

/// What scenes of a kind miss at worst, sorted.
fn survey(kind: Kind, count: u64) -> Vec<(Miss, u64)> {
    let (mut compared, mut steps) = (0, 0);
    let mut misses: Vec<_> = (0..count)
        .map(|seed| {
            let scene = Scene::random(kind, &mut Random(seed << 8 | kind as u64));
            let played = play(&scene);
            compared += played.compared;
            steps += scene.steps.len();
            (played.worst, seed)
        })
        .collect();
    // Some motions are pulled in.
    assert!(
        10 * compared > 8 * steps,
        "{kind:?}: {compared} of {steps} steps compared"
    );
    misses.sort_by(|a, b| a.0.ratio.total_cmp(&b.0.ratio));
    misses
}

#[test]
fn random_scenes_of_every_kind_keep_the_tolerance() {
    let count = if long() { 1200 } else { 60 };
    let surveys: Vec<_> = std::thread::scope(|scope| {
        let running = KINDS.map(|kind| scope.spawn(move || survey(kind, count)));
        running
            .into_iter()
            .map(|survey| survey.join().expect("no step fails"))
            .collect()
    });
    println!("error / (tolerance · K) of {count} scenes each: median, 99 %, worst");
    for (kind, misses) in KINDS.iter().zip(&surveys) {
        let at = |part: f64| {
            misses[(part * (misses.len() - 1) as f64).round() as usize]
                .0
                .ratio
        };
        let name = format!("{kind:?}");
        let [median, most, worst] = [0.5, 0.99, 1.0].map(at);
        println!("{name:13} {median:9.2e} {most:9.2e} {worst:9.2e}");
    }
    for (kind, misses) in KINDS.iter().zip(&surveys) {
        let (miss, seed) = misses.last().expect("some scenes");
        assert!(
            miss.ratio <= allowed::tolerances(*kind),
            "{kind:?}, seed {seed}: {miss}"
        );
    }
}

/// Scenes in which rounding leaves a way of 1e-17 before a long step, whose first guess must not be
/// taken from there.
#[test]
fn a_way_that_rounding_has_left_does_not_end_the_motion() {
    for seed in [103, 434, 530, 563, 593, 693, 797, 811, 1028] {
        let scene = Scene::random(Kind::Mixed, &mut Random(seed << 8 | Kind::Mixed as u64));
        let Played {
            worst, compared, ..
        } = play(&scene);
        assert_eq!(compared, scene.steps.len(), "seed {seed}");
        assert!(
            worst.ratio <= allowed::tolerances(Kind::Mixed),
            "seed {seed}: {worst}"
        );
    }
}

/// The independent integrator against references of 31 digits; rounding of the parameters
/// moves them by 6e-17 and 2.4e-14.
#[test]
fn the_independent_integrator_gives_the_references() {
    let surface = [0.05, 0.05, 0.2];
    let alternating = alternating(0.3, 0.1471);
    for (name, surface, load, most) in [
        ("a", surface, Load::constant(0.6, 0.0), 1e-15),
        ("b", surface, Load::constant(0.6, 0.5), 1e-14),
        ("d", [0.1, 0.05, 0.2], alternating, 1e-13),
    ] {
        let path = format!(
            "{}/tests/reference/case_{name}.csv",
            env!("CARGO_MANIFEST_DIR")
        );
        let text = read_to_string(path).expect("a file of the project");
        let mut motion = Taylor::new(1.0, 0.0);
        let actuator = Actuator {
            aspect: 100.0,
            surface,
        };
        for line in text.lines().skip(2) {
            let row: Vec<f64> = line
                .split(',')
                .map(|n| n.parse().expect("numbers"))
                .collect();
            motion.advance(&actuator, &load, row[0] - motion.time.value());
            let [stretch, rate] = motion.state();
            let error = largest([stretch - row[1], rate - row[2]]);
            assert!(error <= most, "{name} at {}: {error:e}", row[0]);
        }
    }
}

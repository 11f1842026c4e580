//! Random scenes of every kind of input that a host can give, for [`super::accuracy`].

use super::*;

/// A kind of scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// Inputs that keep their values.
    Held,
    /// Inputs that jump at each step.
    Jumps,
    /// Inputs that change a little at each of many short steps.
    Short,
    /// The built-in drive, as slow as the motion.
    SlowDrive,
    /// The built-in drive, faster than the motion.
    FastDrive,
    /// The built-in drive with inputs changed at each step.
    ChangedDrive,
    /// A smooth input with its derivatives, set at each step.
    Derivatives,
    /// Polynomials that swing within a step.
    Polynomials,
    /// Derivatives that are set once for some steps.
    LookAhead,
    /// All of them in turn.
    Mixed,
}

pub const KINDS: [Kind; 10] = [
    Kind::Held,
    Kind::Jumps,
    Kind::Short,
    Kind::SlowDrive,
    Kind::FastDrive,
    Kind::ChangedDrive,
    Kind::Derivatives,
    Kind::Polynomials,
    Kind::LookAhead,
    Kind::Mixed,
];

/// A communication step, before which the inputs may be changed.
#[derive(Clone, Copy, Debug)]
pub struct Step {
    pub change: Option<Load>,
    pub length: f64,
}

/// What a host does with an actuator.
#[derive(Clone, Debug)]
pub struct Scene {
    pub actuator: Actuator,
    /// Stretch and rate at the start.
    pub start: [f64; 2],
    pub start_time: f64,
    /// None for the default.
    pub tolerance: Option<f64>,
    pub load: Load,
    pub steps: Vec<Step>,
}

/// Draws the steps of a scene.
struct Author<'a> {
    random: &'a mut Random,
    /// The time scale of the actuator.
    unit: f64,
    load: Load,
    steps: Vec<Step>,
    /// Time of the model at the end of the steps.
    time: f64,
}

/// Angle of the drive, in radians, in a scene: enough, and not too much to compute.
const MOST_TURNED: f64 = 600.0;

impl Scene {
    pub fn random(kind: Kind, random: &mut Random) -> Scene {
        let powers = [0.0, 6.0];
        let mut actuator = random.actuator(powers, 0.2, 0.05);
        if random.one_in(3) {
            actuator.surface = [0.0, 0.0, random.of(&[0.0, 0.2])];
        }
        let unit = actuator.time_scale();
        let tolerance = 10_f64.powf(random.between(-14.0, -2.0));
        let start_time = random.of(&[0.0, -5.0, 1e6]);
        let start = match random.bits() % 4 {
            0 | 1 => [1.0, 0.0],
            2 => [random.between(0.7, 1.4), random.between(-0.3, 0.3) / unit],
            _ => [random.between(0.4, 4.0), random.between(-1.0, 1.0) / unit],
        };
        let prestress = if random.one_in(2) {
            0.0
        } else {
            random.between(-1.0, 0.3)
        };
        let load = Load::constant(random.between(0.0, 0.6), prestress);
        let tolerance = if random.one_in(4) {
            None
        } else {
            Some(tolerance)
        };
        let mut author = Author {
            random,
            unit,
            load,
            steps: Vec::new(),
            time: start_time,
        };
        if matches!(
            kind,
            Kind::SlowDrive | Kind::FastDrive | Kind::ChangedDrive | Kind::Mixed
        ) {
            author.load.harmonic = author.harmonic(kind);
        }
        let load = author.load;
        author.play(kind);
        author.steps.retain(|step| step.length > 0.0);
        Scene {
            actuator,
            start,
            start_time,
            tolerance,
            load,
            steps: author.steps,
        }
    }
}

impl Author<'_> {
    fn play(&mut self, kind: Kind) {
        match kind {
            Kind::Held => self.hold([-9.0, 1.7], 16, 120.0),
            Kind::Jumps => self.jump(60),
            Kind::Short => self.change_a_little(200),
            Kind::SlowDrive => self.hold([-4.0, 1.3], 24, 80.0),
            Kind::FastDrive => {
                let most = MOST_TURNED / self.load.harmonic[1] / self.unit;
                self.hold([-6.0, most.log10() - 0.5], 24, most);
            }
            Kind::ChangedDrive => self.change_a_little(200),
            Kind::Derivatives => self.follow_a_sine(80),
            Kind::Polynomials => self.swing(40),
            Kind::LookAhead => self.look_ahead(8),
            Kind::Mixed => {
                for _ in 0..6 {
                    match self.random.bits() % 7 {
                        0 => {
                            self.load.harmonic = self.harmonic(Kind::Mixed);
                            let most =
                                (MOST_TURNED / 6.0 / self.load.harmonic[1] / self.unit).min(50.0);
                            self.change(self.load);
                            self.hold([-9.0, most.log10()], 6, most);
                        }
                        1 => self.jump(6),
                        2 => self.change_a_little(30),
                        3 => self.follow_a_sine(12),
                        4 => self.swing(6),
                        5 => self.look_ahead(2),
                        _ => {
                            self.load.harmonic[0] = 0.0;
                            self.change(self.load);
                            self.hold([-9.0, 1.7], 6, 50.0);
                        }
                    }
                    self.steady();
                }
            }
        }
    }

    /// φ_a, ω, ϑ.
    fn harmonic(&mut self, kind: Kind) -> [f64; 3] {
        let powers = match kind {
            Kind::SlowDrive => [-1.3, 0.3],
            Kind::FastDrive => [0.3, 2.5],
            _ => [-1.0, 2.9],
        };
        let amplitude = self.random.between(0.05, 0.5);
        let frequency = 10_f64.powf(self.random.between(powers[0], powers[1])) / self.unit;
        let phase = self.random.between(-3.0, 3.0);
        // One of eight stands still.
        let stands_still = !matches!(kind, Kind::FastDrive) && phase > 2.25;
        [amplitude, if stands_still { 0.0 } else { frequency }, phase]
    }

    /// A step of 10 to a power between these, in units of the time scale.
    fn length(&mut self, [least, most]: [f64; 2]) -> f64 {
        self.unit * 10_f64.powf(self.random.between(least, most))
    }

    fn step(&mut self, length: f64) {
        self.time += length;
        match self.steps.last_mut() {
            Some(step) if step.length == 0.0 => step.length = length,
            _ => self.steps.push(Step {
                change: None,
                length,
            }),
        }
    }

    /// Sets the inputs at the present time.
    fn change(&mut self, load: Load) {
        self.load = load;
        self.steps.retain(|step| step.length > 0.0);
        self.steps.push(Step {
            change: Some(load),
            length: 0.0,
        });
    }

    /// No derivatives any more.
    fn steady(&mut self) {
        let constant = Load::constant(self.random.between(0.0, 0.6), self.load.prestress[0]);
        self.change(Load {
            harmonic: self.load.harmonic,
            ..constant
        });
    }

    fn hold(&mut self, powers: [f64; 2], count: u32, most: f64) {
        let end = self.time + most * self.unit;
        for _ in 0..count {
            let length = self.length(powers);
            if self.time + length < end {
                self.step(length);
            }
        }
    }

    fn jump(&mut self, count: u32) {
        for _ in 0..count {
            let load = Load::constant(
                self.random.between(-0.7, 0.7),
                self.random.between(-1.0, 0.4),
            );
            self.change(Load {
                harmonic: self.load.harmonic,
                ..load
            });
            let powers = if self.is_turning_fast() {
                [-4.0, -1.5]
            } else {
                [-4.0, 0.6]
            };
            let length = self.length(powers);
            self.step(length);
        }
    }

    fn is_turning_fast(&self) -> bool {
        let [amplitude, frequency, _] = self.load.harmonic;
        amplitude != 0.0 && frequency * self.unit > 3.0
    }

    /// Steps of one length, or of two in turn, under a voltage that wanders or repeats.
    fn change_a_little(&mut self, count: u32) {
        let mut length = self.length([-5.0, -0.5]);
        if self.is_turning_fast() {
            length = 10_f64.powf(self.random.between(-2.0, 0.4)) / self.load.harmonic[1];
        }
        let uneven = self.random.of(&[0.0, 0.03, 0.3]);
        let size = 10_f64.powf(self.random.between(-7.0, -2.0));
        let wanders = self.random.one_in(2);
        let first = self.load.voltage[0];
        for k in 0..count {
            let mut load = Load::constant(first, self.load.prestress[0]);
            load.harmonic = self.load.harmonic;
            load.voltage[0] = if wanders {
                (self.load.voltage[0] + size * self.random.between(-1.0, 1.0)).clamp(-0.7, 0.7)
            } else {
                first + size * f64::from(k % 3)
            };
            self.change(load);
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            self.step(length * (1.0 + sign * uneven));
        }
    }

    /// A sine, passed with its exact derivatives up to some order at each step.
    fn follow_a_sine(&mut self, count: u32) {
        let length = self.length([-5.0, 0.5]);
        let angle = 10_f64.powf(self.random.between(-1.0, 0.3));
        let order = self.random.of(&[1, 2, 3, 4, 4]);
        let size = self.random.between(0.02, 0.5);
        let mean = self.random.between(-0.3, 0.3);
        let frequency = angle / length;
        let turned = MOST_TURNED.min(f64::from(count) * angle);
        for k in 0..(turned / angle) as u32 {
            let (sine, cosine) = (f64::from(k) * angle).sin_cos();
            let turn = [sine, cosine, -sine, -cosine, sine];
            let mut load = self.load;
            load.voltage = std::array::from_fn(|n| {
                let present = f64::from(u8::from(n <= order));
                present * size * turn[n] * frequency.powi(n as i32)
            });
            load.voltage[0] += mean;
            load.prestress = [self.load.prestress[0], 0.0, 0.0, 0.0, 0.0];
            self.change(load);
            self.step(length);
        }
    }

    /// An input that swings between bounds over `duration`: a sum of Chebyshev polynomials.
    fn swinging(&mut self, mean: f64, size: f64, duration: f64) -> [f64; 5] {
        let mut weight = [0.0; 5];
        for w in &mut weight[1..] {
            if self.random.one_in(2) {
                *w = self.random.between(-1.0, 1.0) * size / 2.0;
            }
        }
        let [_, a, b, c, d] = weight;
        // T₁ to T₄ in u = 2s/h − 1, by their derivatives in s at u = −1.
        let turn = 2.0 / duration;
        [
            mean - a + b - c + d,
            (a - 4.0 * b + 9.0 * c - 16.0 * d) * turn,
            (4.0 * b - 24.0 * c + 80.0 * d) * turn.powi(2),
            (24.0 * c - 192.0 * d) * turn.powi(3),
            192.0 * d * turn.powi(4),
        ]
    }

    fn set_swinging(&mut self, duration: f64) {
        let mean = self.random.between(-0.3, 0.4);
        let mut load = self.load;
        load.voltage = self.swinging(mean, 0.3, duration);
        if self.random.one_in(2) {
            let mean = self.random.between(-0.5, 0.2);
            load.prestress = self.swinging(mean, 0.3, duration);
        } else {
            load.prestress = Load::constant(0.0, self.load.prestress[0]).prestress;
        }
        self.change(load);
    }

    fn swing(&mut self, count: u32) {
        let one = self.length([-6.0, 0.7]);
        let equal = self.random.one_in(2);
        for _ in 0..count {
            let length = if equal { one } else { self.length([-6.0, 0.7]) };
            self.set_swinging(length);
            self.step(length);
        }
    }

    /// A long step under an input that rises slowly, some short ones under inputs that are
    /// held, then steps under polynomials that swing within a few of them.
    fn look_ahead(&mut self, count: u32) {
        for _ in 0..count {
            let turning = self.is_turning_fast();
            let mut load = self.load;
            load.prestress[1] = 1e-3 / self.unit;
            self.change(load);
            let long = self.length(if turning { [-2.0, -1.0] } else { [-2.0, 1.2] });
            self.step(long);
            self.steady();
            let short = self.length([-6.0, -0.3]);
            for _ in 0..self.random.bits() % 3 {
                self.step(short);
            }
            let steps = 1 + self.random.bits() % 5;
            self.set_swinging(short * steps as f64);
            for _ in 0..steps {
                self.step(short);
            }
            self.steady();
        }
    }
}

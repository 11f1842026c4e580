//! A reference scene: what `tests/reference/device/*.json` describes, and our motion of it.

use crate::clocked::Clocked;
use dielectric_elastomer_actuator::actuator::Drive;
use dielectric_elastomer_actuator::actuator::device::{DeviceMotion, Exchanged, Source, Stored};
use dielectric_elastomer_actuator::actuator::drive::{Harmonic, Polynomial};
use dielectric_elastomer_actuator::actuator::scales::{Scales, SiDevice, SiElasticity};
use dielectric_elastomer_actuator::arithmetic::double_double::DoubleDouble;
use dielectric_elastomer_actuator::solver::State;
use dielectric_elastomer_actuator::solver::coupled::trajectory::Carried;
use dielectric_elastomer_actuator::solver::coupled::{
    CoupledEquation, FullState, LocalCoupledEquation, Progress, Stage, Trajectory,
};
use dielectric_elastomer_actuator::solver::limits::Limits;
use serde_json::Value;

/// Limits far away.
pub const LIMITS: Limits = Limits {
    lower: 0.01,
    upper: 100.0,
};

pub fn read(name: &str) -> Value {
    let path = format!(
        "{}/tests/reference/device/{name}.json",
        env!("CARGO_MANIFEST_DIR")
    );
    let text = std::fs::read_to_string(path).expect("the reference is checked in");
    serde_json::from_str(&text).expect("JSON")
}

/// The number of a decimal string.
pub fn number(value: &Value) -> f64 {
    let text = value.as_str().expect("a decimal string");
    text.parse().expect("a number")
}

/// A scene in SI units.
pub struct Scene {
    pub device: SiDevice,
    pub drive: Drive,
    pub charge: f64,
    pub branches: usize,
}

impl Scene {
    /// The scene of a file.
    pub fn of(file: &Value) -> Scene {
        let given = &file["parameters_SI"];
        let get = |key: &str| given.get(key).map_or(0.0, number);
        let mut device = SiDevice::sheet(get("mu"), get("rho"), get("epsr"), [get("H"), get("L")]);
        device.layers = get("n");
        device.surface_energy = get("gamma_s");
        device.surface_tension = get("tau_s");
        device.surface_elasticity = get("E_s");
        if given.get("J").is_some() {
            device.elasticity = SiElasticity::Gent { limit: get("J") };
        }
        if given.get("kappa2").is_some() {
            device.elasticity = SiElasticity::Yeoh {
                second: get("kappa2"),
                third: get("kappa3"),
            };
        }
        device.load_mass = get("m");
        device.load_spring = get("k");
        if given.get("l_k").is_some() {
            device.load_spring_length = get("l_k");
        }
        device.permittivity_terms = [get("k1"), get("k2"), get("k3")];
        device.linear_damping = get("b");
        device.viscosity = get("eta");
        device.series_resistance = get("R_s");
        device.parallel_conductance = get("G_p");
        device.conductivity = get("sigma");
        if given.get("E_c").is_some() {
            device.conduction_field = get("E_c");
        }
        if given.get("n_s").is_some() {
            device.surfaces = get("n_s");
        }
        let branches = given.get("branches").and_then(Value::as_array);
        let branches = branches.map_or(&[][..], Vec::as_slice);
        for (k, branch) in branches.iter().enumerate() {
            device.branch_moduli[k] = number(&branch[0]);
            device.branch_times[k] = number(&branch[1]);
            if branch[2].is_string() {
                device.branch_limits[k] = number(&branch[2]);
            }
        }
        let mut level = get("V");
        if given.get("Q").is_some() {
            device.source = Source::Charge;
            level = get("Q");
        }
        if given.get("I").is_some() {
            device.source = Source::Current;
            level = get("I");
        }
        let scales = Scales::of(&device);
        let mut drive = Drive::constant(
            level / scales.source(device.source),
            get("P") / scales.force,
        );
        let polynomial = |key: &str, unit: f64| {
            let terms = given.get(key)?.as_array()?;
            let mut input = Polynomial::constant(number(&terms[0]) / unit);
            let mut size = 1.0 / unit;
            for (order, term) in terms.iter().enumerate().skip(1) {
                size *= order as f64 * scales.time;
                input.set_derivative(order, size * number(term));
            }
            Some(input)
        };
        if let Some(voltage) = polynomial("V_polynomial", scales.voltage) {
            drive.voltage = voltage;
        }
        if let Some(prestress) = polynomial("P_polynomial", scales.force) {
            drive.prestress = prestress;
        }
        if given.get("V_ac").is_some() {
            drive.harmonic = Harmonic {
                amplitude: get("V_ac") / scales.voltage,
                frequency: std::f64::consts::TAU * get("f") * scales.time,
                frequency_rest: 0.0,
                phase: 0.0,
            };
        }
        Scene {
            device,
            drive,
            charge: number(&file["start"]["charge_C"]) / scales.charge,
            branches: branches.len(),
        }
    }

    pub fn scales(&self) -> Scales {
        Scales::of(&self.device)
    }

    pub fn motion(&self, records_energy: bool) -> DeviceMotion {
        DeviceMotion {
            device: self.device.nondimensional(),
            drive: self.drive,
            records_energy,
        }
    }
}

/// A motion from rest at λ = 1 with this charge.
pub fn start(motion: &DeviceMotion, charge: f64, tolerance: f64) -> Clocked<Carried> {
    start_between(motion, charge, tolerance, LIMITS)
}

/// A scene between other limits.
pub fn start_between(
    motion: &DeviceMotion,
    charge: f64,
    tolerance: f64,
    limits: Limits,
) -> Clocked<Carried> {
    let mut state = FullState::of(State {
        position: 1.0,
        rate: 0.0,
    });
    let mut states = state.internal.iter_mut();
    if motion.device.has_charge_state() {
        *states.next().expect("room") = charge;
    }
    for _ in motion.device.present_branches() {
        *states.next().expect("room") = 1.0;
    }
    Clocked::from(Trajectory::new(state, limits, tolerance))
}

/// The present of a motion.
pub struct Present {
    pub stored: Stored,
    pub exchanged: Exchanged,
    pub charge: f64,
    pub current: f64,
    pub membrane_voltage: f64,
    pub field: f64,
    pub capacitance: f64,
}

impl Present {
    pub fn of(motion: &DeviceMotion, trajectory: &Clocked<Carried>) -> Present {
        let (origin, position) = trajectory.position_from_origin();
        let local = motion.at(&trajectory.clock, &origin);
        let stage = Stage {
            position,
            rate: trajectory.rate(),
            internal: trajectory.internal(),
        };
        let load = local.load(0.0);
        let stretch = local.stretch(position);
        let capacitance = local.capacitance(stretch);
        let voltage = local.membrane_voltage(&load, &stage);
        // Endpoint-only steps keep no polynomials.
        let slopes = trajectory.slopes().unwrap_or_else(|| {
            let slopes = local.first_order(&load, &stage);
            slopes.map(|slope| slope.value)
        });
        Present {
            stored: local.stored(0.0, &stage),
            exchanged: Exchanged::from_integrals(&trajectory.integrals()),
            charge: voltage * capacitance,
            current: local.current(0.0, &stage, &slopes),
            membrane_voltage: voltage,
            field: voltage * stretch * stretch,
            capacitance,
        }
    }
}

/// Follows the motion up to a time in steps no longer than `step`.
pub fn follow(
    trajectory: &mut Clocked<Carried>,
    motion: &DeviceMotion,
    target: DoubleDouble,
    step: f64,
) {
    loop {
        let rest = target.since(trajectory.clock);
        if rest <= 0.0 {
            return;
        }
        let progress = trajectory.advance(motion, rest.min(step));
        assert_eq!(progress, Ok(Progress::Whole));
        if rest <= step {
            return;
        }
    }
}

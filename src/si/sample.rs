//! The quantities that follow from the state and the inputs by formulas, in SI units. Each formula is
//! written once. It gives values, directional derivatives (dual numbers) and time derivatives (power series).

use super::Si;
use super::scene::{BRANCHES, SiScene, SiState, internal};
use crate::actuator::device::equation::Load;
use crate::actuator::device::{Device, LocalDevice, Source};
use crate::actuator::scales::Scales;
use crate::arithmetic::double_double::DoubleDouble;
use crate::arithmetic::jet::{Dual, HIGHEST_ORDER, TimeSeries};
use crate::arithmetic::number::{Number, Parameter, ParameterOf};
use crate::model::View;
use crate::solver::State;
use crate::solver::coupled::{LocalCoupledEquation, Stage};

macro_rules! sample {
    (
        of the stretch { $($(#[$at:meta])* $placed:ident,)* }
        of the motion { $($(#[$of:meta])* $moved:ident,)* }
        of everything { $($(#[$about:meta])* $name:ident,)* }
    ) => {
        /// The quantities that depend on the stretch and its rate alone.
        struct Geometry<N> {
            $($placed: N,)*
            $($moved: N,)*
        }

        impl View<'_, Si> {
            $($(#[$at])*
            #[must_use]
            pub fn $placed(&self) -> f64 {
                self.placed().$placed
            })*

            $($(#[$of])*
            #[must_use]
            pub fn $moved(&self) -> f64 {
                self.geometry(self.motion()).$moved
            })*
        }

        /// All quantities at one time, as numbers that may carry derivatives.
        #[derive(Clone, Copy, Debug)]
        pub struct Sample<N> {
            $($(#[$at])* pub $placed: N,)*
            $($(#[$of])* pub $moved: N,)*
            $($(#[$about])* pub $name: N,)*
        }

        impl<N: Number> Sample<N> {
            $($(#[$at])*
            #[must_use]
            pub fn $placed(&self) -> N {
                self.$placed
            })*

            $($(#[$of])*
            #[must_use]
            pub fn $moved(&self) -> N {
                self.$moved
            })*

            $($(#[$about])*
            #[must_use]
            pub fn $name(&self) -> N {
                self.$name
            })*
        }

        impl View<'_, Si> {
            $($(#[$about])*
            #[must_use]
            pub fn $name(&self) -> f64 {
                self.sample().$name
            })*
        }
    };
}

sample! {
    of the stretch {
    /// λ.
    stretch,
    /// λ3 = 1/λ².
    thickness_stretch,
    /// The distance of opposite edges in m.
    edge_distance,
    /// By how much it has grown, in m.
    edge_displacement,
    /// The thickness of the stack in m.
    thickness,
    }
    of the motion {
    /// dλ/dt in 1/s.
    stretch_rate,
    /// dλ3/dt = −2λ⁻³ dλ/dt in 1/s.
    thickness_stretch_rate,
    /// The rate of the distance of opposite edges in m/s.
    edge_velocity,
    }
    of everything {
    /// d²λ/dt² in 1/s².
    stretch_acceleration,
    /// The second derivative of the distance of opposite edges in m/s².
    edge_acceleration,
    /// The charge on the electrodes in C.
    charge,
    /// The current from the source in A.
    supply_current,
    /// The capacitance in F.
    capacitance,
    /// The voltage at the membrane in V.
    membrane_voltage,
    /// The voltage at the terminals in V.
    supply_voltage,
    /// The true field in V/m.
    electric_field,
    /// The power that the source supplies in W.
    electrical_power,
    /// The power that the force supplies in W.
    mechanical_power,
    /// dQ/dt in A of the charge as a state; 0 where the charge is no state.
    charge_state_rate,
    /// The charge as a state in C; its start value where it is no state.
    charge_state,
    /// ξ of the first dashpot.
    dashpot_1,
    /// ξ of the second dashpot.
    dashpot_2,
    /// ξ of the third dashpot.
    dashpot_3,
    /// dξ/dt of the first dashpot in 1/s.
    dashpot_1_rate,
    /// dξ/dt of the second dashpot in 1/s.
    dashpot_2_rate,
    /// dξ/dt of the third dashpot in 1/s.
    dashpot_3_rate,
    }
}

impl<N: Number> Geometry<N> {
    /// From the stretch and its rate, the side and the thickness before deformation.
    #[inline(always)]
    fn of(stretch: N, rate: N, side: N, stack: N) -> Geometry<N> {
        let one = stretch.same(1.0);
        let square = stretch * stretch;
        Geometry {
            stretch,
            stretch_rate: rate,
            thickness_stretch: one / square,
            thickness_stretch_rate: stretch.same(-2.0) * rate / (square * stretch),
            edge_distance: stretch * side,
            edge_displacement: (stretch - one) * side,
            edge_velocity: rate * side,
            thickness: stack / square,
        }
    }
}

/// What a sample is computed from.
pub(super) struct Basis<P = f64> {
    /// The thickness of the stack before deformation, in m.
    pub stack: P,
    pub device: Device<P>,
    pub scales: Scales<P>,
    pub drive: crate::actuator::Drive,
    /// Time of the model, nondimensional.
    pub time: DoubleDouble,
    /// The origin of the stretch.
    pub origin: DoubleDouble,
}

impl Basis {
    pub fn of(scene: &SiScene, time: &DoubleDouble, origin: DoubleDouble) -> Basis {
        let folded = scene.folded();
        Basis {
            stack: folded.stack,
            device: folded.device,
            drive: scene.drive(&folded.scales),
            time: folded.scales.time(*time),
            scales: folded.scales,
            origin,
        }
    }

    /// The nondimensional capacitance in a state.
    pub fn capacitance(&self, state: &SiState) -> f64 {
        self.local().capacitance(state.motion.position)
    }

    /// A state as a nondimensional stage, at this position from the origin.
    pub fn stage(&self, state: &SiState, position: f64) -> Stage {
        Stage {
            position,
            rate: state.motion.rate * self.scales.time,
            internal: internal(
                &self.device,
                state.charge / self.scales.charge,
                &state.dashpots,
            ),
        }
    }

    pub fn source_rate(&self) -> f64 {
        let drive = self.drive.at(&self.time);
        drive.voltage(Dual::new(0.0, 1.0)).slope()
    }
}

impl<P: Parameter> Basis<P> {
    pub fn local(&self) -> LocalDevice<'_, P> {
        LocalDevice::new(&self.device, &self.drive, &self.time, &self.origin)
    }

    /// The sample at a stage of `local`, which is [`Basis::local`]. `source_rate` is the derivative of what the source
    /// imposes. `charging` is the derivative of the charge, where it is known more accurately than from its equation.
    /// `states` are the charge and the dashpots; those that are states of the stage are taken from there.
    pub fn sample<N: Number>(
        &self,
        local: &LocalDevice<P>,
        load: Load<N>,
        source_rate: N,
        stage: &Stage<N>,
        charging: Option<N>,
        (held, mut states): (bool, [N; 1 + BRANCHES]),
    ) -> Sample<N>
    where
        P: ParameterOf<N>,
    {
        let (device, scales) = (&self.device, &self.scales);
        let number = |value: f64| stage.position.same(value);
        let lift = |parameter: P| parameter.lift(stage.position);
        let per_second = number(1.0) / lift(scales.time);
        let stretch = local.stretch(stage.position);
        let [force, inertia, damping] = local.forces(&load, stage);
        let acceleration = if held {
            number(0.0)
        } else {
            (force - damping * stage.rate) / inertia
        };
        let voltage = local.membrane_voltage(&load, stage);
        let capacitance = local.capacitance(stretch);
        let square = stretch * stretch;
        let leak = voltage * local.conductance(voltage, square)[0];
        let slopes = local.first_order(&load, stage);
        let charge_slope = charging.unwrap_or(slopes[0].value);
        let has_charge = device.has_charge_state();
        let current = match device.port.source {
            Source::Current => load.source,
            Source::Charge => source_rate + leak,
            Source::Voltage if has_charge => charge_slope + leak,
            Source::Voltage => {
                let growth = number(4.0) * device.permittivity.pull(stretch) * stage.rate;
                capacitance * source_rate + voltage * growth + leak
            }
        };
        let supply = match device.port.source {
            Source::Voltage => load.source,
            _ => voltage + lift(device.port.resistance) * current,
        };
        let rate = stage.rate * per_second;
        let zero = number(0.0);
        let mut rates = [zero; BRANCHES];
        let mut next = usize::from(has_charge);
        if has_charge {
            states[0] = stage.internal[0] * lift(scales.charge);
        }
        for (k, branch) in device.branches.iter().enumerate() {
            if branch.modulus.value() > 0.0 {
                // ξ = √g.
                let root = stage.internal[next].sqrt();
                states[1 + k] = root;
                if !held {
                    rates[k] = slopes[next].value / (root + root) * per_second;
                }
                next += 1;
            }
        }
        let current_unit = lift(scales.current());
        let volts = lift(scales.voltage);
        let supply_current = current * current_unit;
        let Geometry {
            stretch,
            stretch_rate,
            thickness_stretch,
            thickness_stretch_rate,
            edge_distance,
            edge_displacement,
            edge_velocity,
            thickness,
        } = Geometry::of(stretch, rate, lift(scales.length), lift(self.stack));
        Sample {
            stretch,
            stretch_rate,
            stretch_acceleration: acceleration * per_second * per_second,
            thickness_stretch,
            thickness_stretch_rate,
            edge_distance,
            edge_displacement,
            edge_velocity,
            edge_acceleration: acceleration * per_second * per_second * lift(scales.length),
            thickness,
            charge: voltage * capacitance * lift(scales.charge),
            supply_current,
            capacitance: capacitance * lift(scales.capacitance),
            membrane_voltage: voltage * volts,
            supply_voltage: supply * volts,
            electric_field: voltage * square * lift(scales.field),
            electrical_power: supply * volts * supply_current,
            mechanical_power: number(2.0) * lift(scales.force) * load.prestress * edge_velocity,
            charge_state_rate: if has_charge && !held {
                charge_slope * current_unit
            } else {
                zero
            },
            charge_state: states[0],
            dashpot_1: states[1],
            dashpot_2: states[2],
            dashpot_3: states[3],
            dashpot_1_rate: rates[0],
            dashpot_2_rate: rates[1],
            dashpot_3_rate: rates[2],
        }
    }
}

impl View<'_, Si> {
    #[inline(always)]
    fn geometry(&self, State { position, rate }: State) -> Geometry<f64> {
        let device = &self.scene.device;
        let stack = device.layers * device.thickness;
        Geometry::of(position, rate, device.side, stack)
    }

    /// The geometry without the rates, whose evaluation would double the time.
    #[inline(always)]
    fn placed(&self) -> Geometry<f64> {
        self.geometry(State {
            position: self.present_stretch(),
            rate: 0.0,
        })
    }

    /// All quantities at the present.
    fn sample(&self) -> &Sample<f64> {
        self.sample.get_or_init(|| self.computed_sample())
    }

    #[inline(never)]
    fn computed_sample(&self) -> Sample<f64> {
        let state = self.state();
        let (basis, stage) = self.basis_in(&state);
        let local = basis.local();
        let (load, rate) = (local.load(0.0), basis.source_rate());
        let charging = self
            .charging(load.source)
            .map(|current| current / basis.scales.current());
        let own = (self.is_held(), own(&state));
        basis.sample(&local, load, rate, &stage, charging, own)
    }

    /// The motion from now on as power series of the time in s. Derivatives up to `order` are exact.
    pub(super) fn series(&self, order: usize) -> Sample<TimeSeries> {
        let (basis, stage) = self.basis();
        let local = basis.local();
        // In the nondimensional time from now on; a second is 1/t0 of its units.
        let offset = TimeSeries::variable();
        let load = local.load(offset);
        let mut series = Stage {
            position: TimeSeries::constant(stage.position),
            rate: TimeSeries::constant(stage.rate),
            internal: stage.internal.map(TimeSeries::constant),
        };
        let held = self.is_held();
        if !held {
            series.position.term[1] = stage.rate;
            for k in 0..=order.min(HIGHEST_ORDER) {
                let slopes = local.first_order(&load, &series);
                for (state, slope) in series.internal.iter_mut().zip(slopes) {
                    state.term[k + 1] = slope.value.term[k] / (k + 1) as f64;
                }
                let [force, inertia, damping] = local.forces(&load, &series);
                let acceleration = (force - damping * series.rate) / inertia;
                series.rate.term[k + 1] = acceleration.term[k] / (k + 1) as f64;
                series.position.term[k + 2] = series.rate.term[k + 1] / (k + 2) as f64;
            }
        }
        let mut source_rate = TimeSeries::constant(0.0);
        for k in 1..source_rate.term.len() {
            source_rate.term[k - 1] = k as f64 * load.source.term[k];
        }
        let per_second = 1.0 / basis.scales.time;
        let in_seconds = |series: TimeSeries| {
            let mut factor = 1.0;
            let mut scaled = series;
            for term in &mut scaled.term {
                *term *= factor;
                factor *= per_second;
            }
            scaled
        };
        let load = Load {
            source: in_seconds(load.source),
            prestress: in_seconds(load.prestress),
        };
        let stage = Stage {
            position: in_seconds(series.position),
            rate: in_seconds(series.rate),
            internal: series.internal.map(in_seconds),
        };
        let states = own(&self.state()).map(TimeSeries::constant);
        let rate = in_seconds(source_rate);
        basis.sample(&local, load, rate, &stage, None, (held, states))
    }
}

/// The charge and the dashpots of a state.
pub(super) fn own(state: &SiState) -> [f64; 1 + BRANCHES] {
    let [first, second, third] = state.dashpots;
    [state.charge, first, second, third]
}

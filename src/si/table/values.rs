//! Energies, thresholds, margins, and what has happened.

use super::Row;
use super::ports::CHARGED;
use crate::arithmetic::number::Number;
use crate::model::variables::Causality::{Local, Output};
use crate::model::variables::rows::{
    UNDECLARED, depends, extremes, positive, real, unlimited, value,
};
use crate::model::variables::{Derivatives, Kind, units};
use crate::si::Si;
use crate::si::thresholds::PullIn;

/// A flag as a number.
fn flag(holds: bool) -> f64 {
    f64::from(u8::from(holds))
}

/// Derivatives of what changes at events only.
const AT_EVENTS: Option<Derivatives<Si>> = Some(Derivatives {
    along: |sample| sample.stretch().same(0.0),
    from_now_on: |sample| sample.stretch().same(0.0),
});

const EXTREMES: [Row; 4] = extremes();

/// Of breakdown at the start: what the field depends on, and what it is held against.
const CHOSEN_AND_CHARGED: [&str; 4 + CHARGED.at_start.len()] = {
    let mut all = [""; 4 + CHARGED.at_start.len()];
    let (chosen, charged) = all.split_at_mut(4);
    chosen.copy_from_slice(&[
        "E_breakdown",
        "n_breakdown",
        "on_breakdown",
        "on_breakdown_number",
    ]);
    charged.copy_from_slice(CHARGED.at_start);
    all
};

/// The results that are only read.
pub(super) const VALUES: [Row; 34] = [
    Row::result(
        "lost_power",
        "power lost at present by viscosity, branches, resistance and leaks",
        Local,
        unlimited(1.0),
        value(|view| view.lost_power()),
        UNDECLARED,
    )
    .in_unit(&units::WATT),
    Row::result(
        "energy_kinetic",
        "energy of the motion, the load mass included",
        Local,
        unlimited(1e-8),
        value(|view| view.stored().kinetic),
        UNDECLARED,
    )
    .in_unit(&units::JOULE),
    Row::result(
        "energy_elastic",
        "elastic energy of the material",
        Local,
        unlimited(1e-8),
        value(|view| view.stored().elastic),
        UNDECLARED,
    )
    .in_unit(&units::JOULE),
    Row::result(
        "energy_surface",
        "energy of the surfaces",
        Local,
        unlimited(1e-8),
        value(|view| view.stored().surface),
        UNDECLARED,
    )
    .in_unit(&units::JOULE),
    Row::result(
        "energy_spring",
        "energy of the load spring",
        Local,
        unlimited(1e-8),
        value(|view| view.stored().spring),
        UNDECLARED,
    )
    .in_unit(&units::JOULE),
    Row::result(
        "energy_branches",
        "elastic energy of the Maxwell branches",
        Local,
        unlimited(1e-8),
        value(|view| view.stored().branches),
        UNDECLARED,
    )
    .in_unit(&units::JOULE),
    Row::result(
        "energy_electric",
        "energy of the electric field",
        Local,
        unlimited(1e-8),
        value(|view| view.stored().electric),
        UNDECLARED,
    )
    .in_unit(&units::JOULE),
    Row::result(
        "lost_damping",
        "energy lost by viscous damping since the start; 0 unless record_energy",
        Local,
        unlimited(1e-8),
        value(|view| view.exchanged().damping),
        UNDECLARED,
    )
    .in_unit(&units::JOULE),
    Row::result(
        "lost_branches",
        "energy lost in the Maxwell branches since the start; 0 unless record_energy",
        Local,
        unlimited(1e-8),
        value(|view| view.exchanged().branches),
        UNDECLARED,
    )
    .in_unit(&units::JOULE),
    Row::result(
        "lost_resistance",
        "energy lost in the series resistance, or in an ideal source that is stepped since the start; 0 unless record_energy",
        Local,
        unlimited(1e-8),
        value(|view| view.exchanged().series),
        UNDECLARED,
    )
    .in_unit(&units::JOULE),
    Row::result(
        "lost_leakage",
        "energy lost by leakage since the start; 0 unless record_energy",
        Local,
        unlimited(1e-8),
        value(|view| view.exchanged().leakage),
        UNDECLARED,
    )
    .in_unit(&units::JOULE),
    Row::result(
        "supplied_electrical",
        "energy supplied by the source since the start; 0 unless record_energy",
        Local,
        unlimited(1e-8),
        value(|view| view.exchanged().electrical),
        UNDECLARED,
    )
    .in_unit(&units::JOULE),
    Row::result(
        "supplied_mechanical",
        "energy supplied by force since the start; 0 unless record_energy",
        Local,
        unlimited(1e-8),
        value(|view| view.exchanged().mechanical),
        UNDECLARED,
    )
    .in_unit(&units::JOULE),
    Row::result(
        "V_pull_in_static",
        "static pull-in voltage at the present force, branches relaxed; +inf, which JSON cannot hold, where there is none",
        Local,
        positive(1.0),
        value(|view| view.threshold(PullIn::Static)),
        UNDECLARED,
    )
    .or_infinite()
    .in_unit(&units::VOLT),
    Row::result(
        "V_pull_in_dynamic",
        "pull-in voltage of a step from rest at lambda = 1 without losses; +inf, which JSON cannot hold, where there is none",
        Local,
        positive(1.0),
        value(|view| view.threshold(PullIn::Dynamic)),
        UNDECLARED,
    )
    .or_infinite()
    .in_unit(&units::VOLT),
    Row::result(
        "V_pull_in_from_rest",
        "pull-in voltage of a step from rest with damping and R_s; with Maxwell branches the static one; +inf, which JSON cannot hold, where there is none",
        Local,
        positive(1.0),
        value(|view| view.threshold(PullIn::FromRest)),
        UNDECLARED,
    )
    .or_infinite()
    .in_unit(&units::VOLT),
    Row::result(
        "V_pull_in_glassy_static",
        "static pull-in voltage of the actuator whose branches have not relaxed; +inf, which JSON cannot hold, where there is none",
        Local,
        positive(1.0),
        value(|view| view.threshold(PullIn::GlassyStatic)),
        UNDECLARED,
    )
    .or_infinite()
    .in_unit(&units::VOLT),
    Row::result(
        "V_pull_in_glassy_dynamic",
        "pull-in voltage of a step of the actuator whose branches have not relaxed; +inf, which JSON cannot hold, where there is none",
        Local,
        positive(1.0),
        value(|view| view.threshold(PullIn::GlassyDynamic)),
        UNDECLARED,
    )
    .or_infinite()
    .in_unit(&units::VOLT),
    Row::result(
        "lambda3_pull_in_static",
        "thickness stretch at V_pull_in_static; 0 where there is no such voltage",
        Local,
        real(0.0, 1e6, 1.0),
        value(|view| view.thickness_at(PullIn::Static)),
        UNDECLARED,
    ),
    Row::result(
        "lambda3_pull_in_dynamic",
        "thickness stretch at V_pull_in_dynamic; 0 where there is no such voltage",
        Local,
        real(0.0, 1e6, 1.0),
        value(|view| view.thickness_at(PullIn::Dynamic)),
        UNDECLARED,
    ),
    Row::result(
        "lambda_snap",
        "stretch to which the actuator snaps at V_pull_in_static; 0 where it escapes or there is no such voltage",
        Local,
        real(0.0, 1e6, 1.0),
        value(|view| view.snaps_to()),
        UNDECLARED,
    ),
    Row::result(
        "pull_in_margin",
        "by how much supply_voltage may grow until a step from rest pulls in, or a slow ramp where no step does; negative beyond; +inf, which JSON cannot hold, where there is none",
        Local,
        unlimited(1e3),
        value(|view| view.pull_in_margin()),
        UNDECLARED,
    )
    .or_infinite()
    .in_unit(&units::VOLT),
    Row::result(
        "breakdown_margin",
        "by how much the true field may grow until breakdown; +inf, which JSON cannot hold, where E_breakdown = 0",
        Local,
        unlimited(1e8),
        value(|view| view.breakdown_margin()),
        UNDECLARED,
    )
    .or_infinite()
    .in_unit(&units::VOLT_PER_METRE),
    Row::result(
        "frequency",
        "frequency of small oscillations at the present stretch; 0 where it is unstable",
        Local,
        positive(1e5),
        value(|view| view.small_signal_frequency()),
        UNDECLARED,
    )
    .in_unit(&units::HERTZ),
    Row::result(
        "pull_in_time",
        "time at which pulled_in became true; +inf, which JSON cannot hold, until then",
        Local,
        unlimited(1.0),
        value(|view| view.pull_in_time()),
        UNDECLARED,
    )
    .or_infinite()
    .in_unit(&units::SECOND),
    Row::result(
        "breakdown_time",
        "time at which broken_down became true; +inf, which JSON cannot hold, until then",
        Local,
        unlimited(1.0),
        value(|view| view.breakdown_time()),
        UNDECLARED,
    )
    .or_infinite()
    .in_unit(&units::SECOND),
    EXTREMES[0],
    EXTREMES[1],
    EXTREMES[2],
    EXTREMES[3],
    Row::result(
        "pulled_in",
        "whether the stretch has reached lambda_min or lambda_max; the output collapsed is the same as a number",
        Local,
        Kind::Boolean,
        (|view| flag(view.pull_in_time() < f64::INFINITY), AT_EVENTS),
        depends(&[], &[]),
    )
    .at_events(),
    Row::result(
        "broken_down",
        "whether the true field has reached breakdown; the output breakdown is the same as a number",
        Local,
        Kind::Boolean,
        (|view| flag(view.breakdown_time() < f64::INFINITY), AT_EVENTS),
        depends(&[], &[]),
    )
    .at_events(),
    Row::result(
        "collapsed",
        "pulled_in as a number: 1 once the stretch has reached lambda_min or lambda_max, 0 before",
        Output,
        real(0.0, 1.0, 1.0),
        (|view| flag(view.pull_in_time() < f64::INFINITY), AT_EVENTS),
        depends(&[], &[]),
    )
    .at_events(),
    Row::result(
        "breakdown",
        "broken_down as a number: 1 once the true field has reached breakdown, 0 before",
        Output,
        real(0.0, 1.0, 1.0),
        (|view| flag(view.breakdown_time() < f64::INFINITY), AT_EVENTS),
        depends(&[], &CHOSEN_AND_CHARGED),
    )
    .at_events(),];

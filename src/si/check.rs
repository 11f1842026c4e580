//! What no single variable can tell: whether the values at the start go with each other.

use super::folded::Folded;
use super::scene::{BRANCHES, SiScene, place};
use crate::actuator::device::{Elasticity, Source};
use crate::actuator::scales::Scales;
use crate::shortest::Shortest;
use crate::solver::State;

impl SiScene {
    /// Checks that the described actuator has a motion from its start.
    ///
    /// # Errors
    /// A message with the values that exclude each other, and which of them to change.
    pub(super) fn check(&self) -> Result<(), String> {
        let State { position, .. } = self.start.motion;
        let limits = self.limits;
        let [stretch, lower, upper] = [position, limits.lower, limits.upper].map(Shortest);
        if !(limits.lower < position && position < limits.upper) {
            return Err(format!(
                "lambda_start = {stretch} does not lie between lambda_min = {lower} and \
                 lambda_max = {upper}; set it, or the limits, so that it does"
            ));
        }
        let source = self.source();
        for (other, name, unit) in [
            (Source::Current, "current", "A"),
            (Source::Charge, "charge_imposed", "C"),
        ] {
            let value = self.sources[place(other)].value();
            if other != source && value != 0.0 {
                return Err(format!(
                    "{name} = {} {unit} is given, and the source imposes the {}; set source to \
                     {}, or {name} to 0",
                    Shortest(value),
                    source.name(),
                    other.name()
                ));
            }
        }
        self.check_settings()?;
        let Folded { device, scales, .. } = self.folded();
        self.check_size(&scales)?;
        self.check_leak()?;
        if let Elasticity::Gent(locking) = &device.elasticity {
            let [low, high] = [locking.smallest(), locking.largest()].map(|wall| wall.value());
            if !(low < position && position < high) {
                return Err(format!(
                    "lambda_start = {stretch} lies beyond locking, which J_m = {} puts at {} and \
                     {}; set it in between",
                    Shortest(self.stiffening[0]),
                    Shortest(low),
                    Shortest(high)
                ));
            }
        }
        for k in 0..BRANCHES {
            let dashpot = self.start.dashpots[k];
            let limit = device.branches[k].limit;
            let ratio = (position / dashpot).powi(2);
            let stretched = 2.0 * ratio + 1.0 / (ratio * ratio) - 3.0;
            if device.branches[k].modulus > 0.0 && stretched >= limit {
                return Err(format!(
                    "xi{0}_start = {1} stretches the spring of branch {0} beyond locking at \
                     lambda_start = {stretch}; set it nearer to lambda_start",
                    k + 1,
                    Shortest(dashpot)
                ));
            }
        }
        Ok(())
    }

    /// Checks what may also change later.
    ///
    /// # Errors
    /// As of [`SiScene::check`].
    pub(super) fn check_settings(&self) -> Result<(), String> {
        let [limit, second, third] = self.stiffening;
        if limit > 0.0 && (second != 0.0 || third != 0.0) {
            return Err(format!(
                "J_m = {} chooses the Gent law and kappa2 = {}, kappa3 = {} the Yeoh law; set \
                 one of them to 0",
                Shortest(limit),
                Shortest(second),
                Shortest(third)
            ));
        }
        let source = self.source();
        if source != Source::Voltage && self.alternating[0] != 0.0 {
            return Err(format!(
                "V_ac = {} V is added to the supply voltage only, and the source imposes the {}; \
                 set V_ac to 0 or source to voltage",
                Shortest(self.alternating[0]),
                source.name()
            ));
        }
        let limits = self.limits;
        let permittivity = &self.folded().device.permittivity;
        for stretch in permittivity
            .extremes()
            .into_iter()
            .filter(|stretch| (limits.lower..=limits.upper).contains(stretch))
            .chain([limits.lower, limits.upper])
        {
            let [value, _] = permittivity.at(stretch);
            if value <= 0.0 {
                let [k1, k2, k3] = permittivity.terms.map(Shortest);
                return Err(format!(
                    "k1 = {k1}, k2 = {k2} and k3 = {k3} make the permittivity {} of what it is at 1 \
                     where the stretch is {}; it must stay above 0 between lambda_min = {} and \
                     lambda_max = {}, set these nearer to 1 or other k",
                    Shortest(value),
                    Shortest(stretch),
                    Shortest(limits.lower),
                    Shortest(limits.upper)
                ));
            }
        }
        Ok(())
    }

    /// Refuses a voltage, a charge or a force far beyond what the actuator can bear. Most likely the power of
    /// ten is wrong, of this value or of the geometry or the modulus.
    fn check_size(&self, scales: &Scales) -> Result<(), String> {
        let voltage = self.sources[0].value().abs() + self.alternating[0].abs();
        let ideal = self.source() == Source::Voltage && self.device.series_resistance == 0.0;
        let force = self.force.value();
        for (given, name, value, most, unit, scale) in [
            (
                ideal,
                "voltage",
                voltage,
                MOST_VOLTAGE * scales.voltage,
                "V",
                "H*sqrt(mu/eps)",
            ),
            (
                true,
                "force",
                force,
                MOST_FORCE * scales.force,
                "N",
                "mu*L*H*n_layers",
            ),
            (
                self.source() == Source::Charge,
                "charge_imposed",
                self.sources[2].value(),
                MOST_CHARGE * scales.charge,
                "C",
                "n_layers*L^2*sqrt(eps*mu)",
            ),
            (
                self.folded().device.has_charge_state(),
                "charge_start",
                self.start.charge,
                MOST_CHARGE * scales.charge,
                "C",
                "n_layers*L^2*sqrt(eps*mu)",
            ),
        ] {
            if given && value.abs() > most {
                return Err(format!(
                    "{name} = {} {unit} is out of proportion to {scale}; set a value between -{} \
                     and {1} {unit}, or check H, L, mu, eps_r and n_layers",
                    Shortest(value),
                    Shortest(rounded(most))
                ));
            }
        }
        Ok(())
    }

    /// Refuses a conductivity that overflows in the field of the supply voltage, or of the charge at the start.
    fn check_leak(&self) -> Result<(), String> {
        let supplied = self.sources[0].value().abs() / self.device.thickness;
        if self.source() == Source::Voltage && self.overflows_in(supplied) {
            let field = "the field voltage/H";
            return Err(self.conducts_too_much(supplied, field, "voltage and H"));
        }
        let charged = self
            .seen_in(&self.since, &self.start)
            .electric_field()
            .abs();
        if self.overflows_in(charged) {
            let charge = match self.source() {
                Source::Voltage if !self.folded().device.has_charge_state() => "voltage",
                Source::Voltage | Source::Current => "charge_start",
                Source::Charge => "charge_imposed",
            };
            let cause = format!("{charge}, lambda_start and H");
            return Err(self.conducts_too_much(charged, "electric_field at the start", &cause));
        }
        Ok(())
    }

    /// Whether the conductivity overflows in this true field in V/m, or is no physical one.
    pub(super) fn overflows_in(&self, field: f64) -> bool {
        let limit = self.device.conduction_field;
        limit > 0.0 && field > MOST_FIELDS * limit
    }

    /// Why the conductivity overflows in a field of this name in V/m, which follows from this `cause`.
    pub(super) fn conducts_too_much(&self, field: f64, name: &str, cause: &str) -> String {
        let limit = self.device.conduction_field;
        format!(
            "E_conduction = {} V/m is out of proportion to {name} = {} V/m, in which the conductivity would \
             grow by e^{:.0}; set 0 or at least {} V/m, or check {cause}",
            Shortest(limit),
            Shortest(field),
            field / limit,
            Shortest(rounded(1.1 * field / MOST_FIELDS))
        )
    }
}

/// Largest field, in units of E_conduction.
const MOST_FIELDS: f64 = 100.0;

/// Largest voltage at the start, in units of V0: pull-in lies near 0.7.
const MOST_VOLTAGE: f64 = 10.0;

/// Largest charge at the start, in units of Q0: a neo-Hookean sheet that holds it has the stretch 10.
const MOST_CHARGE: f64 = 1000.0;

/// Largest force at the start, in units of P0.
const MOST_FORCE: f64 = 100.0;

/// A positive number to two digits.
fn rounded(value: f64) -> f64 {
    let unit = 10.0_f64.powi(value.log10().floor() as i32 - 1);
    (value / unit).floor() * unit
}

//! The variables of the actuator in SI units: inputs, parameters, states and ports, values.

mod parameters;
mod ports;
mod values;

use super::Si;
use crate::model::variables::rows::real;
use crate::model::variables::{Alias, Variable, checked, units};

use parameters::{CHOICES, FREQUENCY, NUMBERS};
use ports::{ELECTRICAL, ELECTRICAL_IMPOSED, MECHANICAL, PORTS};
use values::VALUES;

type Row = Variable<Si>;

const INPUTS: [Row; 4] = [
    Row::input(
        "voltage",
        "supply voltage, if source is voltage",
        real(-2e5, 2e5, 1e3),
        |view| view.input(|scene| &scene.sources[0]),
        |scene| &mut scene.sources[0],
    )
    .starting_at(600.0)
    .member(&ELECTRICAL, "voltage")
    .converted("4 kV are 4000")
    .in_unit(&units::VOLT),
    Row::input(
        "current",
        "current into the actuator, if source is current",
        real(-1.0, 1.0, 1e-5),
        |view| view.input(|scene| &scene.sources[1]),
        |scene| &mut scene.sources[1],
    )
    .flow(&ELECTRICAL_IMPOSED, "current")
    .converted("1 mA is 1e-3")
    .in_unit(&units::AMPERE),
    Row::input(
        "charge_imposed",
        "charge on the electrodes, if source is charge",
        real(-1e-2, 1e-2, 1e-11),
        |view| view.input(|scene| &scene.sources[2]),
        |scene| &mut scene.sources[2],
    )
    .member(&ELECTRICAL_IMPOSED, "charge")
    .converted("1 nC is 1e-9")
    .in_unit(&units::COULOMB),
    Row::input(
        "force",
        "force on each pair of opposite edges, in both directions alike, positive outwards; its work is 2*force times the growth of edge_distance",
        real(-1e5, 1e5, 1e-3),
        |view| view.input(|scene| &scene.force),
        |scene| &mut scene.force,
    )
    .flow(&MECHANICAL, "force")
    .converted("2 mN are 2e-3")
    .in_unit(&units::NEWTON),
];

const COUNT: usize = INPUTS.len() + NUMBERS.len() + 1 + CHOICES.len() + PORTS.len() + VALUES.len();

/// All variables, in the order of their value references.
pub static VARIABLES: [Row; COUNT] = checked(joined());

/// Further names.
pub static ALIASES: [Alias; 1] = [Alias {
    name: "stretch",
    description: "lambda by a name that is no keyword of Python, for queries and attributes",
    of: "lambda",
}];

const fn joined() -> [Row; COUNT] {
    let mut all = [INPUTS[0]; COUNT];
    let parts: [&[Row]; 6] = [&INPUTS, &NUMBERS, &[FREQUENCY], &CHOICES, &PORTS, &VALUES];
    let (mut part, mut next) = (0, 0);
    while part < parts.len() {
        let mut row = 0;
        while row < parts[part].len() {
            all[next] = parts[part][row];
            next += 1;
            row += 1;
        }
        part += 1;
    }
    all
}

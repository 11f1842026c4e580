"""The motions under a constant voltage that the paper shows: Figs. 2, 3 (oscillation), 6, 7 and Table 1 (pull-in)."""

from __future__ import annotations

import figure_style as style
import figures
import references
import turning_points
from comparison import Comparison
from dielectric_actuator import Actuator
from pull_in_search import pull_in_bracket

TOLERANCE = 1e-12
SURFACE_PARAMETERS = ("gamma_s", "tau_s", "E_s")
MOTION = (*turning_points.OUTPUTS, "lambda3", "lambda3_dot")

PULL_IN_RESOLUTION = 1e-10
PULL_IN_DISTANCE = 1e-4
"""How far from the pull-in voltage the plotted responses are: the last digit that the paper prints."""

PULL_IN_SPANS = {"gamma_s": 140.0, "tau_s": 140.0, "E_s": 240.0}
"""Plotted times; with surface elasticity the motion above pull-in is periodic too, only much slower."""
TERMINATE = 2
"""Value of on_pull_in that ends the run at the collapse."""


def shared(cases: list[references.SurfaceEffects]) -> references.SurfaceEffects:
    """The reference case, whose values every other case has but for one."""
    return min(cases, key=lambda case: max(len(differing(case, other)) for other in cases))


def differing(one: references.SurfaceEffects, other: references.SurfaceEffects) -> list[str]:
    """The surface parameters in which two cases differ."""
    return [name for name in SURFACE_PARAMETERS if getattr(one, name) != getattr(other, name)]


def held(prestress: float) -> str:
    """The values of the parameters that are not varied in Figs. 2 and 3, for a title."""
    case = shared([orbit.case for orbit in references.dc_orbits() if prestress == orbit.case.S])
    return "the others held at " + style.setting(**{name: getattr(case, name) for name in SURFACE_PARAMETERS})


def families_of(cases: list[references.SurfaceEffects]) -> dict[str, list[int]]:
    """For each surface parameter the positions, by growing value, of the cases that vary it alone.

    The reference case, which lies on all three lines, is the one that shares two parameters with every other.
    """

    centre = shared(cases)
    lines = {}
    for parameter in SURFACE_PARAMETERS:
        positions = [k for k, case in enumerate(cases) if differing(case, centre) in ([], [parameter])]
        lines[parameter] = sorted(positions, key=lambda k: getattr(cases[k], parameter))
    return lines


def oscillations(actuator: Actuator, prestress: float, table: Comparison) -> dict[str, list[figures.Oscillation]]:
    """Responses of Fig. 2 or 3 to a voltage step for varied surface parameters; periods and turns go into `table`."""
    orbits = [orbit for orbit in references.dc_orbits() if prestress == orbit.case.S]
    span = 1.02 * 2 * max(orbit.period for orbit in orbits)
    found = []
    table.heading(f"DC, phi = {orbits[0].phi:g}, S = {prestress:g}: period T, thickness stretch at the turn")
    for orbit in orbits:
        response = actuator.run(
            orbit.scene(), stop_time=span, communication_step=0.1, outputs=MOTION, tolerance=TOLERANCE
        )
        period, stretch = turning_points.period_and_overshoot(response)
        case = " ".join(f"{name}={getattr(orbit.case, name):g}" for name in SURFACE_PARAMETERS)
        table.add(f"{case:<31} T", exact=orbit.period, measured=period)
        table.add(f"{'':<31} lambda3", exact=orbit.turning_lambda3, measured=stretch**-2)
        found.append((response, orbit.period, orbit.turning_lambda3))
    cases = [orbit.case for orbit in orbits]
    return {
        parameter: [figures.Oscillation(getattr(cases[k], parameter), *found[k]) for k in positions]
        for parameter, positions in families_of(cases).items()
    }


def pull_in(actuator: Actuator, table: Comparison) -> dict[str, list[figures.Transition]]:
    """The motion at both sides of the thresholds of Table 1, which go into `table`: found from the motion by
    bisection, and the FMU's own."""
    thresholds = references.table_1()
    found = []
    table.heading("Pull-in (Table 1): phi^C from the motion; phi_pull_in, lambda3_pull_in of the FMU")
    for threshold in thresholds:
        exact = threshold.dynamic
        below, above = pull_in_bracket(
            actuator, threshold.case.scene(), exact.stretch, below=0.5, above=1.0, resolution=PULL_IN_RESOLUTION
        )
        voltage = (below + above) / 2
        own_voltage, own_lambda3 = actuator.get("phi_pull_in", "lambda3_pull_in")
        case = " ".join(f"{n}={getattr(threshold.case, n):g}" for n in SURFACE_PARAMETERS if getattr(threshold.case, n))
        for quantity, printed, reference, measured in (
            (f"{case or 'ideal':<22} phi^C", threshold.printed_phi, exact.phi, voltage),
            (f"{'':<22} phi_pull_in", threshold.printed_phi, exact.phi, own_voltage),
            (f"{'':<22} lambda3_pull_in", threshold.printed_lambda3, exact.lambda3, own_lambda3),
        ):
            table.add(quantity, printed=printed, exact=reference, measured=measured)
        found.append((voltage, own_lambda3))

    def transition(k: int, parameter: str) -> figures.Transition:
        case, (voltage, lambda3) = thresholds[k].case, found[k]
        below, above = (
            actuator.run(
                case.scene(phi=voltage + offset, on_pull_in=TERMINATE),
                stop_time=PULL_IN_SPANS[parameter],
                communication_step=0.2,
                outputs=(*MOTION, "pulled_in"),
                tolerance=TOLERANCE,
            )
            for offset in (-PULL_IN_DISTANCE, PULL_IN_DISTANCE)
        )
        return figures.Transition(getattr(case, parameter), below, above, lambda3)

    return {
        parameter: [transition(k, parameter) for k in positions]
        for parameter, positions in families_of([threshold.case for threshold in thresholds]).items()
    }

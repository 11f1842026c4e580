"""Amplitude and phase of a damped film under an alternating voltage, and hysteresis near its resonance.

    python examples/device/resonance.py

Runs to the steady state with the built-in drive, prints mean, amplitude and phase of the stretch against the exact
steady values (tests/reference/device), then raises and lowers the frequency in small steps, without restarting,
and writes resonance.png.
"""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

from dielectric_actuator import Actuator

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "studies"))

import figure_style as style
import options
from film import FILM

REFERENCE = options.ROOT / "tests" / "reference" / "device" / "ac_steady_state.json"
STRONG = {"voltage": 0.0, "V_ac": 4000.0, "eta": 5.0}
"""A damping ratio of 0.054: one steady state at each frequency."""

WEAK = {"voltage": 0.0, "V_ac": 2500.0, "eta": 0.8}
"""A damping ratio of 0.0087: two at some."""

SAMPLES = 64
"""Of one period of the voltage."""

RANGE = np.linspace(50.0, 1300.0, 126)
"""Frequencies in Hz of the curves of amplitude and phase."""

SWEEP = np.arange(575.0, 605.1, 0.5)
"""Frequencies in Hz, up and down."""


def decay(viscosity: float, frequency: float, part: float) -> float:
    """Time in s, whole periods of the voltage, in which free oscillations fall to this part of themselves.

    The envelope is exp(−ζ ω t) with ζω = 3η/(ρ(L²/12 + H²/6)) at λ = 1.
    """
    rate = 3 * viscosity / (FILM["rho"] * (FILM["L"] ** 2 / 12 + FILM["H"] ** 2 / 6))
    return math.ceil(-math.log(part) / rate * frequency) / frequency


def exact_states() -> list[tuple[float, list[float]]]:
    """Frequency in Hz, with the exact mean, amplitude and phase lag of the steady state."""
    keys = ("lambda_mean", "lambda_amplitude_2f", "phase_lag_2f_rad")
    rows = json.loads(REFERENCE.read_text())["rows"]
    return [(float(row["f"]), [float(row[key]) for key in keys]) for row in rows]


def steady(actuator: Actuator, frequency: float) -> tuple[float, float, float]:
    """Mean, amplitude and phase lag of the stretch in the steady state.

    The force goes like V², −cos(4πft) up to its mean, hence twice the frequency of the voltage. The lag is in rad.
    """
    actuator.start({**FILM, **STRONG, "f_ac": frequency}, tolerance=1e-12)
    actuator.advance(decay(STRONG["eta"], frequency, 1e-13))
    stretch = np.empty(SAMPLES)
    for sample in range(SAMPLES):
        stretch[sample] = actuator.get("lambda")
        actuator.advance(1 / (SAMPLES * frequency))
    # the lines of a discrete Fourier transform: 0, and 2 for twice the frequency
    line = np.fft.fft(stretch) / SAMPLES
    return line[0].real, 2 * abs(line[2]), float(np.angle(-np.conj(line[2])))


def sweep(actuator: Actuator, frequencies: np.ndarray) -> np.ndarray:
    """Amplitude (largest less smallest stretch, halved) at each frequency, the motion going on between them."""
    actuator.start({**FILM, **WEAK, "f_ac": float(frequencies[0])})
    amplitudes = np.empty(len(frequencies))
    for number, frequency in enumerate(map(float, frequencies)):
        actuator.set({"f_ac": frequency})
        actuator.advance(decay(WEAK["eta"], frequency, 1e-12))
        actuator.set({"extremes_window": number + 1})
        actuator.advance(1 / frequency)
        lowest, highest = actuator.get("lambda_lowest", "lambda_highest")
        amplitudes[number] = (highest - lowest) / 2
    return amplitudes


def draw(response: np.ndarray, exact: np.ndarray, up: np.ndarray, down: np.ndarray) -> Figure:
    """Amplitude and phase, exact and by the FMU; amplitude up and down."""
    figure, panels = plt.subplots(1, 3, figsize=(13, 4.4))
    quantities = ("amplitude of the stretch at 2f", "phase lag in degrees")
    for column, (panel, quantity) in enumerate(zip(panels, quantities), start=1):
        scale = 180 / math.pi if column == 2 else 1.0
        panel.plot(response[:, 0], scale * response[:, column], label="FMU", **style.curve(0))
        panel.plot(exact[:, 0], scale * exact[:, column], "o", color=style.COLOURS[1], label="exact")
        panel.set(xlabel="frequency of the voltage in Hz", ylabel=quantity, xlim=(0, RANGE[-1]))
        panel.set_title(f"({'ab'[column - 1]})  {quantity.partition(' ')[0]}, 4 kV, η = 5 Pa s", loc="left")
    panels[0].legend()
    panels[2].plot(SWEEP, up, marker="^", markersize=4, label="frequency raised", **style.curve(0))
    panels[2].plot(SWEEP[::-1], down, marker="v", markersize=4, label="frequency lowered", **style.curve(1))
    panels[2].set(xlabel="frequency of the voltage in Hz", ylabel="amplitude of the stretch")
    panels[2].set_title("(c)  hysteresis, 2.5 kV, η = 0.8 Pa s", loc="left")
    panels[2].legend()
    return figure


def main() -> None:
    """Run, compare, draw."""
    arguments = options.parse(__doc__)
    style.apply()
    exact = exact_states()
    with Actuator(arguments.fmu) as actuator:
        print(f"{'f in Hz':>8}{'mean':>14}{'amplitude':>14}{'lag in rad':>14}   errors of the three")
        for frequency, right in exact:
            found = steady(actuator, frequency)
            errors = [abs(one - other) for one, other in zip(found, right)]
            values = "".join(f"{value:>14.10f}" for value in found)
            print(f"{frequency:>8g}{values}   " + " ".join(f"{error:.0e}" for error in errors))
        response = np.array([[frequency, *steady(actuator, frequency)[1:]] for frequency in map(float, RANGE)])
        up, down = sweep(actuator, SWEEP), sweep(actuator, SWEEP[::-1])
    apart = SWEEP[np.abs(up - down[::-1]) > 0.01]
    print(f"two amplitudes from {apart.min():g} to {apart.max():g} Hz, by the way the frequency came")
    print(f"elsewhere the sweeps agree to {np.abs(up - down[::-1])[~np.isin(SWEEP, apart)].max():.0e}")
    print(
        style.save(
            draw(response, np.array([[frequency, *state[1:]] for frequency, state in exact]), up, down),
            arguments.output / "resonance.png",
        )
    )


if __name__ == "__main__":
    main()

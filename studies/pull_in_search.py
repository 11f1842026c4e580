"""Pull-in voltage found from the motion of the actuator, without any use of the energy method.

From rest at λ = 1 the stretch grows to an overshoot and turns back, and the overshoot grows with the
voltage. At the dynamic pull-in voltage it reaches the thickness stretch λ₃ᶜ, where the orbit meets a
saddle. Past it the motion does not turn there: without surface elasticity it escapes to λ → ∞, with it
the motion is again periodic on a much larger orbit. So neither escape nor loss of periodicity tells the
two sides apart for every parameter set; whether the first rise carries the stretch past the saddle does.
"""

from __future__ import annotations

import math

from dielectric_actuator import Actuator, Scene

TOLERANCE = 1e-12


def pulls_in(actuator: Actuator, scene: Scene, voltage: float, saddle_stretch: float) -> bool:
    """Whether the first rise from rest at a constant voltage passes `saddle_stretch` (= 1/sqrt(λ₃ᶜ)).

    Near the threshold the motion lingers at the saddle for a time that grows like ln(1/|φ − φᶜ|).
    Raises RuntimeError if it has done neither after 200 small-amplitude periods.
    """
    actuator.start({**scene, "phi": voltage}, tolerance=TOLERANCE)
    small_amplitude_period = 2 * math.pi * math.sqrt(actuator.get("c") / 6)
    step = small_amplitude_period / 25
    while actuator.time < 200 * small_amplitude_period:
        actuator.advance(step)
        stretch, rate = actuator.get("lambda", "lambda_dot")
        if stretch > saddle_stretch:
            return True
        if rate < 0:
            return False
    raise RuntimeError(f"at phi = {voltage!r} the stretch neither turned nor passed {saddle_stretch:.6g}")


def pull_in_bracket(
    actuator: Actuator,
    scene: Scene,
    saddle_stretch: float,
    *,
    below: float,
    above: float,
    resolution: float,
) -> tuple[float, float]:
    """Two voltages at most `resolution` apart, the first without and the second with pull-in.

    Raises ValueError if the given `below` and `above` do not lie on the two sides.
    """
    if pulls_in(actuator, scene, below, saddle_stretch) or not pulls_in(actuator, scene, above, saddle_stretch):
        raise ValueError(f"no pull-in between phi = {below} and phi = {above}")
    while above - below > resolution:
        middle = (below + above) / 2
        if pulls_in(actuator, scene, middle, saddle_stretch):
            above = middle
        else:
            below = middle
    return below, above

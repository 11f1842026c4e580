"""Further scenes of the real actuator, integrated another way; needs numpy and scipy.

Nothing here is shared with the library: SI units throughout, the stretch ξ of a dashpot instead of its
square, forces as derivatives of the energies (complex step), Radau IIA collocation with all states solved
at once by Newton's method, in 80-bit arithmetic. Each scene is solved twice, with 12 and with 15 nodes and
other steps; `agreed_digits` says how far both agree.

    python tests/reference/device/derive_scenes.py
"""

import json
from pathlib import Path

import numpy as np
from scipy.linalg import lu_factor, lu_solve

REAL, COMPLEX = np.longdouble, np.clongdouble
EPSILON_0 = REAL("8.8541878188e-12")
TINY = REAL("1e-40")
HERE = Path(__file__).parent


def radau(count):
    """Nodes c in (0, 1] and the matrix A of Radau IIA, in 80-bit arithmetic."""
    legendre = np.polynomial.legendre
    difference = np.zeros(count + 1)
    difference[count - 1], difference[count] = 1.0, -1.0
    roots = np.sort(legendre.legroots(difference)).astype(REAL)

    def value(u, degree):
        last, now = np.ones_like(u), u
        for k in range(1, degree):
            last, now = now, ((2 * k + 1) * u * now - k * last) / (k + 1)
        return last, now

    for _ in range(5):
        before, now = value(roots, count)
        before_that, _ = value(roots, count - 1)
        inner = roots[:-1]
        f = before[:-1] - now[:-1]
        slope_now = count * (before[:-1] - inner * now[:-1]) / (1 - inner**2)
        slope_before = (count - 1) * (before_that[:-1] - inner * before[:-1]) / (1 - inner**2)
        roots[:-1] -= f / (slope_before - slope_now)
        roots[-1] = 1
    before, _ = value(roots, count)
    weights = (1 + roots) / (count * before) ** 2
    polynomials: list[np.ndarray] = [np.ones_like(roots), roots]
    for k in range(1, count):
        polynomials.append(((2 * k + 1) * roots * polynomials[k] - k * polynomials[k - 1]) / (k + 1))
    matrix = np.zeros((count, count), dtype=REAL)
    for k in range(count):
        share = (2 * k + 1) / REAL(2) * weights * polynomials[k]
        integral = roots + 1 if k == 0 else (polynomials[k + 1] - polynomials[k - 1]) / (2 * k + 1)
        matrix += np.outer(integral, share)
    return (1 + roots) / 2, matrix / 2


def number(value):
    return REAL(str(value))


def step(f):
    """The derivative of a function evaluated a tiny imaginary step aside."""
    return np.imag(f) / TINY


class Actuator:
    """The energies and dissipations of an actuator in SI units."""

    def __init__(self, parameters):
        self.p = {k: number(v) for k, v in parameters.items() if not isinstance(v, (list, dict))}
        self.branches = [
            [number(b[0]), number(b[1]), None if b[2] is None else number(b[2])] for b in parameters.get("branches", [])
        ]
        self.voltage = [number(v) for v in parameters.get("V_polynomial", [self["V"]])]
        self.force = [number(v) for v in parameters.get("P_polynomial", [self["P"]])]
        self.T = self["n"] * self["H"]
        self.volume = self["L"] ** 2 * self.T
        self.current = "I" in self.p
        self.has_charge = self.current or self["R_s"] > 0

    def __getitem__(self, key):
        return self.p.get(key, REAL(0))

    def source(self, t):
        if self.current:
            return self["I"] + 0 * t
        angle = 2 * REAL(np.pi) + REAL("1.2246467991473532e-16") * 2
        alternating = self["V_ac"] * np.sin(angle * self["f"] * t)
        return sum(v * t**k for k, v in enumerate(self.voltage)) + alternating

    def pull(self, t):
        return sum(v * t**k for k, v in enumerate(self.force)) + 0 * t

    def inertia(self, x):
        sheet = self["rho"] * self.T * self["L"] ** 4 / 12 + self["m"] * self["L"] ** 2
        return sheet + self["rho"] * self.T**3 * self["L"] ** 2 / 6 * x**-6

    def capacitance(self, x):
        y = x - 1
        e = 1 + self["k1"] * y + self["k2"] * y**2 + self["k3"] * y**3
        return self["n"] * EPSILON_0 * self["epsr"] * e * self["L"] ** 2 / self["H"] * x**4

    @staticmethod
    def stiffened(i, limit):
        return i if limit is None else -limit * np.log(1 - i / limit)

    @staticmethod
    def invariant(x):
        return 2 * x**2 + x**-4 - 3

    def branch_energy(self, k, x, xi):
        mu, _, limit = self.branches[k]
        return self.volume * mu / 2 * self.stiffened(self.invariant(x / xi), limit)

    def energy(self, x, xis):
        """All that is stored and does not depend on the charge."""
        i = self.invariant(x)
        elastic = self.stiffened(i, self.p.get("J"))
        elastic = elastic + self["kappa2"] * i**2 + self["kappa3"] * i**3
        g = x**2 - 1
        surfaces = self.p.get("n_s", REAL(2)) / 2
        surface = 2 * self["gamma_s"] * g + 2 * self["tau_s"] * x**2 * g + self["E_s"] * (x * g) ** 2
        spring = self["k"] * (self["L"] * x - self["l_k"]) ** 2
        total = self.volume * self["mu"] / 2 * elastic + surfaces * self["L"] ** 2 * surface + spring
        return total + sum(self.branch_energy(k, x, xi) for k, xi in enumerate(xis))

    def membrane(self, x, t, q):
        return q / self.capacitance(x) if self.has_charge else self.source(t)

    def leak(self, x, v):
        field = np.where(v.real < 0, -v, v) * x**2 / self["H"]
        grown = np.exp(field / self["E_c"]) if self["E_c"] > 0 else 1
        material = self["sigma"] * grown * self["n"] * self["L"] ** 2 * x**4 / self["H"]
        return v * (self["G_p"] + material)

    def rates(self, t, y):
        """d/dt of (λ, λ', Q, ξ…, losses and supplies) at times t, states along the last axis."""
        x, v, q = y[0], y[1], y[2]
        xis = y[3 : 3 + len(self.branches)]
        shifted = x + 1j * TINY
        voltage = self.membrane(x, t, q)
        force = -step(self.energy(shifted, list(xis)) + 0 * shifted)
        force = force + voltage**2 / 2 * step(self.capacitance(shifted))
        damping = 2 * self["b"] * self["L"] ** 2 + 12 * self["eta"] * self.volume / x**2
        force = force + 2 * self.pull(t) * self["L"] - damping * v
        inertia = self.inertia(x)
        a = (force - step(self.inertia(shifted)) * v**2) / (2 * inertia)
        leak = self.leak(x, voltage)
        if self.current:
            current = self.source(t)
            charging = current - leak
            supply = voltage + self["R_s"] * current
        elif self.has_charge:
            current = (self.source(t) - voltage) / self["R_s"]
            charging, supply = current - leak, self.source(t)
        else:
            slope = step(self.source(t + 1j * TINY))
            capacitance = self.capacitance(x)
            charging = capacitance * slope + voltage * step(self.capacitance(shifted)) * v
            current, supply = charging + leak, voltage
            charging = 0 * charging
        flows, lost = [], 0 * x
        for k, xi in enumerate(xis):
            mu, tau, _ = self.branches[k]
            pull = -step(self.branch_energy(k, x + 0j, xi + 1j * TINY))
            rate = pull * xi**2 / (12 * mu * tau * self.volume)
            flows.append(rate)
            lost = lost + pull * rate
        powers = [damping * v**2, lost, self["R_s"] * current**2, voltage * leak]
        powers += [supply * current, 2 * self.pull(t) * self["L"] * v]
        return np.array([v, a, charging, *flows, *powers]), current


def jacobian(actuator, t, y, sizes, active):
    """∂(rates)/∂(states) of the first `active` states, by central differences."""
    out = np.zeros((active, active, y.shape[1]))
    for j in range(active):
        step = 1e-6 * sizes[j]
        up, down = y.copy(), y.copy()
        up[j] += step
        down[j] -= step
        change = actuator.rates(t, up)[0][:active] - actuator.rates(t, down)[0][:active]
        out[:, j] = (change / (2 * step)).astype(float)
    return out


def integrate(actuator, y, times, count, longest, fastest):
    c, a = radau(count)
    active = 3 + len(actuator.branches)
    t, rows = REAL(0), []
    step = REAL(fastest)
    period = REAL(longest)
    for target in times:
        while t < target:
            h = min(step, target - t)
            nodes = t + c * h
            states = np.repeat(y[:, None], count, axis=1)
            sizes = np.array([1.0, 1.0 / longest, 1e-8, 1.0, 1.0, 1.0])[:active]
            system = None
            for iteration in range(40):
                rates, _ = actuator.rates(nodes, states)
                residual = states[:active] - y[:active, None] - h * rates[:active] @ a.T
                if iteration % 4 == 0:
                    local = jacobian(actuator, nodes, states, sizes, active)
                    blocks = -float(h) * np.einsum("ij,pqj->piqj", a.astype(float), local)
                    blocks = blocks.reshape(active * count, active * count)
                    scaling = np.repeat(sizes, count)
                    blocks = blocks * scaling[None, :] / scaling[:, None] + np.eye(active * count)
                    system = lu_factor(blocks)
                right = (residual / sizes[:, None]).astype(float).reshape(-1)
                change = lu_solve(system, right).reshape(active, count)
                states[:active] -= change * sizes[:, None]
                if np.max(np.abs(change)) < 1e-17:
                    break
            rates, _ = actuator.rates(nodes, states)
            y = y + h * (rates @ a[-1])
            y[:active] = states[:active, -1]
            t = t + h
            if h == step:
                step = min(step * 2, period)
        current = actuator.rates(np.array([t]), y[:, None])[1][0]
        rows.append((y.copy(), current))
    return rows


def derive(name, title, parameters, stop, period, fastest):
    actuator = Actuator(parameters)
    rng = np.random.default_rng(sum(map(ord, name)))
    times = np.sort(rng.uniform(0.02, 1, 16)) * stop
    times = [REAL(f"{t:.6e}") for t in times]
    charge = REAL(0)
    if not actuator.has_charge:
        charge = actuator.capacitance(REAL(1)) * actuator.source(REAL(0))
    start = np.array([1, 0, charge, *[1] * len(actuator.branches), *[0] * 6], dtype=REAL)
    coarse = integrate(actuator, start, times, 12, period / 24, fastest)
    fine = integrate(actuator, start, times, 15, period / 30, fastest / 3)
    keys = ["lost_damping_J", "lost_branches_J", "lost_series_resistance_J", "lost_leakage_J"]
    keys += ["supplied_electric_J", "supplied_mechanical_J"]
    rows, worst = [], 0.0
    sizes = np.max(np.abs([y for y, _ in fine]), axis=0)
    for t, (y, current), (other, _) in zip(times, fine, coarse):
        worst = max(worst, float(np.max(np.abs(y - other) / np.where(sizes > 0, sizes, 1))))
        count = 3 + len(actuator.branches)
        charge = y[2]
        if not actuator.has_charge:
            charge = actuator.capacitance(y[0]) * actuator.source(t)
        row = {"t_s": t, "lambda": y[0], "lambda_dot_per_s": y[1], "charge_C": charge}
        row |= {f"xi{k + 1}": y[3 + k] for k in range(len(actuator.branches))}
        row |= {key: y[count + k] for k, key in enumerate(keys)}
        row["supply_current_A"] = current
        rows.append({k: np.format_float_scientific(v, precision=19) for k, v in row.items()})
    digits = int(-np.log10(max(worst, 1e-19)))
    print(f"{name}: {digits} digits agree")
    text = {k: v if isinstance(v, list) else str(v) for k, v in parameters.items()}
    file = {"scene": name, "title": title, "eps0": "8.8541878188e-12", "parameters_SI": text}
    initial = float(charge_at_start(actuator))
    file["start"] = {"lambda": "1", "lambda_dot": "0", "charge_C": repr(initial)}
    file |= {"agreed_digits": digits, "methods": __doc__.split("\n\n")[1].replace("\n", " ")}
    file["rows"] = rows
    (HERE / f"{name}.json").write_text(json.dumps(file, indent=1) + "\n")


def charge_at_start(actuator):
    if actuator.has_charge:
        return REAL(0)
    return actuator.capacitance(REAL(1)) * actuator.source(REAL(0))


SHEET = {"mu": "361.4e3", "rho": "1080", "epsr": "2.8", "H": "100e-6", "L": "20e-3", "n": "1"}
PERIOD = 8.1e-4


def main():
    derive(
        "own_stiff_rc",
        "5.5 kV step through 12 ohm (RC = 1.5e-6 periods), uncharged at start",
        SHEET | {"V": "5500", "R_s": "12"},
        6 * PERIOD,
        PERIOD,
        2e-10,
    )
    derive(
        "own_linear_damping",
        "5.8 kV step, dashpot 0.03 N s/m",
        SHEET | {"V": "5800", "b": "0.03"},
        6 * PERIOD,
        PERIOD,
        1e-5,
    )
    derive(
        "own_current",
        "0.2 mA from 0 charge, with a fixed resistor and a leaking material",
        SHEET | {"I": "2e-4", "G_p": "1e-9", "sigma": "1e-10", "R_s": "1e5"},
        6 * PERIOD,
        PERIOD,
        1e-5,
    )
    derive(
        "own_overdamped",
        "6 kV step, viscosity far above critical (zeta = 80)",
        SHEET | {"V": "6000", "eta": "7500"},
        60 * PERIOD,
        PERIOD,
        1e-8,
    )
    derive(
        "own_ramp",
        "voltage and force as polynomials of the time, 2 Mohm",
        SHEET
        | {
            "V": "0",
            "V_polynomial": ["1000", "2e6", "-4e8"],
            "R_s": "2e6",
            "P": "0",
            "P_polynomial": ["0", "40", "-4e3"],
        },
        5 * PERIOD,
        PERIOD,
        1e-5,
    )
    derive(
        "own_everything",
        "3 layers, surfaces, Gent, permittivity, load, both dampings, three branches, all leaks, AC and force",
        SHEET
        | {
            "n": "3",
            "gamma_s": "0.6",
            "tau_s": "0.4",
            "E_s": "1.1",
            "n_s": "4",
            "J": "40",
            "m": "2e-5",
            "k": "60",
            "l_k": "18e-3",
            "k1": "-0.11",
            "k2": "0.02",
            "k3": "-0.003",
            "b": "0.006",
            "eta": "1.5",
            "branches": [["120e3", "0.4e-3", None], ["60e3", "6e-3", "60"], ["40e3", "4e-6", None]],
            "R_s": "3e5",
            "G_p": "2e-9",
            "sigma": "4e-9",
            "E_c": "3e7",
            "V": "4500",
            "V_ac": "1500",
            "f": "700",
            "P": "0.4",
        },
        6 * PERIOD,
        PERIOD,
        2e-7,
    )
    derive(
        "own_yeoh_gravity",
        "Yeoh, ideal source, AC beside a bias, leakage, force and a compressed spring",
        SHEET
        | {
            "kappa2": "-0.0924",
            "kappa3": "0.0365",
            "V": "3000",
            "V_ac": "2500",
            "f": "410",
            "P": "0.05",
            "k": "30",
            "l_k": "25e-3",
            "G_p": "1e-8",
            "sigma": "1e-9",
            "E_c": "2e7",
        },
        6 * PERIOD,
        PERIOD,
        1e-5,
    )


if __name__ == "__main__":
    main()

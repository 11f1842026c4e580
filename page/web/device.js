// A device in SI units, and the scales that lead from it to the nondimensional model.

/** Permittivity of vacuum in F/m (CODATA 2022). */
const VACUUM = 8.8541878188e-12;

/** The scales of a device, by which a nondimensional number is multiplied: one layer, both faces free. */
export function scales(device) {
  const permittivity = VACUUM * device.relativePermittivity;
  return {
    time: device.thickness * Math.sqrt(device.density / (12 * device.modulus)),
    voltage: device.thickness * Math.sqrt(device.modulus / permittivity),
    stress: device.modulus,
    surface: device.modulus * device.thickness,
  };
}

/** The parameters of the model that restart the motion when they change. */
export function parameters(device) {
  const { surface } = scales(device);
  return {
    c: (device.side / device.thickness) ** 2,
    gamma_s: device.surfaceEnergy / surface,
    tau_s: device.surfaceTension / surface,
    E_s: device.surfaceElasticity / surface,
  };
}

/** The load, which acts at once. */
export function load(device) {
  const { time, voltage, stress } = scales(device);
  return {
    phi: device.voltage / voltage,
    S: device.prestress / stress,
    phi_ac: device.driveVoltage / voltage,
    omega_ac: 2 * Math.PI * device.driveFrequency * time,
  };
}

/** Natural frequency in Hz of small oscillations about λ = 1 without load and surface effects. */
export function naturalFrequency(device) {
  const { c } = parameters(device);
  return Math.sqrt(6 / (c + 2)) / (2 * Math.PI * scales(device).time);
}

/** What can be set: in `unit`, of which one is `factor` SI units; `variable` is its name in the SI FMU. Ranges may follow the device. */
export const QUANTITIES = [
  { key: "voltage", variable: "voltage", group: "Load", label: "Voltage", unit: "V", factor: 1, min: 0, max: (d) => 1.5 * scales(d).voltage },
  { key: "prestress", group: "Load", label: "Prestress (force on an edge over its area)", short: "Prestress", unit: "kPa", factor: 1e3, min: 0, max: (d) => d.modulus },
  { key: "driveVoltage", variable: "V_ac", group: "Load", label: "Amplitude of the alternating voltage", short: "Alternating voltage", unit: "V", factor: 1, min: 0, max: (d) => scales(d).voltage },
  { key: "driveFrequency", variable: "f_ac", group: "Load", label: "Frequency of the alternating voltage", short: "Its frequency", unit: "kHz", factor: 1e3, min: 0, max: (d) => 3 * naturalFrequency(d) },
  { key: "thickness", variable: "H", group: "Size", label: "Thickness", unit: "µm", factor: 1e-6, min: 0.1e-6, max: 2e-3, logarithmic: true },
  { key: "side", variable: "L", group: "Size", label: "Side", unit: "mm", factor: 1e-3, min: 1e-6, max: 0.1, logarithmic: true },
  { key: "surfaceEnergy", variable: "gamma_s", group: "Surface", label: "Surface energy", unit: "mN/m", factor: 1e-3, min: 0, max: 0.2 },
  { key: "surfaceTension", variable: "tau_s", group: "Surface", label: "Surface tension", unit: "mN/m", factor: 1e-3, min: 0, max: 0.2 },
  { key: "surfaceElasticity", variable: "E_s", group: "Surface", label: "Surface elasticity", unit: "mN/m", factor: 1e-3, min: 0, max: 1 },
  { key: "modulus", variable: "mu", group: "Material", label: "Shear modulus", unit: "kPa", factor: 1e3, min: 5e3, max: 5e6, logarithmic: true },
  { key: "density", variable: "rho", group: "Material", label: "Density", unit: "kg/m³", factor: 1, min: 500, max: 3000 },
  { key: "relativePermittivity", variable: "eps_r", group: "Material", label: "Relative permittivity", unit: "", factor: 1, min: 1, max: 20 },
];

/** The quantities that the motion goes on under; a change of any other starts it anew. */
export const LOAD = new Set(QUANTITIES.filter(({ group }) => group === "Load").map(({ key }) => key));

export const upper = (quantity, device) => (typeof quantity.max === "function" ? quantity.max(device) : quantity.max);

/** Why a value cannot be taken; nothing where it can. */
export function fault(quantity, value) {
  const shown = (number) => `${format(number / quantity.factor, 4)} ${quantity.unit}`.trim();
  const name = quantity.short ?? quantity.label;
  if (!Number.isFinite(value)) return `${name} is not a number`;
  if (value < quantity.min) return `${name} of ${shown(value)} is below ${shown(quantity.min)}`;
  if (typeof quantity.max === "number" && value > quantity.max) {
    return `${name} of ${shown(value)} is above ${shown(quantity.max)}`;
  }
  return undefined;
}

/** A device as the part of an address behind the `#`, in the units of the page. */
export function toAddress(device) {
  const parts = QUANTITIES.map(({ key, factor }) => [key, String(Number((device[key] / factor).toPrecision(12)))]);
  return new URLSearchParams(parts).toString();
}

/** A device from an address, what it does not say from `device`; and what could not be taken. */
export function fromAddress(text, device) {
  const said = new URLSearchParams(text.replace(/^#/, ""));
  const faults = [];
  const found = { ...device };
  for (const [key, number] of said) {
    const quantity = QUANTITIES.find((one) => one.key === key);
    if (!quantity) {
      faults.push(`nothing is called ${key}; there is ${QUANTITIES.map((one) => one.key).join(", ")}`);
      continue;
    }
    const value = number.trim() === "" ? NaN : Number(number) * quantity.factor;
    const wrong = fault(quantity, value);
    if (wrong) faults.push(wrong);
    else found[key] = value;
  }
  return { device: found, faults };
}

/** A number in so many digits, without a power of ten where people would write none. */
export function format(value, digits = 4) {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e6 || size < 1e-3) {
    const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
    return `${mantissa}·10${[...String(Number(exponent))].map((sign) => "⁰¹²³⁴⁵⁶⁷⁸⁹"["0123456789".indexOf(sign)] ?? "⁻").join("")}`;
  }
  return String(Number(value.toPrecision(digits)));
}

/** A number of SI units with the prefix that fits. */
export function withPrefix(value, unit, digits = 4) {
  if (!Number.isFinite(value)) return "none";
  if (value === 0) return `0 ${unit}`;
  const prefixes = ["p", "n", "µ", "m", "", "k", "M", "G"];
  const place = Math.min(7, Math.max(0, Math.floor(Math.log10(Math.abs(value)) / 3 + 1e-9) + 4));
  return `${format(value / 1000 ** (place - 4), digits)} ${prefixes[place]}${unit}`;
}

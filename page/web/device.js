// A device in SI units, between which values it can be set, and how an address says it.
import { actuator } from "./core.js";

/** The load in the numbers of the model; it acts at once. */
export function load(device) {
  const { time, voltage, stress } = actuator.fold(device).scales;
  return {
    phi: device.voltage / voltage,
    S: device.prestress / stress,
    phi_ac: device.driveVoltage / voltage,
    omega_ac: 2 * Math.PI * device.driveFrequency * time,
  };
}

const voltageScale = (device) => actuator.fold(device).scales.voltage;

function freeFrequency(device) {
  const { period, scales } = actuator.fold(device);
  return 1 / (period * scales.time);
}

/**
 * What can be set: in `unit`, of which one is `factor` SI units. `variable` is its name in the SI FMU, `number` the number
 * of the model that it leads to before others. A `max` that follows the device is that of the slider only.
 */
export const QUANTITIES = [
  { key: "voltage", variable: "voltage", number: "phi", group: "Load", label: "Voltage", unit: "V", factor: 1, min: 0, max: (d) => 1.5 * voltageScale(d) },
  { key: "prestress", number: "S", group: "Load", label: "Prestress (force on an edge over its area)", short: "Prestress", unit: "kPa", factor: 1e3, min: 0, max: (d) => d.modulus },
  { key: "driveVoltage", variable: "V_ac", number: "phi_ac", group: "Load", label: "Amplitude of the alternating voltage", short: "Alternating voltage", unit: "V", factor: 1, min: 0, max: voltageScale },
  { key: "driveFrequency", variable: "f_ac", number: "omega_ac", group: "Load", label: "Frequency of the alternating voltage", short: "Its frequency", unit: "kHz", factor: 1e3, min: 0, max: (d) => 3 * freeFrequency(d) },
  { key: "thickness", variable: "H", group: "Size", label: "Thickness", unit: "µm", factor: 1e-6, min: 0.1e-6, max: 2e-3, logarithmic: true },
  { key: "side", variable: "L", number: "c", group: "Size", label: "Side", unit: "mm", factor: 1e-3, min: 1e-6, max: 0.1, logarithmic: true },
  { key: "surfaceEnergy", variable: "gamma_s", number: "gamma_s", group: "Surface", label: "Surface energy", unit: "mN/m", factor: 1e-3, min: 0, max: 0.2 },
  { key: "surfaceTension", variable: "tau_s", number: "tau_s", group: "Surface", label: "Surface tension", unit: "mN/m", factor: 1e-3, min: 0, max: 0.2 },
  { key: "surfaceElasticity", variable: "E_s", number: "E_s", group: "Surface", label: "Surface elasticity", unit: "mN/m", factor: 1e-3, min: 0, max: 1 },
  { key: "modulus", variable: "mu", group: "Material", label: "Shear modulus", unit: "kPa", factor: 1e3, min: 5e3, max: 5e6, logarithmic: true },
  { key: "density", variable: "rho", group: "Material", label: "Density", unit: "kg/m³", factor: 1, min: 500, max: 3000 },
  { key: "relativePermittivity", variable: "eps_r", group: "Material", label: "Relative permittivity", unit: "", factor: 1, min: 1, max: 20 },
];

/** The quantities that the motion goes on under; a change of any other starts it anew. */
export const LOAD = new Set(QUANTITIES.filter(({ group }) => group === "Load").map(({ key }) => key));

/** Rounded to four digits by `round`, from a number that is off by far less towards the side that is wanted. */
function inwards(number, round) {
  if (!(number > 0 && number < Infinity)) return number;
  const last = 10 ** (Math.floor(Math.log10(number)) - 3);
  return Number((round(number / last) * last).toPrecision(4));
}

/**
 * Between which values of a quantity the model takes a device, the rest of it being as it is; `number` is that of the
 * model which is at its limit there. Each is a power of each quantity, in halves, times what the rest makes of it.
 */
function modelEnds({ key, factor }, device) {
  const [low, high] = [{ value: 0 }, { value: Infinity }];
  const [once, twice] = [1, 2].map((units) => {
    const changed = { ...device, [key]: units * factor };
    return { ...actuator.fold(changed).parameters, ...load(changed) };
  });
  for (const [number, value] of Object.entries(once)) {
    const power = Math.round(2 * Math.log2(twice[number] / value)) / 2;
    if (!power) continue;
    const [least, most] = actuator.limits(number)
      .map((limit) => (Math.max(limit, 0) / value) ** (1 / power))
      .sort((a, b) => a - b);
    const ends = [inwards(least * (1 + 1e-9), Math.ceil) * factor, inwards(most * (1 - 1e-9), Math.floor) * factor];
    if (ends[0] > low.value) Object.assign(low, { value: ends[0], number });
    if (ends[1] < high.value) Object.assign(high, { value: ends[1], number });
  }
  return { low, high };
}

/** Between which values a quantity can be set: the page's own ends, and those of the model where a device is given. */
function endsOf(quantity, device) {
  const own = { low: { value: quantity.min }, high: { value: typeof quantity.max === "number" ? quantity.max : Infinity } };
  if (!device) return own;
  const { low, high } = modelEnds(quantity, device);
  return { low: low.value > own.low.value ? low : own.low, high: high.value < own.high.value ? high : own.high };
}

/** The ends of the slider. */
export function range(quantity, device) {
  const { low, high } = endsOf(quantity, device);
  return [low.value, Math.min(typeof quantity.max === "function" ? quantity.max(device) : Infinity, high.value)];
}

/** Why a value cannot be taken, by the model too where a device is given; nothing where it can. */
export function fault(quantity, value, device) {
  if (!Number.isFinite(value)) return `${nameOf(quantity)} is not a number`;
  const { low, high } = endsOf(quantity, device);
  const refused = (relation, end, extreme, direction) => {
    const [because, otherwise] = reason(quantity, end, extreme, device);
    return `${nameOf(quantity)} of ${shown(quantity, value)} is ${relation} ${shown(quantity, end.value)}${because}; set that or ${direction}${otherwise}`;
  };
  if (value < low.value * (1 - 1e-12)) return refused("below", low, "least", "more");
  if (value > high.value * (1 + 1e-12)) return refused("above", high, "most", "less");
  return undefined;
}

/** What makes an end one, and what else can be done: nothing to say of the page's own. */
function reason(quantity, end, extreme, device) {
  const leading = QUANTITIES.find(({ number }) => number && number === end.number);
  if (!leading) return ["", ""];
  if (leading === quantity) return [`, the ${extreme} for this device`, ""];
  const name = nameOf(leading).toLowerCase();
  return [`, the ${extreme} while the ${name} is ${shown(leading, device[leading.key])}`, `, or change the ${name} first`];
}

const nameOf = ({ label }) => label.replace(/ \(.*/, "");
const shown = ({ factor, unit }, value) => `${format(value / factor)} ${unit}`.trim();

/** A device as the part of an address behind the `#`, in the units of the page. */
export function toAddress(device) {
  const parts = QUANTITIES.map(({ key, factor }) => [key, String(Number((device[key] / factor).toPrecision(12)))]);
  return new URLSearchParams(parts).toString();
}

/** A device from an address, what it does not say from `device`; and what could not be taken. */
export function fromAddress(text, device) {
  const faults = [];
  const found = { ...device };
  const taken = new Set();
  for (const [key, number] of new URLSearchParams(text.replace(/^#/, ""))) {
    const quantity = QUANTITIES.find((one) => one.key === key);
    if (!quantity) {
      faults.push(`nothing is called ${key}; there is ${QUANTITIES.map((one) => one.key).join(", ")}`);
      continue;
    }
    const value = number.trim() === "" ? NaN : Number(number) * quantity.factor;
    const wrong = fault(quantity, value);
    if (wrong) {
      faults.push(wrong);
    } else {
      found[key] = value;
      taken.add(quantity);
    }
  }
  // What the model refuses of it is left out one by one, until it takes the rest.
  const refusal = (quantity) => fault(quantity, found[quantity.key], found);
  for (let bad = [...taken].find(refusal); bad; bad = [...taken].find(refusal)) {
    faults.push(refusal(bad));
    found[bad.key] = device[bad.key];
    taken.delete(bad);
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

// The scenes and materials of the Python package in SI units, as devices of the page.
import presets from "presets";
import { actuator } from "./core.js";
import { QUANTITIES } from "./device.js";

/** What no preset says: nothing pulls, and the alternating voltage waits at a frequency that shows something. */
const IDLE = { prestress: 0, driveVoltage: 0, driveFrequency: 1e5 };

/** What the page does not compute, by the variables of the SI FMU that ask for it. */
const LEFT_OUT = [
  [/^(J_m|kappa[23])$/, "stiffening"],
  [/^k[123]$/, "a permittivity that changes with the stretch"],
  [/^(mu|tau|J)_[123]$|^(eta|b)$/, "viscosity"],
  [/_breakdown(_number)?$/, "breakdown"],
  [/^(R_s|G_p|sigma|E_conduction)$/, "resistances and leaks"],
  [/^(m|k|l)_load$/, "masses and springs on the edges"],
  [/^n_(layers|surfaces)$/, "layers"],
  [/^lambda_(min|max)$/, `another end of the motion than at λ = ${actuator.get("lambda_min")} and ${actuator.get("lambda_max")}`],
];

/** Start values of the SI FMU as a device; what they do not say is as in the paper's silicone, which the FMU starts with. */
function deviceOf(values) {
  const said = { ...presets.paper_silicone.start_values, ...values };
  const device = { ...IDLE };
  for (const { key, variable } of QUANTITIES) if (said[variable] !== undefined) device[key] = said[variable];
  return device;
}

function noteOf({ description, source, not_verified: unsure, start_values: values }) {
  const asked = Object.keys(values).filter((name) => values[name] !== 0 && !QUANTITIES.some(({ variable }) => variable === name));
  // What has no words is said by its name.
  const missing = new Set(asked.map((name) => LEFT_OUT.find(([pattern]) => pattern.test(name))?.[1] ?? name));
  return [
    description,
    source && `Source: ${source} Not verified: ${unsure}`,
    missing.size > 0 && `This page leaves out ${[...missing].join(", ").replace(/, ([^,]*)$/, " and $1")}.`,
  ].filter(Boolean).join(" ");
}

/** The presets by group: name, title, device and note of each. A material is one that has a source. */
export const GROUPS = Object.entries({ Scenes: false, Materials: true }).map(([group, material]) => [
  group,
  Object.entries(presets)
    .filter(([, preset]) => Boolean(preset.source) === material)
    .map(([name, preset]) => ({ name, title: preset.title, device: deviceOf(preset.start_values), note: noteOf(preset) })),
]);

export const PRESETS = GROUPS.flatMap(([, entries]) => entries);

/** What an address that says nothing leads to. */
export const BASE = deviceOf({});

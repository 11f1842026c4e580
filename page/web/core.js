// The actuator, in WebAssembly: variables by name, as a host of the FMU has them. Nondimensional.
import binary from "core.wasm";

const { instance } = await WebAssembly.instantiate(binary).catch((error) => {
  document.getElementById("status").textContent =
    "The actuator does not run in this browser. It needs WebAssembly with vectors, which browsers have had since 2023.";
  throw error;
});
const exported = instance.exports;

function message() {
  const start = exported.actuator_message();
  const bytes = new Uint8Array(exported.memory.buffer, start, exported.actuator_message_length());
  return new TextDecoder().decode(bytes);
}

exported.actuator_variables();
const references = new Map(message().split("\n").map((name, reference) => [name, reference]));

function reference(name) {
  if (!references.has(name)) throw new Error(`the model has no variable ${name}`);
  return references.get(name);
}

function settled(wentThrough) {
  if (!wentThrough) throw new Error(message());
}

function setEach(values) {
  for (const [name, value] of Object.entries(values)) settled(exported.actuator_set(reference(name), value));
}

/** The actuator. A call that it refuses throws an error with its message. */
export const actuator = {
  /** A new motion from these values of variables; the present one goes on where that is refused. */
  start(values, tolerance) {
    exported.actuator_reset();
    try {
      setEach(values);
      settled(exported.actuator_begin(tolerance));
    } catch (error) {
      exported.actuator_restore();
      throw error;
    }
  },
  /** Sets variables, the first of them before the next is looked at. */
  set: setEach,
  get: (name) => exported.actuator_get(reference(name)),
  step: (length) => settled(exported.actuator_step(length)),
  time: () => exported.actuator_time(),
  /** Smallest and largest value of a variable. */
  limits: (name) => [exported.actuator_least(reference(name)), exported.actuator_most(reference(name))],
  /** A device in SI units as the model has it: its units in SI units, the period of its free motion, its parameters. */
  fold(device) {
    const place = exported.actuator_fold(
      device.modulus, device.density, device.relativePermittivity, device.thickness, device.side,
      device.surfaceEnergy, device.surfaceTension, device.surfaceElasticity,
    );
    const [time, voltage, stress, period, c, gamma_s, tau_s, E_s] = new Float64Array(exported.memory.buffer, place, 8);
    return { scales: { time, voltage, stress }, period, parameters: { c, gamma_s, tau_s, E_s } };
  },
  /** φ² that turns the motion from rest at a stretch, and that holds the actuator there. */
  stagnation: exported.actuator_stagnation,
  equilibrium: exported.actuator_equilibrium,
  /** The Hamiltonian at rest at a stretch under the present load, and the rate of a motion of one. */
  potential: exported.actuator_potential,
  rateOfPassage: exported.actuator_rate_of_passage,
  /** The angular frequency of small oscillations about the equilibrium; NaN where there is none. */
  frequency: exported.actuator_frequency,
};

// The actuator, in WebAssembly: variables by name, as a host of the FMU has them. Nondimensional.
import binary from "core.wasm";

/** Starts the actuator; throws an error with its message where it refuses a call. */
export async function load() {
  const { instance } = await WebAssembly.instantiate(binary);
  const exported = instance.exports;
  const message = () => {
    const start = exported.actuator_message();
    const bytes = new Uint8Array(exported.memory.buffer, start, exported.actuator_message_length());
    return new TextDecoder().decode(bytes);
  };
  exported.actuator_variables();
  const references = new Map(message().split("\n").map((name, reference) => [name, reference]));
  const reference = (name) => {
    if (!references.has(name)) throw new Error(`the model has no variable ${name}`);
    return references.get(name);
  };
  const settled = (wentThrough) => {
    if (!wentThrough) throw new Error(message());
  };
  const set = (values) => {
    for (const [name, value] of Object.entries(values)) settled(exported.actuator_set(reference(name), value));
  };
  return {
    /** A new motion from these values of variables. */
    start(values, tolerance) {
      exported.actuator_reset();
      set(values);
      settled(exported.actuator_begin(tolerance));
    },
    set,
    get: (name) => exported.actuator_get(reference(name)),
    step: (length) => settled(exported.actuator_step(length)),
    time: () => exported.actuator_time(),
    /** φ² that turns the motion from rest at a stretch, and that holds the actuator there. */
    stagnation: exported.actuator_stagnation,
    equilibrium: exported.actuator_equilibrium,
    /** The Hamiltonian at rest at a stretch under the present load, and the rate of a motion of one. */
    potential: exported.actuator_potential,
    rateOfPassage: exported.actuator_rate_of_passage,
  };
}

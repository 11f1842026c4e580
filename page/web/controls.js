// A slider and a box for the number, for each quantity of the device.
import { QUANTITIES, fault, format, range } from "./device.js";

const STEPS = 1000;

/** Builds the controls; `changed(key, value)` is called with SI values. Returns how to show a device. */
export function build(form, changed) {
  const rows = new Map();
  const groups = new Map();
  for (const quantity of QUANTITIES) {
    if (!groups.has(quantity.group)) {
      const set = element("fieldset");
      set.append(element("legend", { textContent: quantity.group }));
      form.append(set);
      groups.set(quantity.group, set);
    }
    const row = build_row(quantity, changed);
    groups.get(quantity.group).append(row.whole);
    rows.set(quantity.key, row);
  }
  form.addEventListener("submit", (event) => event.preventDefault());
  return (device) => rows.forEach((row, key) => row.show(device[key], device));
}

function element(name, properties = {}) {
  return Object.assign(document.createElement(name), properties);
}

function build_row(quantity, changed) {
  const { key, factor, unit, logarithmic } = quantity;
  const name = quantity.short ?? quantity.label;
  const box = element("input", { type: "number", id: key, step: "any", title: quantity.label });
  const slider = element("input", { type: "range", min: 0, max: STEPS, step: 1, id: `${key}-slider` });
  slider.setAttribute("aria-label", quantity.label);
  const complaint = element("span", { className: "fault", id: `${key}-fault` });
  complaint.setAttribute("role", "alert");
  box.setAttribute("aria-describedby", complaint.id);
  const whole = element("div", { className: "quantity" });
  const label = element("label", { htmlFor: key, textContent: name });
  whole.append(label, box, element("span", { className: "unit", textContent: unit }), slider, complaint);

  let [low, high] = [0, 1];
  let device;
  const fromSlider = (part) => (logarithmic ? low * (high / low) ** part : low + (high - low) * part);
  const toSlider = (value) => (logarithmic ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low));
  const take = (value) => {
    const wrong = fault(quantity, value, device);
    complaint.textContent = wrong ?? "";
    box.setAttribute("aria-invalid", wrong ? "true" : "false");
    if (!wrong) changed(key, value);
  };
  slider.addEventListener("input", () => {
    // With these digits a value leads back to its place on the slider.
    const value = Number((fromSlider(slider.value / STEPS) / factor).toPrecision(5));
    box.value = value;
    take(value * factor);
  });
  box.addEventListener("change", () => take(box.value === "" ? NaN : Number(box.value) * factor));
  return {
    whole,
    show(value, present) {
      device = present;
      [low, high] = range(quantity, device);
      slider.value = Math.round(Math.min(1, Math.max(0, toSlider(value))) * STEPS);
      slider.setAttribute("aria-valuetext", `${format(value / factor)} ${unit}`.trim());
      const shown = String(Number((value / factor).toPrecision(12)));
      if (box.value !== shown) box.value = shown;
      complaint.textContent = "";
      box.setAttribute("aria-invalid", "false");
    },
  };
}

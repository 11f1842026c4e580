// The page: what is set, the motion under it, and how both are shown.
import { actuator } from "./core.js";
import { build as buildControls } from "./controls.js";
import { grid, orbit, stretchWindow } from "./curves.js";
import { LOAD, format, fromAddress, toAddress, withPrefix } from "./device.js";
import { draw } from "./membrane.js";
import { Motion } from "./motion.js";
import { plot } from "./plots.js";
import { BASE, GROUPS, PRESETS } from "./presets.js";

/** Periods of the free motion a second at the middle of the slider. */
const PERIODS_A_SECOND = 0.4;

const part = (name) => document.getElementById(name);
const still = matchMedia("(prefers-reduced-motion: reduce)");
const presetNamed = (wanted) => PRESETS.find(({ name }) => name === wanted);

let { device } = presetNamed("silicone_swing");
let motion;
let playing = !still.matches;
let last;
let writing;

// ---- What is set ----

const select = part("preset");
for (const [group, entries] of GROUPS) {
  const section = Object.assign(document.createElement("optgroup"), { label: group });
  for (const { name, title } of entries) section.append(new Option(title, name));
  select.append(section);
}
select.append(new Option("Your own", "own"));
select.addEventListener("change", () => {
  const preset = presetNamed(select.value);
  if (preset) take(preset.device, true);
});

const showControls = buildControls(part("quantities"), (key, value) => {
  take({ ...device, [key]: value }, !LOAD.has(key));
});

/** Takes a device. Where the model refuses it, that is said and returned, and nothing changes. */
function take(wanted, anew) {
  let refusal = "";
  try {
    if (motion && !anew) motion.reload(wanted);
    else if (motion) motion.restart(wanted);
    else motion = new Motion(actuator, wanted);
    device = wanted;
  } catch (error) {
    refusal = error.message;
    motion ??= new Motion(actuator, device);
  }
  say(refusal);
  showControls(device);
  const address = toAddress(device);
  const found = PRESETS.find((preset) => toAddress(preset.device) === address);
  select.value = found?.name ?? "own";
  part("note").textContent = found?.note ?? "";
  show();
  clearTimeout(writing);
  writing = setTimeout(writeAddress, 300);
  return refusal;
}

/** The address that holds what is set. */
const link = () => new URL(`#${toAddress(device)}`, location.href).href;

/** Some time after the last change: browsers refuse more than about 100 addresses in 30 seconds. */
function writeAddress() {
  try {
    history.replaceState(null, "", link());
  } catch {
    // The next change writes it again.
  }
}

function say(text) {
  part("status").textContent = text;
}

// ---- The motion ----

part("play").addEventListener("click", () => setPlaying(!playing));
part("restart").addEventListener("click", () => {
  motion.restart(device);
  say("Restarted from rest.");
  show();
});
part("advance").addEventListener("click", () => {
  setPlaying(false);
  if (!advance(motion.single)) return;
  const reading = (name) => document.querySelector(`[data-reading=${name}]`).textContent;
  say(`Stretch ${reading("stretch")} at ${reading("time")}.`);
});
part("share").addEventListener("click", async () => {
  try {
    await navigator.clipboard.writeText(link());
    say("The link is copied; it holds all that is set.");
  } catch {
    writeAddress();
    say("Copy the address of this page: it holds all that is set.");
  }
});

function setPlaying(wanted) {
  playing = wanted;
  last = undefined;
  part("play").textContent = playing ? "Pause" : "Play";
}

/** Whether the motion could be followed for this time; why not, is said. */
function advance(time) {
  let went = true;
  try {
    motion.advance(time);
  } catch (error) {
    went = false;
    setPlaying(false);
    say(error.message);
  }
  show();
  return went;
}

/** Periods of the free motion a second. */
const pace = () => PERIODS_A_SECOND * 10 ** Number(part("pace").value);

function sayPace() {
  part("pace").setAttribute("aria-valuetext", `${format(pace(), 2)} periods of the free motion a second`);
}
part("pace").addEventListener("input", sayPace);

function frame(now) {
  if (playing) {
    const seconds = Math.min((now - (last ?? now)) / 1000, 0.1);
    last = now;
    if (seconds > 0) advance(seconds * pace() * motion.period);
  }
  requestAnimationFrame(frame);
}

// ---- What is shown ----

const plots = {
  history: plot(part("history"), { x: "time", y: "stretch λ", lines: [{ colour: "electrode" }, { colour: "ink", dot: 4 }] }),
  well: plot(part("well"), {
    x: "stretch λ", y: "energy", hideNumbers: true,
    lines: [{ colour: "electrode" }, { colour: "membrane" }, { colour: "ink", dot: 6 }],
  }),
  phase: plot(part("phase"), {
    x: "stretch λ", y: "rate",
    lines: [{ colour: "faint", dash: [5, 4], width: 1.5 }, { colour: "membrane", width: 1.5 }, { colour: "electrode" }, { colour: "ink", dot: 6 }],
  }),
  curve: plot(part("curve"), {
    x: "stretch λ", y: "voltage, V",
    lines: [
      { colour: "electrode" }, { colour: "faint", width: 1 }, { colour: "alarm", dash: [6, 4] },
      { colour: "faint", dash: [2, 3], width: 1 }, { colour: "membrane" }, { colour: "alarm", dot: 5 }, { colour: "ink", dot: 5 },
    ],
  }),
};

function show() {
  const { get } = actuator;
  const now = {
    stretch: get("lambda"), rate: get("lambda_dot"), time: actuator.time(),
    voltage: get("phi_total") * motion.scales.voltage,
  };
  showReadings(now);
  showSign(now);
  const limit = motion.threshold.dynamic;
  draw(part("membrane"), {
    device, stretch: now.stretch, lowest: get("lambda_lowest"), highest: get("lambda_highest"), snapped: Boolean(motion.snapped),
    charge: Math.abs(get("phi_total")) / (Number.isFinite(limit) && limit > 0 ? limit : 0.7), positive: now.voltage >= 0,
  });
  part("membrane").setAttribute("aria-label", `The membrane, ${format(100 * (now.stretch - 1), 3)} % wider than at rest, ${format(100 / now.stretch ** 2, 3)} % of its thickness.`);
  showPlots(now);
}

function showReadings(now) {
  const { voltage, time } = motion.scales;
  const readings = {
    stretch: ["Stretch λ", format(now.stretch, 6), now.stretch],
    thickness: ["Thickness", withPrefix(device.thickness / now.stretch ** 2, "m"), device.thickness / now.stretch ** 2],
    side: ["Side", withPrefix(device.side * now.stretch, "m"), device.side * now.stretch],
    voltage: ["Voltage", withPrefix(now.voltage, "V"), now.voltage],
    field: ["Field", `${format(((now.voltage * now.stretch ** 2) / device.thickness) * 1e-6)} V/µm`, (now.voltage * now.stretch ** 2) / device.thickness],
    pullIn: ["Pull-in, from rest", withPrefix(motion.threshold.dynamic * voltage, "V"), motion.threshold.dynamic * voltage],
    slowPullIn: ["Pull-in, raised slowly", withPrefix(motion.threshold.static * voltage, "V"), motion.threshold.static * voltage],
    frequency: ["Own frequency", withPrefix(motion.frequency, "Hz"), motion.frequency],
    time: ["Time", withPrefix(now.time * time, "s"), now.time * time],
  };
  const list = part("readings");
  for (const [name, [label, text, value]] of Object.entries(readings)) {
    let row = list.querySelector(`[data-reading=${name}]`);
    if (!row) {
      const pair = document.createElement("div");
      row = Object.assign(document.createElement("dd"));
      row.dataset.reading = name;
      pair.append(document.createElement("dt"), row);
      list.append(pair);
    }
    row.previousElementSibling.textContent = label;
    row.textContent = text;
    row.dataset.value = value;
  }
}

function showSign(now) {
  const sign = part("sign");
  const [kind, text] = judgement(now);
  if (sign.className === kind && sign.textContent === text) return;
  // Only a snap interrupts who listens.
  sign.setAttribute("role", kind === "snapped" ? "alert" : "status");
  sign.className = kind;
  sign.textContent = text;
}

function judgement(now) {
  const { voltage, time } = motion.scales;
  const { snapped, threshold } = motion;
  if (snapped) {
    const when = withPrefix(snapped.time * time, "s", 3);
    if (snapped.kind === "lost") return ["snapped", `Snap! Pulled in after ${when}: the membrane is ${format(actuator.get("lambda_max"))} times as wide as at rest, where the motion ends. Restart from rest to try again.`];
    if (snapped.kind === "collapsed") return ["snapped", `Collapsed after ${when}: the membrane has contracted to a needle.`];
    return ["snapped", `Snap! After ${when} the membrane has gone over the top of its barrier.`];
  }
  if (device.driveVoltage > 0) {
    const force = withPrefix(2 * device.driveFrequency, "Hz");
    return ["near", `Alternating voltage: its force alternates at ${force}. The pull-in voltages below hold for a constant voltage.`];
  }
  const most = threshold.dynamic * voltage;
  if (!Number.isFinite(most)) return ["near", "No pull-in from rest at any voltage."];
  const left = most - Math.abs(now.voltage);
  if (left < 0) return ["beyond", `${withPrefix(-left, "V", 3)} beyond pull-in from rest.`];
  return ["near", `${withPrefix(left, "V", 3)} to go until pull-in from rest.`];
}

function showPlots(now) {
  const { get } = actuator;
  const { voltage, time } = motion.scales;
  const window = stretchWindow(motion);
  const stretches = grid(window);
  const hamiltonian = get("hamiltonian");

  const times = motion.past.map((point) => point.time * time);
  const unit = withPrefix((now.time || motion.period) * time, "s").split(" ").at(-1);
  const perUnit = { ps: 1e12, ns: 1e9, µs: 1e6, ms: 1e3, s: 1 }[unit] ?? 1;
  plots.history.label(0, `time, ${unit}`);
  const end = Math.max(now.time, 3 * motion.period) * time * perUnit;
  const low = Math.min(get("lambda_lowest"), 0.98);
  const high = Math.max(Math.min(get("lambda_highest"), window[1]), 1.02);
  const pad = 0.06 * (high - low);
  plots.history.show({ x: [Math.max(0, end - 6 * motion.period * time * perUnit), end], y: [low - pad, high + pad] }, [
    { x: times.map((one) => one * perUnit), y: motion.past.map((point) => point.stretch) },
    { x: [now.time * time * perUnit], y: [now.stretch] },
  ]);

  const energies = stretches.map(actuator.potential);
  const inside = energies.filter((_, k) => stretches[k] > 0.9);
  const [lowest, highest] = [Math.min(...inside, hamiltonian), Math.max(...inside, hamiltonian)];
  const spread = Math.max(highest - lowest, 1e-9);
  plots.well.show({ x: window, y: [lowest - 0.08 * spread, highest + 0.08 * spread] }, [
    { x: stretches, y: energies },
    { x: window, y: [hamiltonian, hamiltonian] },
    { x: [now.stretch], y: [hamiltonian] },
  ]);

  const path = orbit(actuator, now.stretch, hamiltonian, window);
  const barrier = motion.barrier();
  const edge = barrier < window[1] ? orbit(actuator, Math.min(1.0001, barrier), actuator.potential(barrier) - 1e-9, [window[0], barrier]) : [];
  const recent = motion.past.slice(-400);
  // The unit of the rate is that of the time in the plot above it.
  const perTime = 1 / (time * perUnit);
  const seen = [...path, ...edge, ...recent].filter(({ stretch }) => stretch >= window[0] && stretch <= window[1]);
  const rates = seen.map((point) => Math.abs(point.rate) * perTime).filter(Number.isFinite);
  const fastest = 1.1 * Math.max(...rates, 1e-6 * perTime);
  const curve = (points) => ({ x: points.map((point) => point.stretch), y: points.map((point) => point.rate * perTime) });
  plots.phase.label(1, `rate, 1/${unit}`);
  plots.phase.show({ x: window, y: [-fastest, fastest] }, [curve(edge), curve(recent), curve(path), curve([now])]);

  const expanding = stretches.filter((stretch) => stretch >= 1);
  const turning = expanding.map((stretch) => voltage * Math.sqrt(actuator.stagnation(stretch)));
  const holding = expanding.map((stretch) => voltage * Math.sqrt(actuator.equilibrium(stretch)));
  const { dynamic, static: slow } = motion.threshold;
  const level = (value, text, below) =>
    Number.isFinite(value)
      ? { x: window, y: [value * voltage, value * voltage], note: { text: `${text} ${withPrefix(value * voltage, "V", 4)}`, x: window[1], y: value * voltage, below } }
      : { x: [], y: [] };
  const largest = Math.max(...[dynamic, slow].filter(Number.isFinite).map((value) => value * voltage), Math.abs(now.voltage), device.driveVoltage, Number.isFinite(slow) ? 0 : 1.2 * voltage);
  plots.curve.show({ x: window, y: [0, 1.2 * largest] }, [
    { x: expanding, y: turning },
    { x: expanding, y: holding },
    level(dynamic, "pull-in", true),
    Math.abs(slow - dynamic) > 0.03 ? level(slow, "raised slowly") : { x: [], y: [] },
    { x: window, y: [Math.abs(now.voltage), Math.abs(now.voltage)] },
    Number.isFinite(motion.fold.dynamic) ? { x: [motion.fold.dynamic], y: [dynamic * voltage] } : { x: [], y: [] },
    { x: [now.stretch], y: [Math.abs(now.voltage)] },
  ]);
}

// ---- Begin ----

function fromHash() {
  const { device: wanted, faults } = fromAddress(location.hash, BASE);
  const refusal = take(location.hash.length > 1 ? wanted : device, true);
  if (refusal) faults.push(refusal);
  if (faults.length > 0) say(`The address could not be followed in all: ${faults.join(". ")}.`);
}

setPlaying(playing);
sayPace();
fromHash();
addEventListener("hashchange", fromHash);
addEventListener("resize", () => show());
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => show());
requestAnimationFrame(frame);
document.documentElement.dataset.ready = "true";

// The curves behind the plots, in the units of the model.

const SAMPLES = 240;

/** Evenly spaced stretches over a window. */
export function grid([lowest, highest]) {
  return Array.from({ length: SAMPLES + 1 }, (_, k) => lowest + ((highest - lowest) * k) / SAMPLES);
}

/** The window of stretch that shows the motion and the place of pull-in. */
export function stretchWindow(motion) {
  const { get } = motion.actuator;
  const fold = Number.isFinite(motion.fold.dynamic) ? motion.fold.dynamic : motion.fold.static;
  const usual = Number.isFinite(fold) ? Math.min(fold * 1.3, 3) : 1.6;
  const [lowest, seen] = [get("lambda_lowest"), get("lambda_highest")];
  // A motion that never comes back is let go, so that the well stays in sight.
  const widest = get("E_s") > 0 ? 6 : 2.5;
  const highest = seen > usual ? [1.6, 2, 2.5, 3, 4, 5, 6].find((one) => one > seen * 1.03) ?? widest : usual;
  return [Math.min(0.85, lowest - 0.03), Math.min(highest, Math.max(widest, usual))];
}

/** The motion of an energy through a stretch, there and back, with a gap where it leaves the window. */
export function orbit(actuator, stretch, hamiltonian, window) {
  const points = [];
  for (const end of window) {
    const side = [];
    let inside = stretch;
    for (let k = 1; k <= SAMPLES; k += 1) {
      const next = stretch + ((end - stretch) * k) / SAMPLES;
      const rate = actuator.rateOfPassage(next, hamiltonian);
      if (Number.isNaN(rate)) {
        side.push({ stretch: turning(actuator, inside, next, hamiltonian), rate: 0 });
        break;
      }
      side.push({ stretch: next, rate });
      inside = next;
    }
    points.push(side);
  }
  const here = actuator.rateOfPassage(stretch, hamiltonian);
  const there = [...points[0].reverse(), { stretch, rate: Number.isNaN(here) ? 0 : here }, ...points[1]];
  const back = there.map((point) => ({ ...point, rate: -point.rate })).reverse();
  const gap = there.at(-1).rate > 0 ? [{ stretch: NaN, rate: NaN }] : [];
  return [...there, ...gap, ...back];
}

function turning(actuator, inside, outside, hamiltonian) {
  let [from, to] = [inside, outside];
  for (let k = 0; k < 40; k += 1) {
    const middle = (from + to) / 2;
    if (Number.isNaN(actuator.rateOfPassage(middle, hamiltonian))) to = middle;
    else from = middle;
  }
  return from;
}

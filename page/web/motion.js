// The motion of a device: the actuator stepped at the pace of the page, its past, and whether it has snapped.
import { load } from "./device.js";

export const TOLERANCE = 1e-10;

/** How many points a period of the free motion is drawn with, and how many periods are kept. */
const POINTS = 96;
const PERIODS_KEPT = 6;

export class Motion {
  constructor(actuator, device) {
    this.actuator = actuator;
    this.restart(device);
  }

  /** Begins anew at rest, undeformed. */
  restart(device) {
    const { scales, period, parameters } = this.actuator.fold(device);
    this.actuator.start({ ...parameters, ...load(device), record_extremes: 1 }, TOLERANCE);
    this.device = device;
    this.scales = scales;
    this.period = period;
    this.past = [];
    this.keep();
    this.settle();
  }

  /** Goes on under another load: one of its four numbers is another. */
  reload(device) {
    this.actuator.set(load(device));
    this.device = device;
    this.settle();
  }

  /** Works out what hangs on the load, and takes the sign of a snap back. */
  settle() {
    const { get } = this.actuator;
    this.snapped = null;
    // Not phi_pull_in: the margin counts the voltage too above which nothing bounds the stretch.
    this.threshold = { dynamic: get("pull_in_margin") + Math.abs(get("phi_total")), static: get("phi_pull_in_static") };
    this.frequency = this.actuator.frequency() / (2 * Math.PI * this.scales.time);
    const stretch = (thickness) => (thickness > 0 ? 1 / Math.sqrt(thickness) : Infinity);
    this.fold = { dynamic: stretch(get("lambda3_pull_in")), static: stretch(get("lambda3_pull_in_static")) };
    this.judge();
  }

  get stretch() {
    return this.actuator.get("lambda");
  }

  /** The length of the button's step. */
  get single() {
    return this.period / 40;
  }

  /** Follows the motion for a time, in steps that draw a smooth curve. */
  advance(time) {
    const angular = this.actuator.get("omega_ac");
    const longest = Math.min(this.period / POINTS, angular > 0 ? (2 * Math.PI) / angular / 24 : Infinity);
    const count = Math.min(Math.max(1, Math.ceil(time / longest)), 2000);
    for (let k = 0; k < count; k += 1) {
      this.actuator.step(time / count);
      this.keep();
      this.judge();
    }
  }

  keep() {
    const { get, time } = this.actuator;
    this.past.push({ time: time(), stretch: get("lambda"), rate: get("lambda_dot") });
    const first = time() - PERIODS_KEPT * this.period;
    while (this.past.length > 2 && this.past[1].time < first) this.past.shift();
  }

  /** The stretch beyond which the load pulls the actuator away: the top of its barrier, or the fold that is gone. */
  barrier() {
    const { potential, get } = this.actuator;
    const from = Math.min(this.fold.dynamic, this.fold.static);
    if (!Number.isFinite(from)) return Infinity;
    // Beyond the fold of the equilibria the curve falls everywhere near it; before it the top lies further out.
    let best = this.fold.static;
    // Where no voltage pulls it in from rest, the motion passes the place of the fold without a snap.
    const gone = Number.isFinite(this.threshold.dynamic) ? best : Infinity;
    if (Math.abs(get("phi_total")) >= this.threshold.static) return gone;
    let before = potential(best);
    for (let stretch = best * 1.01; stretch < 8; stretch *= 1.01) {
      const now = potential(stretch);
      if (now < before) return best;
      [best, before] = [stretch, now];
    }
    return Infinity;
  }

  judge() {
    const { get, time } = this.actuator;
    if (get("pulled_in") > 0) {
      const expanding = this.stretch > 1;
      this.snapped = { time: get("pull_in_time"), kind: expanding ? "lost" : "collapsed" };
    } else if (!this.snapped && this.stretch > 1 && this.stretch > this.barrier()) {
      this.snapped = { time: time(), kind: "through" };
    }
  }
}

// The membrane from above and from the side, to scale.
import { withPrefix } from "./device.js";

/** Where a side view thinner than this many pixels would be hard to see, its thickness is magnified. */
const THINNEST = 14;

/** The smallest of 1, 2, 5, 10, ... that is not below a number. */
export function roundUp(number) {
  const power = 10 ** Math.floor(Math.log10(number));
  const factor = [1, 2, 5, 10].find((one) => one * power >= number * (1 - 1e-9));
  return factor * power;
}

/** The widest and the thickest membrane over that at rest that the view makes room for, so that it does not zoom at each frame. */
const widest = (highest) => [1.5, 2, 2.5, 3, 4, 6, 10].find((one) => one >= highest) ?? 10;
const thickest = (lowest) => [1.25, 2, 4, 10, 40].find((one) => one >= 1 / lowest ** 2) ?? 400;

/**
 * Draws the membrane. `voltage` is the present one over the pull-in voltage or the scale, and sets how
 * densely the charges lie.
 */
export function draw(canvas, { device, stretch, lowest, highest, charge, positive, snapped }) {
  const ratio = window.devicePixelRatio || 1;
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio);
    canvas.height = Math.round(height * ratio);
  }
  const pen = canvas.getContext("2d");
  const style = getComputedStyle(document.documentElement);
  const colour = (name) => style.getPropertyValue(`--${name}`).trim();
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, height);
  pen.font = `12px ${getComputedStyle(document.body).fontFamily}`;
  const paint = { pen, colour, stretch, snapped };
  const wide = widest(highest);
  // The view from above takes a square at the left, the side view the rest.
  const above = Math.min(height - 34, width * 0.4);
  const perMetre = above / (device.side * wide);
  drawAbove(paint, above / 2 + 4, height / 2, device.side * perMetre);
  const left = above + 24;
  const room = width - left - 8;
  const tallest = (height - 70) / thickest(lowest);
  const scale = Math.min(room / (device.side * wide), tallest / device.thickness);
  const thickness = device.thickness * scale;
  const magnified = thickness < THINNEST ? Math.min(roundUp(THINNEST / thickness), tallest / thickness) : 1;
  drawSide(paint, left + room / 2, height / 2 - 6, device.side * scale, thickness * magnified, charge, positive);
  pen.fillStyle = colour("faint");
  pen.textAlign = "center";
  pen.fillText("from above", above / 2 + 4, height - 4);
  const remark = magnified > 1.0001 ? `from the side, thickness ×${Number(magnified.toPrecision(3))}` : "from the side, to scale";
  pen.fillText(remark, left + room / 2, height - 4);
  drawScale(paint, left + room, 14, device.side, scale);
}

function drawAbove({ pen, colour, stretch, snapped }, x, y, side) {
  const now = side * stretch;
  pen.globalAlpha = snapped ? 1 : 0.85;
  pen.fillStyle = colour(snapped ? "alarm" : "electrode");
  pen.fillRect(x - now / 2, y - now / 2, now, now);
  pen.globalAlpha = 1;
  outline(pen, colour, x - side / 2, y - side / 2, side, side);
}

function drawSide({ pen, colour, stretch, snapped }, x, y, side, thickness, charge, positive) {
  const [wide, thin] = [side * stretch, Math.max(thickness / stretch ** 2, 0.75)];
  const electrode = 4;
  pen.fillStyle = colour("membrane");
  pen.fillRect(x - wide / 2, y - thin / 2, wide, thin);
  pen.fillStyle = colour(snapped ? "alarm" : "electrode");
  pen.fillRect(x - wide / 2, y - thin / 2 - electrode, wide, electrode);
  pen.fillRect(x - wide / 2, y + thin / 2, wide, electrode);
  outline(pen, colour, x - side / 2, y - thickness / 2 - electrode, side, thickness + 2 * electrode);
  // Charges: as many as the voltage says, moving apart with the electrodes.
  const count = Math.round(Math.min(charge, 2) * 10);
  pen.fillStyle = colour("ink");
  pen.textAlign = "center";
  for (let k = 0; k < count; k += 1) {
    const place = x + wide * ((k + 0.5) / count - 0.5);
    pen.fillText(positive ? "+" : "−", place, y - thin / 2 - electrode - 4);
    pen.fillText(positive ? "−" : "+", place, y + thin / 2 + electrode + 12);
  }
}

function outline(pen, colour, left, top, width, height) {
  pen.setLineDash([5, 4]);
  pen.strokeStyle = colour("faint");
  pen.lineWidth = 1;
  pen.strokeRect(left, top, width, height);
  pen.setLineDash([]);
}

function drawScale({ pen, colour }, right, y, side, scale) {
  const length = roundUp(side / 5);
  pen.strokeStyle = colour("faint");
  pen.fillStyle = colour("faint");
  pen.lineWidth = 2;
  pen.beginPath();
  pen.moveTo(right - length * scale, y);
  pen.lineTo(right, y);
  pen.stroke();
  pen.textAlign = "right";
  pen.fillText(withPrefix(length, "m"), right - length * scale - 6, y + 4);
}

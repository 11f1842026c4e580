// Plots of curves that may run back and forth, by uPlot.
import uPlot from "uplot";

const HEIGHT = 230;

const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

/** Draws one curve of a plot: a line with gaps at NaN, or a dot where it is one point; and its note. */
function curve(plot, index) {
  const [xs, ys, note] = plot.data[index];
  const { scale, line } = plot.series[index];
  const at = (k) => [plot.valToPos(xs[k], "x", true), plot.valToPos(ys[k], scale, true)];
  const pen = plot.ctx;
  const ratio = uPlot.pxRatio;
  const { left, top, width, height } = plot.bbox;
  pen.save();
  pen.beginPath();
  pen.rect(left, top, width, height);
  pen.clip();
  pen.strokeStyle = colour(line.colour);
  pen.fillStyle = colour(line.colour);
  pen.lineWidth = (line.width ?? 2) * ratio;
  pen.lineJoin = "round";
  pen.setLineDash((line.dash ?? []).map((length) => length * ratio));
  pen.beginPath();
  if (line.dot && xs.length > 0) {
    pen.arc(...at(0), line.dot * ratio, 0, 2 * Math.PI);
    pen.fill();
  } else {
    let drawing = false;
    for (let k = 0; k < xs.length; k += 1) {
      const shown = Number.isFinite(xs[k]) && Number.isFinite(ys[k]);
      if (shown) (drawing ? pen.lineTo : pen.moveTo).apply(pen, at(k));
      drawing = shown;
    }
    pen.stroke();
  }
  if (note) {
    pen.font = `${12 * ratio}px system-ui, sans-serif`;
    pen.textAlign = "right";
    pen.fillText(note.text, plot.valToPos(note.x, "x", true) - 5 * ratio, plot.valToPos(note.y, scale, true) + (note.below ? 15 : -5) * ratio);
  }
  pen.restore();
  return null;
}

/** A plot in a figure: `lines` say how each curve looks; `show` gives the curves and the ranges. */
export function plot(figure, { x, y, lines, hideNumbers }) {
  const limits = { x: [0, 1], y: [0, 1] };
  const axis = (label) => ({
    label,
    labelSize: 18,
    labelFont: "12px system-ui, sans-serif",
    font: "12px system-ui, sans-serif",
    stroke: () => colour("faint"),
    grid: { stroke: () => colour("grid"), width: 1 },
    ticks: { stroke: () => colour("grid"), width: 1 },
  });
  const holder = document.createElement("div");
  holder.setAttribute("aria-hidden", "true");
  figure.prepend(holder);
  const made = new uPlot(
    {
      mode: 2,
      width: Math.max(holder.clientWidth, 100),
      height: HEIGHT,
      legend: { show: false },
      cursor: { show: false },
      padding: [8, 12, 0, 0],
      scales: {
        x: { time: false, range: () => limits.x },
        y: { range: () => limits.y },
      },
      axes: [
        { ...axis(x), size: 34 },
        { ...axis(y), size: 52, ...(hideNumbers ? { values: () => [] } : {}) },
      ],
      series: [{}, ...lines.map((line) => ({ line, scale: "y", facets: [{ scale: "x", auto: true }, { scale: "y", auto: true }], paths: curve, points: { show: false } }))],
    },
    [null, ...lines.map(() => [[], []])],
    holder,
  );
  const fit = () => made.setSize({ width: Math.max(holder.clientWidth, 100), height: HEIGHT });
  new ResizeObserver(fit).observe(figure);
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => made.redraw());
  return {
    show(ranges, curves) {
      limits.x = ranges.x;
      limits.y = ranges.y;
      made.setData([null, ...curves.map(({ x: xs, y: ys, note }) => [xs, ys, note])]);
    },
    label(which, text) {
      made.axes[which].label = text;
    },
  };
}

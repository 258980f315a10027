// Disagreement on a logarithmic axis, with theory's line beside it, and speeds; both since the page was opened.
import {agentColours, styleColour} from "../colours.js";
import {byId, element, figure, setText, throttled} from "../dom.js";

const MOST_ROWS = 1200;
const LEAST_M = 1e-6;  // bottom of the logarithmic axis: curves end there
const MOST_LINES = 8;  // speeds of more agents are shown as fastest, mean, slowest and the selected one
const DRAW_EVERY_MS = 120;
const JUMP_S = 8;

/** Rows of time and values, thinned out by half whenever there are too many. */
class History {
  rows = [];
  #every = 1;
  #seen = 0;

  add(row) {
    if (this.rows.length && row[0] <= this.rows.at(-1)[0]) this.clear();
    if (this.#seen++ % this.#every) return;
    this.rows.push(row);
    if (this.rows.length < MOST_ROWS) return;
    this.rows = this.rows.filter((_, k) => k % 2 === 0);
    this.#every *= 2;
  }

  clear() {
    this.rows = [];
    this.#every = 1;
    this.#seen = 0;
  }
}

export class Charts {
  #model;
  #disagreement = new History();
  #speeds = new History();
  #charts = {};
  #anchor = null;  // where theory's line begins: {t_s, value_m, rate_per_s}
  #last_s = null;
  #draw = throttled(DRAW_EVERY_MS, () => this.#redraw());

  constructor(model) {
    this.#model = model;
    model.on("run", () => this.#restart());
    model.on("experiment", () => this.#onPrediction());
    model.on("frame", ({frame}) => this.#onFrame(frame));
    model.on("selected", () => this.#draw());
  }

  paint() {
    for (const chart of Object.values(this.#charts)) chart.destroy();
    this.#charts = {};
    if (this.#model.experiment) this.#redraw();
  }

  get rows() { return this.#disagreement.rows.length; }

  /** The newest point of the curves of disagreement: time, measured, theory; null: out of the chart. */
  get newest() { return this.#disagreement.rows.at(-1) ?? null; }

  // --- what is collected ---

  #restart() {
    this.#forget();
    this.#last_s = null;
    this.paint();
  }

  #forget() {
    this.#disagreement.clear();
    this.#speeds.clear();
    this.#anchor = null;
  }

  #onFrame({t_s, disagreement_m, speed_m_per_s}) {
    if (t_s === this.#last_s) return;
    if (t_s < this.#last_s) this.#anchor = null;
    if (this.#model.isRecording && t_s > this.#last_s + JUMP_S) this.#forget();  // somebody looked elsewhere
    this.#last_s = t_s;
    this.#disagreement.add([t_s, this.#level(disagreement_m), this.#theory(t_s, disagreement_m)]);
    this.#speeds.add([t_s, ...this.#speedsOf(speed_m_per_s)]);
    this.#draw();
  }

  #level(value_m) { return value_m === null || value_m < LEAST_M ? null : value_m; }

  #theory(t_s, value_m) {
    const {prediction} = this.#model.experiment;
    if (!prediction?.rate_per_s || value_m === null) return null;
    this.#anchor ??= {t_s, value_m, rate_per_s: prediction.rate_per_s};
    return this.#level(this.#anchor.value_m * Math.exp(-this.#anchor.rate_per_s * (t_s - this.#anchor.t_s)));
  }

  #speedsOf(speeds) {
    if (speeds.length <= MOST_LINES) return speeds;
    const mean = speeds.reduce((sum, v) => sum + v, 0) / speeds.length;
    return [
      Math.max(...speeds), mean, Math.min(...speeds), this.#model.selected ? speeds[this.#model.selected - 1] : null
    ];
  }

  // A rate that an event has changed is compared from then on.
  #onPrediction() {
    const prediction = this.#model.experiment.prediction ?? {}, {rate_per_s} = prediction;
    if (this.#anchor && this.#anchor.rate_per_s !== rate_per_s) this.#anchor = null;
    byId("prediction").classList.toggle("has-line", Boolean(rate_per_s));
    setText(byId("prediction"), wordsOf(prediction));
  }

  // --- what is drawn ---

  #redraw() {
    const {frame} = this.#model;
    if (!frame) return;
    setText(byId("disagreement-now"), frame.disagreement_m === null ? "" : `${figure(frame.disagreement_m)} m`);
    setText(byId("speed-now"), `up to ${figure(Math.max(...frame.speed_m_per_s))} m/s`);
    const {rows} = this.#disagreement;
    this.#show("disagreement", rows, {valueRange: decadesOf(rows)}, () => this.#disagreementLook());
    this.#show("speed", this.#speeds.rows, {}, () => this.#speedLook());
  }

  #show(id, rows, ranges, look) {
    if (rows.length < 2) return this.#say(id, "The curve begins here when time goes on.");
    if (rows.every(([, ...values]) => values.every((value) => value === null)))
      return this.#say(id, `Nothing above ${figure(LEAST_M)} m yet.`);
    if (this.#charts[id])
      this.#charts[id].updateOptions({file: rows, ...ranges});
    else
      this.#charts[id] = new Dygraph(byId(id), rows, {...this.#look(), ...look(), ...ranges});
  }

  // Where there is no curve, as on a page that is opened while the run is paused.
  #say(id, words) {
    this.#charts[id]?.destroy();
    delete this.#charts[id];
    byId(id).replaceChildren(element("p", {className: "muted hint", textContent: words}));
  }

  #look() {
    const number = (x) => figure(x, 2).replace(/\.?0+$/, "");
    return {
      axisLineColor: styleColour("border"),
      gridLineColor: styleColour("border"),
      gridLineWidth: 0.6,
      strokeWidth: 1.6,
      highlightCircleSize: 3,
      legend: "onmouseover",
      interactionModel: {},
      animatedZooms: false,
      legendFormatter: legend,
      xRangePad: 4,
      rightGap: 8,
      axes: {
        x: {
          axisLabelFormatter: (t) => `${number(t)} s`,
          pixelsPerLabel: 70,
          valueFormatter: (t) => `${figure(t, 2)} s`
        },
        y: {axisLabelWidth: 46, pixelsPerLabel: 26, axisLabelFormatter: number, valueFormatter: (x) => figure(x)}
      },
    };
  }

  #disagreementLook() {
    return {
      labels: ["t", "measured (m)", "theory (m)"],
      logscale: true,
      axes: {...this.#look().axes, y: {...this.#look().axes.y, ticker: powersOfTen}},
      colors: [styleColour("accent"), styleColour("muted")],
      series: {"measured (m)": {strokeWidth: 2}, "theory (m)": {strokePattern: [5, 4]}},
    };
  }

  #speedLook() {
    const {size} = this.#model, many = size > MOST_LINES;
    const names =
        many ? ["fastest", "mean", "slowest", "selected"] : Array.from({length: size}, (_, k) => `agent ${k + 1}`);
    const colors = many ? ["accent", "text", "muted", "velocity"].map(styleColour) : agentColours(size);
    return {labels: ["t", ...names], colors, includeZero: true};
  }
}

/**
 * A range for a logarithmic axis: what is measured, with some room, at least a factor of 5; and what is predicted, as
 * far as a decade below that.
 */
function decadesOf(rows) {
  let low = Infinity, least = Infinity, high = LEAST_M;
  for (const [, measured, theory] of rows) {
    low = Math.min(low, measured ?? Infinity);
    least = Math.min(least, measured ?? Infinity, theory ?? Infinity);
    high = Math.max(high, measured ?? 0, theory ?? 0);
  }
  low = Math.max(least, low / 10);
  return [Math.min(low / 1.2, high / 5), high * 1.2];
}

function powersOfTen(low, high) {
  const first = Math.floor(Math.log10(low)), last = Math.ceil(Math.log10(high)), decades = Math.log10(high / low);
  const between = decades < 0.7 ? [1, 2, 3, 4, 5, 6, 7, 8, 9] : decades < 2 ? [1, 2, 5] : [1];
  const every = Math.max(1, Math.ceil((last - first) / 5)), ticks = [];
  for (let k = first; k <= last; k += every)
    for (const m of between) ticks.push({v: m * 10 ** k, label: shortLabel(m, k)});
  return ticks.filter(({v}) => v >= low && v <= high);
}

/** m times ten to the k. */
function shortLabel(m, k) {
  if (k >= -3 && k <= 3) return String(Number((m * 10 ** k).toPrecision(2)));
  return `${m === 1 ? "" : `${m}·`}10${[...String(k)].map((c) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[c] ?? "⁻").join("")}`;
}

/** What theory says of the disagreement. */
function wordsOf({stable, rate_per_s, slowest_rate_per_s, settling_time_s, why}) {
  if (rate_per_s) {
    const settles = settling_time_s ? `, settled (2 %) after ${figure(settling_time_s, 2)} s` : "";
    return `Theory: decays at ${figure(rate_per_s)} 1/s${settles}`;
  }
  if (stable === false) return `Theory: does not agree${why ? `: ${why}` : ""}`;
  if (slowest_rate_per_s) return `Theory: in the long run decays at ${figure(slowest_rate_per_s)} 1/s or faster`;
  return why ? `No prediction: ${why}` : "";
}

/** The values under the pointer. */
function legend({x, xHTML, series}) {
  const box = element("span");
  if (x === undefined) return box.innerHTML;
  box.append(`${xHTML}  `);
  for (const {label, yHTML, color, isVisible, y} of series) {
    if (!isVisible || y === null || y === undefined || Number.isNaN(y)) continue;
    const name = element("b", {textContent: label});
    name.style.color = color;
    box.append(name, ` ${yHTML}  `);
  }
  return box.innerHTML;
}

// The curves: that of the law, disagreement on a logarithmic axis, each beside what theory predicts, the user's own
// metrics, and speeds. Those of a recording are whole; a line marks the time that is shown.
import {agentColours, styleColour} from "../colours.js";
import {byId, element, setText, throttled} from "../dom.js";
import {decayed, exact, figure, fixed, FLOOR, powerOfTen, seconds, typeset} from "../numbers.js";

import {History, MOST_SPEEDS, speedsOf} from "./history.js";
import {curveWords, disagreementWords, modeOf, responseAt, valueAt, withUnit} from "./theory.js";

const SLOW = 1e-3;         // the top of an axis of speeds is not below
const LEAST_RANGE = 1e-3;  // of an axis of other values, which shows a value that is held as a straight line
const LEAST_GAP_PX = 17;   // between labels of an axis, one above another
const HIGHEST_PX = 7;      // below the top of a chart is the middle of a label; dygraphs moves higher ones down to it
const DRAW_EVERY_MS = 120;
const FIRST_SPEED = 3;  // in a row
const OF_MANY = ["fastest", "mean", "slowest", "selected"];

export class Charts {
  #model;
  #history = new History();
  #selected = new History();  // speeds of the selected agent, as far as they were seen
  #charts = {};
  #cursor_s = null;
  #draw = throttled(DRAW_EVERY_MS, () => this.#redraw());

  constructor(model) {
    this.#model = model;
    byId("speed-names")
        .replaceChildren(
            ...OF_MANY.map((name) => element("span", {}, element("i", {className: `line ${name}`}), name)));
    model.on("run", () => this.#restart());
    model.on("experiment", () => this.#onExperiment());
    model.on("curves", ({curves}) => this.#onCurves(curves));
    model.on("metrics", () => this.#onMetrics());
    model.on("frame", ({frame}) => this.#onFrame(frame));
    model.on("selected", () => {
      this.#selected.clear();
      this.#draw();
    });
  }

  paint() {
    for (const chart of Object.values(this.#charts)) chart.destroy();
    this.#charts = {};
    if (this.#model.experiment) this.#redraw();
  }

  /**
   * What is drawn: rows of disagreement [time, measured, theory, ideal bodies, slowest mode] and of the law's curve
   * [time, measured, theory], and the time that is marked. Null: nothing is.
   */
  get drawn() {
    const disagreement = this.#model.experiment ? this.#disagreementRows() : [];
    const ofLaw = this.#model.experiment ? this.#lawRows() : [];
    return {
      chartRows: this.#history.rows.length,
      firstRow_s: this.#history.rows[0]?.[0] ?? null,
      disagreement: disagreement.at(-1) ?? null,
      disagreementAt: (t_s) => disagreement.findLast((row) => row[0] <= t_s + 1e-9),
      curve: ofLaw.at(-1) ?? null,
      curveFrom: ofLaw[0] ?? null,
      cursor: this.#cursor_s,
      metrics: this.#model.metrics.metrics.map((_, k) => this.#metricRows(k).at(-1) ?? null),
      metricAt: (k, t_s) => this.#metricRows(k).findLast((row) => row[0] <= t_s + 1e-9)
    };
  }

  // --- what is collected ---

  #restart() {
    this.#history.set(this.#model.curves.rows);
    this.#selected.clear();
    this.paint();
  }

  #onCurves({rows}) {
    this.#history.set(rows);
    this.#draw();
  }

  #onFrame({t_s, disagreement_m, curve, speed_m_per_s}) {
    const {isRecording, selected} = this.#model;
    if (!isRecording && t_s > (this.#history.rows.at(-1)?.[0] ?? -1))
      this.#history.add([t_s, disagreement_m, curve, ...speedsOf(speed_m_per_s)]);
    if (selected && t_s !== this.#selected.rows.at(-1)?.[0]) this.#selected.add([t_s, speed_m_per_s[selected - 1]]);
    this.#draw();
  }

  #onExperiment() {
    const {curve, prediction, responses = []} = this.#model.experiment;
    byId("law-chart").hidden = !curve;
    byId("speed-names").hidden = this.#model.size <= MOST_SPEEDS;
    byId("disagreement-chart").hidden = Boolean(curve) && !curve.agrees;
    byId("prediction").classList.toggle("has-line", responses.length > 0 || Boolean(modeOf(this.#model.experiment)));
    setText(byId("prediction"), disagreementWords(prediction, responses));
    if (curve) this.#onCurve(curve, prediction);
    this.#draw();
  }

  #onCurve(curve, prediction) {
    const name = curve.name[0].toUpperCase() + curve.name.slice(1);
    if (byId("law-name").textContent !== name) this.#forget("law");
    setText(byId("law-name"), name);
    byId("law-name").title = curve.meaning;
    byId("law-words").classList.toggle("has-line", Boolean(curve.predicted));
    setText(byId("law-words"), curveWords(curve) || (curve.agrees ? "" : disagreementWords(prediction)));
  }

  /** A section for each of the user's metrics. */
  #onMetrics() {
    const {metrics, error} = this.#model.metrics, box = byId("metric-charts");
    const key = JSON.stringify(metrics);
    if (box.dataset.metrics !== key) {
      for (const id of Object.keys(this.#charts).filter((name) => name.startsWith("metric-"))) this.#forget(id);
      box.dataset.metrics = key;
      box.replaceChildren(...metrics.map(metricSection), element("p", {className: "muted words", id: "metric-error"}));
    }
    setText(byId("metric-error"), error);
    this.#draw();
  }

  #forget(id) {
    this.#charts[id]?.destroy();
    delete this.#charts[id];
  }

  // --- what is drawn ---

  #disagreementRows() {
    const {experiment} = this.#model, rate_per_s = modeOf(experiment), from_s = experiment.prediction?.from_s ?? 0;
    let anchor = null;  // where the line of the slowest mode begins
    return this.#history.rows.map(([t_s, disagreement_m]) => {
      const measured = level(disagreement_m), response = responseAt(experiment, t_s);
      if (response) {
        const value = level(valueAt(response, t_s));
        return response.of_ideal_bodies ? [t_s, measured, null, value, null] : [t_s, measured, value, null, null];
      }
      if (!rate_per_s || t_s < from_s) return [t_s, measured, null, null, null];
      anchor ??= measured === null ? null : {t_s, measured};
      return [t_s, measured, null, null, level(anchor && anchor.measured * Math.exp(-rate_per_s * (t_s - anchor.t_s)))];
    });
  }

  #lawRows() {
    const {curve} = this.#model.experiment;
    if (!curve) return [];
    const shown = curve.decays ? level : (value) => value;
    const predicted = curve.predicted ? shown(curve.predicted.value) : null;
    return this.#history.rows.filter(([t_s]) => t_s >= curve.since_s).map(([t_s, ,
                                                                            value]) => [t_s, shown(value), predicted]);
  }

  #metricRows(k) { return this.#model.metrics.rows.map((row) => [row[0], row[k + 1]]); }

  #drawMetrics(frame) {
    this.#model.metrics.metrics.forEach(({name, unit}, k) => {
      const rows = this.#metricRows(k), id = `metric-${k}`;
      const now = rows.findLast(([t_s]) => t_s <= frame.t_s + 1e-9)?.[1] ?? null;
      setText(byId(`${id}-now`), now === null ? "" : withUnit(now, {unit}));
      this.#show(
          id, rows, {valueRange: rangeOf(rows)},
          () => ({labels: ["t", labelOf(name, unit)], colors: [styleColour("accent")], strokeWidth: 2}));
    });
  }

  #speedRows() {
    if (this.#model.size <= MOST_SPEEDS) return this.#history.rows.map((row) => [row[0], ...row.slice(FIRST_SPEED)]);
    const first_s = this.#selected.rows[0]?.[0] ?? Infinity, last_s = this.#selected.rows.at(-1)?.[0] ?? -Infinity;
    return this.#history.rows.map((row) => {
      const seen = row[0] >= first_s && row[0] <= last_s ? this.#selected.at(row[0])[1] : null;
      return [row[0], ...row.slice(FIRST_SPEED), seen];
    });
  }

  #redraw() {
    const {frame, experiment} = this.#model;
    if (!frame || !experiment) return;
    const {curve} = experiment;
    if (curve) {
      const rows = this.#lawRows(), range = {valueRange: curve.decays ? decadesOf(rows) : rangeOf(rows)};
      const now = frame.curve ?? this.#history.at(frame.t_s)?.[2] ?? null;
      setText(byId("law-now"), now === null ? "" : withUnit(now, curve));
      this.#show("law", rows, range, () => this.#lawLook(curve));
    }
    setText(byId("disagreement-now"), frame.disagreement_m === null ? "" : `${decayed(frame.disagreement_m)} m`);
    setText(byId("speed-now"), `up to ${figure(Math.max(...frame.speed_m_per_s))} m/s`);
    if (!byId("disagreement-chart").hidden) {
      const rows = this.#disagreementRows();
      this.#show("disagreement", rows, {valueRange: decadesOf(rows)}, () => this.#disagreementLook());
    }
    this.#drawMetrics(frame);
    const speeds = this.#speedRows();
    this.#show("speed", speeds, {valueRange: [0, topOf(speeds)]}, () => this.#speedLook());
  }

  #show(id, rows, ranges, look) {
    if (rows.length < 2) {
      const {isRecording} = this.#model;
      return this.#say(id, isRecording ? "The recording is being read." : "The curve begins here when time goes on.");
    }
    if (rows.every(([, ...values]) => values.every((value) => value === null)))
      return this.#say(id, id === "disagreement" ? `Nothing above ${exact(FLOOR)} m yet.` : "No value yet.");
    if (this.#model.isRecording) ranges = {...ranges, dateWindow: [0, this.#model.end_s]};
    if (this.#charts[id])
      this.#charts[id].updateOptions({file: rows, ...ranges});
    else
      this.#charts[id] = new Dygraph(byId(id), rows, {...this.#look(), ...look(), ...ranges});
  }

  // Where there is no curve, as on a page that is opened while the run is paused.
  #say(id, words) {
    this.#forget(id);
    byId(id).replaceChildren(element("p", {className: "muted hint", textContent: words}));
  }

  #look() {
    const along = (x, range) => fixed(x, decimalsOf(range));
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
      underlayCallback: (context, area, chart) => this.#drawCursor(context, area, chart),
      xRangePad: 4,
      xAxisHeight: 22,
      rightGap: 8,
      axes: {
        x: {
          axisLabelFormatter: (t, _granularity, _options, chart) => `${along(t, chart.xAxisRange())} s`,
          pixelsPerLabel: 70,
          valueFormatter: (t) => seconds(t)
        },
        y: {
          axisLabelWidth: 46,
          pixelsPerLabel: 20,
          axisLabelFormatter: (x, _granularity, _options, chart) => along(x, chart.yAxisRange()),
          valueFormatter: (x) => figure(x)
        }
      },
    };
  }

  /** A line at the time that is shown of a recording. */
  #drawCursor(context, area, chart) {
    const {isRecording, frame} = this.#model;
    this.#cursor_s = isRecording && frame ? frame.t_s : null;
    if (this.#cursor_s === null) return;
    context.fillStyle = styleColour("muted");
    context.fillRect(Math.round(chart.toDomXCoord(frame.t_s)), area.y, 1, area.h);
  }

  #logarithmic(look) {
    return {...look, logscale: true, axes: {...this.#look().axes, y: {...this.#look().axes.y, ticker: powersOfTen}}};
  }

  #lawLook({name, unit, decays}) {
    const measured = labelOf(name, unit);
    const look = {
      labels: ["t", measured, "theory"],
      colors: [styleColour("accent"), styleColour("muted")],
      series: {[measured]: {strokeWidth: 2}, theory: {strokePattern: [5, 4]}}
    };
    return decays ? this.#logarithmic(look) : look;
  }

  #disagreementLook() {
    return this.#logarithmic({
      labels: ["t", "measured (m)", "theory (m)", "ideal bodies (m)", "slowest mode (m)"],
      colors: [styleColour("accent"), styleColour("muted"), styleColour("muted"), styleColour("muted")],
      series: {
        "measured (m)": {strokeWidth: 2},
        "theory (m)": {strokePattern: [5, 4]},
        "ideal bodies (m)": {strokePattern: [8, 3, 2, 3]},
        "slowest mode (m)": {strokePattern: [1, 3]}
      },
    });
  }

  #speedLook() {
    const {size} = this.#model, many = size > MOST_SPEEDS;
    const names = many ? OF_MANY : Array.from({length: size}, (_, k) => `agent ${k + 1}`);
    const colors = many ? ["accent", "text", "muted", "velocity"].map(styleColour) : agentColours(size);
    return {labels: ["t", ...names], colors};
  }
}

/** The label of a curve: "path length (m)". */
function labelOf(name, unit) { return `${name}${unit ? ` (${typeset(unit)})` : ""}`; }

function metricSection({name}, k) {
  const heading = element(
      "h2", {}, element("span", {className: "own", textContent: name}), " ", element("b", {id: `metric-${k}-now`}));
  const chart = element("div", {id: `metric-${k}`, className: "plot", role: "img", "aria-label": `${name} over time`});
  return element("section", {className: "chart"}, heading, chart);
}

/** A value as a logarithmic axis shows it; null: below its floor. */
function level(value) { return value === null || value === undefined || value < FLOOR ? null : value; }

/** With how many decimals the labels of an axis all differ. */
function decimalsOf([low, high]) { return Math.min(8, Math.max(0, Math.ceil(0.5 - Math.log10(high - low)))); }

/** The top of an axis of speeds. */
function topOf(rows) { return 1.1 * rows.reduce((top, [, ...speeds]) => Math.max(top, ...speeds), SLOW); }

/**
 * A range for a logarithmic axis: what is measured, with some room, at least a factor of 5; and what is predicted, as
 * far as a decade below that.
 */
function decadesOf(rows) {
  let low = Infinity, least = Infinity, high = FLOOR;
  for (const [, measured, ...predicted] of rows) {
    const known = predicted.filter((value) => value !== null);
    low = Math.min(low, measured ?? Infinity);
    least = Math.min(least, measured ?? Infinity, ...known);
    high = Math.max(high, measured ?? 0, ...known);
  }
  low = Math.max(least, low / 10);
  return [Math.max(FLOOR, Math.min(low / 1.2, high / 5)), Math.max(5 * FLOOR, high * 1.2)];
}

/** A range for any other axis: what is measured and predicted, with some room, and at least LEAST_RANGE. */
function rangeOf(rows) {
  const values = rows.flatMap(([, ...each]) => each.filter((value) => value !== null));
  if (values.length === 0) return [null, null];
  const low = Math.min(...values), high = Math.max(...values), room = 0.05 * (high - low);
  if (high - low >= LEAST_RANGE) return [low - room, high + room];
  return [(low + high - LEAST_RANGE) / 2, (low + high + LEAST_RANGE) / 2];
}

/**
 * Labels of a logarithmic axis that is so many pixels high: 1, 2, 3, ... times powers of ten, as far as there is room.
 */
function powersOfTen(low, high, height_px) {
  const first = Math.floor(Math.log10(low)), last = Math.ceil(Math.log10(high)), decades = Math.log10(high / low);
  const between = decades < 0.7 ? [1, 2, 3, 4, 5, 6, 7, 8, 9] : decades < 2 ? [1, 2, 5] : [1];
  const every = Math.max(1, Math.ceil((last - first) / 5)), ticks = [];
  for (let k = first; k <= last; k += every)
    for (const m of between) ticks.push({v: m * 10 ** k, label: shortLabel(m, k), m});
  return withRoom(ticks.filter(({v}) => v >= low && v <= high), high, height_px / decades);
}

/** Those of the ticks that have room, powers of ten first, then 5 and 2 times them. */
function withRoom(ticks, high, px_per_decade) {
  const rank = ({m}) => [1, 5, 2].indexOf(m) + 1 || 4, kept = [];
  const placeOf = ({v}) => Math.max(HIGHEST_PX, Math.log10(high / v) * px_per_decade);
  const isApart = (a) => (b) => Math.abs(placeOf(a) - placeOf(b)) >= LEAST_GAP_PX;
  for (const tick of ticks.toSorted((a, b) => rank(a) - rank(b)))
    if (kept.every(isApart(tick))) kept.push(tick);
  return kept.toSorted((a, b) => a.v - b.v);
}

/** m times ten to the k. */
function shortLabel(m, k) {
  if (k >= -3 && k <= 3) return exact(m * 10 ** k);
  return `${m === 1 ? "" : `${m}·`}${powerOfTen(k)}`;
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

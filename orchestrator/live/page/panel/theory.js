// What theory says beside the curves, as lines and in words.
import {decayed, figure, fixed, seconds, typeset} from "../numbers.js";

const BOUNDS = {
  equal: "",
  at_most: "at most ",
  at_least: "at least ",
  within: "about "
};

/** The response that holds at a time: {from_s, until_s, every_s, value_m, of_ideal_bodies}; undefined: none does. */
export function responseAt({responses = []}, t_s) {
  return responses.find(
      ({from_s, until_s}, k) => t_s >= from_s && (t_s < until_s || k === responses.length - 1 && t_s === until_s));
}

/** The disagreement that a response predicts for a time, on a straight line of the logarithm between its points. */
export function valueAt(part, t_s) {
  const at = (t_s - part.from_s) / part.every_s, k = Math.floor(at + 1e-6), share = Math.max(0, at - k);
  const here = part.value_m[k] ?? null, next = part.value_m[k + 1];
  return share > 1e-6 && here > 0 && next > 0 ? here * (next / here) ** share : here;
}

/** The rate of the slowest mode, where it says how agents come to agree; null: it does not. */
export function modeOf({prediction}) {
  return prediction?.of_agreement && prediction.stable !== false ? prediction.slowest_rate_per_s : null;
}

/** What theory says of the disagreement, or of each agent's flight to its target. */
export function disagreementWords(prediction = {}, responses = []) {
  const {from_s = 0, of_agreement, stable, rate_per_s, slowest_rate_per_s, settling_time_s, why} = prediction;
  if (rate_per_s && of_agreement === false)
    return `Theory: each flight decays at ${figure(rate_per_s)} 1/s${
        settling_time_s ? `, and settles (2 %) within ${seconds(settling_time_s)}` : ""}`;
  if (rate_per_s)
    return `Theory: decays at ${figure(rate_per_s)} 1/s${
        settling_time_s ? `, settled (2 %) at ${seconds(from_s + settling_time_s)}` : ""}`;
  if (stable === false) return `Theory: does not agree${why ? `: ${why}` : ""}`;
  if (slowest_rate_per_s) return `Theory: in the long run decays at ${figure(slowest_rate_per_s)} 1/s or faster`;
  if (why) return `No prediction: ${why}`;
  if (responses.length === 0) return "";
  return responses.at(-1).of_ideal_bodies ? "Ideal bodies, flown ahead by the same laws" : "Theory";
}

/** A value of the curve of the law, with its unit; a count without decimals. */
export function withUnit(x, {unit, decays}) {
  if (!unit && Number.isInteger(x)) return fixed(x, 0);
  const text = decays ? decayed(x) : figure(x);
  return unit ? `${text} ${typeset(unit)}` : text;
}

/** What theory says of the curve of the law: of the figure of summary.json that is about it. */
export function curveWords({unit, predicted}) {
  return predicted ? `Theory: ${predicted.figure} ${BOUNDS[predicted.bound]}${withUnit(predicted.value, {unit})}` : "";
}

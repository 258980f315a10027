// What theory says beside the curves, as lines and in words.
import {figure, typeset} from "../dom.js";

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

/** What theory says of the disagreement. */
export function disagreementWords(prediction = {}) {
  const {of_agreement, stable, rate_per_s, slowest_rate_per_s, why} = prediction;
  if (rate_per_s)
    return `Theory: ${of_agreement === false ? "each flight " : ""}decays at ${figure(rate_per_s)} 1/s${
        settles(prediction)}`;
  if (stable === false) return `Theory: does not agree${why ? `: ${why}` : ""}`;
  if (slowest_rate_per_s) return `Theory: in the long run decays at ${figure(slowest_rate_per_s)} 1/s or faster`;
  return why ? `No prediction: ${why}` : "";
}

function settles({from_s = 0, settling_time_s}) {
  return settling_time_s ? `, settled (2 %) at ${figure(from_s + settling_time_s, 2)} s` : "";
}

/** A number for people, with its unit. */
export const withUnit = (x, unit) => `${figure(x)}${unit ? ` ${typeset(unit)}` : ""}`;

/** What theory says of the curve of the law. */
export function curveWords({unit, predicted}) {
  return predicted ? `Theory: ${BOUNDS[predicted.bound]}${withUnit(predicted.value, unit)}` : "";
}

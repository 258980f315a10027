// How the page writes numbers, one way for each kind:
//   measured and predicted values   figure()    about four digits: 0.250, 12.34, 5678, 1.2·10⁻⁶
//   components of vectors           fixed()     two decimals, one below another; degrees one
//   times                           seconds()   12.34 s
//   what somebody has set or may    exact()     as it was written, to six digits: 0.25, −200, 10⁶
// A minus is as wide as a digit, but in boxes, where it is what a keyboard has.

/**
 * The floor of distances and other values that decay: what is smaller is no matter, and no curve and no figure dwells
 * on it.
 */
export const FLOOR = 1e-6;
/** What is smaller, of any value in SI units, is what rounding left of a zero. */
export const ROUNDING = 1e-12;

const WORTH_DIGITS = [1e-3, 1e5];  // magnitudes outside are written with a power of ten
const typesetMinus = (text) => text.replace("-", "−");

/** A number for people: about four digits. */
export function figure(x) {
  if (x === null || x === undefined || !Number.isFinite(x)) return "–";
  const size = Math.abs(x), [least, most] = WORTH_DIGITS;
  if ((size >= ROUNDING && size < least) || size >= most) return withPower(x, 1);
  return fixed(x, size < 10 ? 3 : size < 1000 ? 2 : 0);
}

/** The same of a value that decays: what is below the floor is only said to be below it. */
export const decayed = (x) => (x !== null && Math.abs(x) < FLOOR ? `< ${exact(FLOOR)}` : figure(x));

/** A number with so many decimals. */
export function fixed(x, decimals = 2) {
  if (!Number.isFinite(x)) return "–";
  const text = x.toFixed(decimals);
  return Number(text) === 0 ? text.replace("-", "") : typesetMinus(text);
}

/** A time or an age. */
export const seconds = (t_s) => `${fixed(t_s)} s`;

/** A number as it was set, without what rounding adds. */
export function exact(x) {
  const size = Math.abs(x), [least, most] = WORTH_DIGITS;
  if (size !== 0 && (size < least || size >= most)) return withPower(x);
  return typesetMinus(String(rounded(x)));
}

/** The same number for a box, in which it is edited, or for TOML. */
export const rounded = (x) => Number(x.toPrecision(6)) || 0;

/** Ten to the k. */
export const powerOfTen = (k) => `10${[...String(k)].map((c) => "⁰¹²³⁴⁵⁶⁷⁸⁹"[c] ?? "⁻").join("")}`;

/** x with a power of ten, and so many decimals; without `decimals` as many as it has. */
function withPower(x, decimals) {
  const [digits, power] = (decimals === undefined ? rounded(x) : x).toExponential(decimals).split("e");
  const isOne = decimals === undefined && Math.abs(digits) === 1;
  return `${isOne ? (x < 0 ? "−" : "") : `${typesetMinus(digits)}·`}${powerOfTen(Number(power))}`;
}

/** A unit as it is typeset: m² for m^2. */
export const typeset = (unit) => unit.replace("^2", "²").replace("^3", "³");

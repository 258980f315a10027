// The scale of a slider. Ranges of keys are wide ([0, 1000] for a gain of 0.05), so wide ones are logarithmic, with the
// least value at the left end.

const WIDE = 50;    // a range of more than this many times the value
const DECADES = 5;  // of a logarithmic scale whose least value is 0

export class Scale {
  static STEPS = 1000;
  #min;
  #max;
  #least;  // of a logarithmic scale, at step 1; 0: the scale is linear
  #isInteger;

  constructor({min, max, value, kind}) {
    [this.#min, this.#max] = [min, max];
    this.#isInteger = kind === "integer";
    const isWide = min >= 0 && max > WIDE * Math.max(Math.abs(value), 1e-9);
    this.#least =
        isWide ? (min > 0 ? min : max / 10 ** Math.max(DECADES, Math.ceil(Math.log10(max / (value || max))) + 2)) : 0;
  }

  /** The value at a step, rounded to what a hand can mean. */
  value(step) {
    const share = step / Scale.STEPS;
    if (step <= 0) return this.#min;
    if (step >= Scale.STEPS) return this.#max;
    const value =
        this.#least ? this.#least * (this.#max / this.#least) ** share : this.#min + share * (this.#max - this.#min);
    return this.#isInteger ? Math.round(value) : Number(value.toPrecision(3));
  }

  /** The step of a value. */
  place(value) {
    const share = !this.#least ? (value - this.#min) / (this.#max - this.#min) :
        value <= this.#least   ? 0 :
                                 Math.log(value / this.#least) / Math.log(this.#max / this.#least);
    return Math.round(Scale.STEPS * Math.max(0, Math.min(1, share)));
  }
}

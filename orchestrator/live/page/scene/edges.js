// The edges of the graph: each is an arrow from the agent that is heard to the one that hears it. It lights up when a
// sample was heard and darkens when it was lost or out of range.
import {rgb, styleColour} from "../colours.js";
import {EDGE} from "../model.js";

import {Ribbons} from "./ribbons.js";

const MOST_EDGES = 20_000;
const LEFT_OUT = "left out";  // it was heard, and the law of the hearer does not use it
const EASE = 0.35;            // part of the way to its new look that an edge goes in a row

// Of each state: colour in the style sheet, alpha, width, dash (px).
const LOOKS = {
  [EDGE.NONE]: ["edge-none", 0.65, 1.5, 4],
  [EDGE.HEARD]: ["edge-heard", 0.9, 2, 0],
  [EDGE.LOST]: ["edge-lost", 0.55, 1.3, 0],
  [EDGE.FAR]: ["edge-far", 0.4, 1.2, 6],
  [EDGE.SILENT]: ["edge-far", 0.3, 1, 0],
  [EDGE.UNKNOWN]: ["edge-far", 0.3, 1, 0],
  [LEFT_OUT]: ["left-out", 0.85, 1.6, 3],
};

const wanted = new Float32Array(5);  // what an edge goes to

export class Edges extends Ribbons {
  #edges;
  #shifts;
  #density;
  #looks = {};
  #now;  // red, green, blue, alpha, width of each edge as drawn

  constructor(edges) {
    const drawn = edges.slice(0, MOST_EDGES);
    super(Math.max(1, drawn.length), {head: drawn.length > 400 ? 6 : 9, trim: 7, order: 2});
    const pairs = new Set(drawn.map(([hearer, heard]) => `${hearer} ${heard}`));
    this.#edges = drawn;
    this.#shifts = drawn.map(([hearer, heard]) => (pairs.has(`${heard} ${hearer}`) ? 2.5 : 0));
    this.#density = densityOf(drawn.length);
    this.#now = new Float32Array(5 * drawn.length);
    this.count = drawn.length;
    this.paintAll();
  }

  get edges() { return this.#edges; }

  paintAll() {
    for (const [state, [name, alpha, width, dash]] of Object.entries(LOOKS))
      this.#looks[state] = {colour: rgb(styleColour(name)), alpha, width, dash};
  }

  /**
   * `pointed`: index of the edge under the pointer, -1: none; `showsLeftOut`: what laws leave out looks so. Returns
   * true while a look still changes.
   */
  update({p, edge, left_out}, {pointed = -1, selected = 0, radius = 0, showsLeftOut = true} = {}) {
    this.uniform("radius", radius);
    let moving = false;
    this.#edges.forEach(([hearer, heard], k) => {
      this.place(k, p, 3 * (heard - 1), p, 3 * (hearer - 1));
      const look = this.#looks[showsLeftOut && left_out?.[k] ? LEFT_OUT : edge?.[k] ?? EDGE.UNKNOWN];
      moving = this.#ease(k, look, k === pointed, selected === hearer || selected === heard, selected) || moving;
    });
    this.send(["start", "end", "tint", "form"]);
    return moving;
  }

  #ease(k, look, isPointed, isOfSelected, selected) {
    const now = this.#now.subarray(5 * k, 5 * k + 5);
    const emphasis = isPointed || isOfSelected ? 1 : this.#density * (selected ? 0.45 : 1);
    wanted.set(look.colour);
    wanted[3] = look.alpha * emphasis;
    wanted[4] = look.width * (isPointed ? 2 : isOfSelected ? 1.3 : 1);
    let moving = false;
    for (let i = 0; i < 5; ++i) {
      now[i] += EASE * (wanted[i] - now[i]);
      moving = moving || Math.abs(wanted[i] - now[i]) > 0.02;
    }
    this.paint(k, now, now[3]);
    this.shape(k, now[4], this.#shifts[k], look.dash);
    return moving;
  }

  /** Of an edge as drawn: red, green, blue, alpha. */
  look(k) { return [...this.#now.subarray(5 * k, 5 * k + 4)]; }

  /** The shift of an edge to its left, in pixels. */
  shift(k) { return this.#shifts[k]; }
}

/**
 * How much of its alpha each of so many edges has. Some hundred edges stand beside each other; of some thousand, dozens
 * cover each agent, and shall together still let it be seen.
 */
function densityOf(count) {
  const beside = Math.sqrt(120 / Math.max(1, count)), over = 1500 / Math.max(1, count);
  return Math.max(0.015, Math.min(1, beside) * Math.min(1, over));
}

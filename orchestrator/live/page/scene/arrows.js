// Arrows that begin at agents: velocity (where the agent is after a second) and commanded acceleration; straight lines
// under them to the ground; and the tree of pursuit.
import {rgb, styleColour} from "../colours.js";

import {Ribbons} from "./ribbons.js";

/** Arrows along a flat array of the row, 1 m for each m/s or m/s^2. */
export class Arrows extends Ribbons {
  #field;
  #colour;
  #size;

  constructor(size, field, colour) {
    super(size, {head: 9, order: 3});
    Object.assign(this, {visible: false});
    this.#field = field;
    this.#colour = colour;
    this.#size = this.count = size;
    this.paintAll();
  }

  paintAll() {
    for (let k = 0; k < this.#size; ++k) {
      this.paint(k, rgb(styleColour(this.#colour)), 0.95);
      this.shape(k, 2.4);
    }
    this.send(["tint", "form"]);
  }

  update(frame) {
    if (!this.visible) return;
    const {p} = frame, field = frame[this.#field];
    const ends = p.map((x, i) => x + field[i]);
    for (let k = 0; k < this.#size; ++k) this.place(k, p, 3 * k, ends, 3 * k);
    this.send(["start", "end"]);
  }
}

/** Plumb lines: the height of an agent above the ground. */
export class Plumbs extends Ribbons {
  #size;

  constructor(size) {
    super(size, {order: 0});
    this.#size = this.count = size;
    this.paintAll();
  }

  paintAll() {
    for (let k = 0; k < this.#size; ++k) {
      this.paint(k, rgb(styleColour("grid")), 0.45);
      this.shape(k, 1);
    }
    this.send(["tint", "form"]);
  }

  update({p}) {
    const feet = p.map((x, i) => (i % 3 === 2 ? 0 : x));
    for (let k = 0; k < this.#size; ++k) this.place(k, p, 3 * k, feet, 3 * k);
    this.send(["start", "end"]);
  }
}

/** Each agent of a tree to its parent, whom it pursues. */
export class Tree extends Ribbons {
  #pairs;

  constructor(agents) {
    const pairs = agents.filter(({parent}) => parent > 0).map(({id, parent}) => [id, parent]);
    super(Math.max(1, pairs.length), {head: 13, trim: 9, order: 2});
    this.#pairs = pairs;
    this.count = pairs.length;
    this.paintAll();
  }

  paintAll() {
    this.#pairs.forEach((_, k) => {
      this.paint(k, rgb(styleColour("tree")), 0.8);
      this.shape(k, 3, -4, 7);
    });
    this.send(["tint", "form"]);
  }

  update({p}) {
    this.#pairs.forEach(([id, parent], k) => this.place(k, p, 3 * (id - 1), p, 3 * (parent - 1)));
    this.send(["start", "end"]);
  }
}

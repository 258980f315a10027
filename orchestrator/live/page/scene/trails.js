// Where the agents were: the last seconds of simulated time, fading. A ring of samples: each new one writes one line
// for each agent, and the graphics card lets the older ones fade.
import {agentColours, rgb} from "../colours.js";

import {Ribbons} from "./ribbons.js";

const SPAN_S = 8;
const MOST_LINES = 30_000;
const MOST_SAMPLES = 120;
const CROWD = 100;  // trails of more agents are thin and pale

export class Trails extends Ribbons {
  #size;
  #samples;
  #slot = 0;     // of the newest line of each agent, which still grows
  #last = null;  // the sample from which it grows
  #last_s = 0;

  constructor(size) {
    const samples = Math.max(4, Math.min(MOST_SAMPLES, Math.floor(MOST_LINES / size)));
    super(size * samples, {lifetime: SPAN_S, order: 1});
    this.#size = size;
    this.#samples = samples;
    this.paintAll();
    this.clear();
  }

  paintAll() {
    const colours = agentColours(this.#size).map(rgb);
    const [alpha, width] = this.#size > CROWD ? [0.35, 1.2] : [0.75, 2];
    for (let k = 0; k < this.capacity; ++k) {
      this.paint(k, colours[k % this.#size], alpha);
      this.shape(k, width);
    }
    this.send(["tint", "form"]);
  }

  clear() {
    this.count = 0;
    this.#slot = 0;
    this.#last = null;
  }

  update({p, t_s}) {
    if (this.#last && (t_s < this.#last_s || t_s > this.#last_s + SPAN_S)) this.clear();  // somebody looked elsewhere
    if (!this.#last) [this.#last, this.#last_s] = [p, t_s];
    this.#write(p, t_s);
    if (t_s - this.#last_s < SPAN_S / this.#samples) return;
    [this.#last, this.#last_s] = [p, t_s];
    this.#slot = (this.#slot + 1) % this.#samples;
  }

  #write(p, t_s) {
    const first = this.#slot * this.#size, {born} = this.geometry.attributes;
    for (let agent = 0; agent < this.#size; ++agent) {
      this.place(first + agent, this.#last, 3 * agent, p, 3 * agent);
      born.setX(first + agent, t_s);
    }
    this.send(["start", "end", "born"], first, this.#size);
    this.count = Math.max(this.count, first + this.#size);
    this.uniform("newest", t_s);
  }
}

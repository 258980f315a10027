// Texts and marks of constant size, above the picture: numbers of agents, the scale of the ground, waypoints, formation
// places, the predicted meeting point, who lies or is lost, and where an agent is being sent.
import {agentColours, styleColour} from "../colours.js";
import {fixed} from "../numbers.js";

import {around, at, Labels} from "./labels.js";

const FONT = '12px system-ui, "Segoe UI", "DejaVu Sans", sans-serif';
const MOST_NUMBERS = 60;  // with more agents, only those of interest and those near the camera
const NEAR_PX = 26;       // on the screen, between neighbouring numbers of a crowd
const BESIDE = 0.65;      // of a body's radius to the right and up is where its number stands, between the arms
const LEAST_RING_PX = 11;
const FURNITURE = ".views, #wind, .foot";  // what stands above the view, and holds texts of its own

// What takes its place before what: of numbers, those of interest come before the others.
const RANK = {
  GHOST: 0,
  OF_INTEREST: 1,
  NUMBER: 2,
  PLAN: 3,
  AXIS_NAME: 4,
  AXIS: 5
};

export class Overlay {
  #view;
  #canvas;
  #pen;
  #labels = new Labels();

  constructor(canvas, view) {
    this.#canvas = canvas;
    this.#view = view;
    this.#pen = canvas.getContext("2d");
  }

  resize(width, height, ratio) {
    Object.assign(this.#canvas, {width: width * ratio, height: height * ratio});
    this.#pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  }

  /** The texts of the picture: {text, box: [left, top, right, bottom]}. */
  get texts() { return this.#labels.drawn; }

  draw(frame) {
    const {clientWidth: width, clientHeight: height} = this.#canvas;
    this.#pen.clearRect(0, 0, width, height);
    this.#pen.lineJoin = "round";
    this.#labels.begin(width, height, this.#furniture());
    this.#ground();
    const {experiment} = this.#view.model;
    if (experiment && frame) this.#marks(experiment, frame);
    this.#labels.end((text, {bold}) => this.#widthOf(text, bold), (x, y, text, look) => this.#write(x, y, text, look));
  }

  #marks(experiment, frame) {
    const {shown, ghost} = this.#view;
    if (shown.plan) this.#plan(experiment, frame);
    this.#rings(experiment);
    if (shown.liars) this.#liars();
    if (shown.lost) this.#lost();
    if (shown.numbers) this.#numbers(experiment);
    if (ghost) this.#ghost(ghost);
  }

  /** The boxes of what stands above the view. */
  #furniture() {
    return [...this.#canvas.parentElement.querySelectorAll(FURNITURE)]
        .filter(({hidden}) => !hidden)
        .map(({offsetLeft: x, offsetTop: y, offsetWidth: w, offsetHeight: h}) => [x, y, x + w, y + h]);
  }

  // --- what is drawn ---

  #ground() {
    const {ground, eye} = this.#view;
    for (const [p, text] of ground.labels(eye.target))
      this.#text(`on the ground ${p}`, RANK.AXIS, p, text, at(5, 12), {colour: styleColour("muted")});
    for (const [p, text, colour] of ground.names()) this.#text(text, RANK.AXIS_NAME, p, text, at(5, -6), {colour});
  }

  #plan({agents, prediction}, {p}) {
    const colours = agentColours(agents.length), ink = styleColour("text");
    for (const {id, waypoints_m} of agents)
      (waypoints_m ?? []).forEach((place, k) => {
        this.#mark(place, colours[id - 1], diamond(6));
        const name = `waypoint ${k + 1} of ${id}`;
        this.#text(name, RANK.PLAN, place, String(k + 1), around(9, 10), {colour: styleColour("muted")});
      });
    for (const [place, id] of places(agents, p)) this.#mark(place, colours[id - 1], ring(8), [2, 3]);
    if (!prediction?.value_m) return;
    this.#mark(prediction.value_m, ink, star(9));
    this.#text("predicted", RANK.PLAN, prediction.value_m, "predicted", around(13, 12), {colour: ink});
  }

  #rings({agents}) {
    const {model, pointed} = this.#view;
    for (const {id, goto: canGo, leads} of agents) {
      if (id === model.selected)
        this.#circle(id, 4, styleColour("accent"), 2.2);
      else if (id === pointed.agent)
        this.#circle(id, 4, styleColour("accent"), 1.2);
      if (leads || (canGo && agents.length <= MOST_NUMBERS))
        this.#circle(id, 0, styleColour("muted"), 1.2, leads ? [] : [2, 2]);
    }
  }

  #liars() {
    for (const id of this.#view.model.liars) {
      const [x, y, depth] = this.#view.screen.subarray(3 * (id - 1), 3 * id);
      const r = this.#squareOf(id);
      if (depth <= 1) this.#stroke(() => this.#pen.rect(x - r, y - r, 2 * r, 2 * r), styleColour("lies"), 2, [5, 3]);
    }
  }

  /** A cross through the body of each agent that is lost. */
  #lost() {
    for (const id of this.#view.model.lost) {
      const [x, y, depth] = this.#view.screen.subarray(3 * (id - 1), 3 * id);
      const r = this.#squareOf(id) - 2;
      if (depth > 1) continue;
      for (const [colour, width] of [[styleColour("stage"), 5], [styleColour("lost"), 2.4]])
        this.#stroke(() => {
          for (const down of [1, -1]) {
            this.#pen.moveTo(x - r, y - down * r);
            this.#pen.lineTo(x + r, y + down * r);
          }
        }, colour, width, []);
    }
  }

  /** Half a side of the square around an agent that lies. */
  #squareOf(id) { return Math.max(LEAST_RING_PX, this.#view.radiusPx(id)) + 2; }

  #numbers({agents}) {
    const {model, pointed, screen, shown} = this.#view, isCrowd = agents.length > MOST_NUMBERS, taken = new Set();
    const liars = new Set(shown.liars ? model.liars : []), gone = new Set(shown.lost ? model.lost : []);
    const write = ({id, leads}, rank) => {
      const lies = liars.has(id), isLost = gone.has(id);
      const [x, y, depth] = screen.subarray(3 * (id - 1), 3 * id);
      const cell = `${Math.round(x / NEAR_PX)} ${Math.round(y / NEAR_PX)}`;
      if (depth > 1 || (isCrowd && taken.has(cell))) return;
      taken.add(cell);
      const away = lies || isLost ? this.#squareOf(id) + 3 : BESIDE * this.#view.radiusPx(id);
      this.#labels.want(
          `agent ${id}`, rank, [x, y],
          [id, leads ? "leads" : "", lies ? "lies" : "", isLost ? "lost" : ""].filter(Boolean).join(" "),
          around(Math.max(10, away), Math.max(12, away)), {
            colour: styleColour(
                isLost   ? "lost" :
                    lies ? "lies" :
                           "text"),
            bold: id === model.selected || leads || lies || isLost
          });
    };
    const isOfInterest = ({id, leads}) =>
        id === model.selected || id === pointed.agent || leads || liars.has(id) || gone.has(id);
    for (const agent of agents)
      if (isOfInterest(agent)) write(agent, RANK.OF_INTEREST);
    if (isCrowd && this.#view.eye.distance() >= 40) return;
    for (const agent of agents)
      if (!isOfInterest(agent)) write(agent, RANK.NUMBER);
  }

  #ghost({agent, p}) {
    const [x, y] = this.#view.screen.subarray(3 * agent - 3), colour = styleColour("accent");
    const to = this.#view.toScreen(p), foot = this.#view.toScreen([p[0], p[1], 0]);
    this.#line([x, y], to, colour, [6, 4]);
    this.#line(to, foot, styleColour("muted"), [2, 3]);
    this.#mark(p, colour, cross(8));
    this.#text(
        "ghost", RANK.GHOST, p, `${p.map((c) => fixed(c)).join(", ")} m`, around(12, 14),
        {colour: styleColour("text")});
  }

  // --- how ---

  #at(p) {
    const [x, y, depth] = this.#view.toScreen(p);
    return depth <= 1 ? [x, y] : null;
  }

  #text(name, rank, p, text, places, look) {
    const place = this.#at(p);
    if (place) this.#labels.want(name, rank, place, text, places, look);
  }

  #widthOf(text, bold) {
    this.#pen.font = bold ? `600 ${FONT}` : FONT;
    return this.#pen.measureText(text).width;
  }

  #write(x, y, text, {colour, bold}) {
    this.#pen.font = bold ? `600 ${FONT}` : FONT;
    Object.assign(this.#pen, {lineWidth: 3, strokeStyle: styleColour("stage"), fillStyle: colour});
    this.#pen.strokeText(text, x, y);
    this.#pen.fillText(text, x, y);
  }

  #mark(p, colour, shape, dash = []) {
    const at = this.#at(p);
    if (!at) return;
    this.#pen.save();
    this.#pen.translate(...at);
    this.#stroke(() => shape(this.#pen), colour, 1.6, dash);
    this.#pen.restore();
  }

  /** A circle around the body of an agent, with some room. */
  #circle(id, room_px, colour, width, dash = []) {
    const [x, y, depth] = this.#view.screen.subarray(3 * (id - 1), 3 * id);
    const radius = Math.max(LEAST_RING_PX, this.#view.radiusPx(id)) + room_px;
    if (depth <= 1) this.#stroke(() => this.#pen.arc(x, y, radius, 0, 2 * Math.PI), colour, width, dash);
  }

  #line(from, to, colour, dash) {
    this.#stroke(() => {
      this.#pen.moveTo(...from);
      this.#pen.lineTo(to[0], to[1]);
    }, colour, 1.4, dash);
  }

  #stroke(trace, colour, width, dash) {
    this.#pen.beginPath();
    trace();
    Object.assign(this.#pen, {strokeStyle: colour, lineWidth: width});
    this.#pen.setLineDash(dash);
    this.#pen.stroke();
    this.#pen.setLineDash([]);
  }
}

/** [place, agent] of a formation: it has no place of its own, so it is drawn around the leader or the agents' mean. */
export function places(agents, p) {
  const placed = agents.filter(({place_m}) => place_m), leaders = placed.filter(({leads}) => leads);
  if (placed.length === 0) return [];
  const anchors = leaders.length === 1 ? leaders : placed;
  const middle = [0, 1, 2].map(
      (i) => anchors.reduce((sum, {id, place_m}) => sum + p[3 * (id - 1) + i] - place_m[i], 0) / anchors.length);
  return placed.map(({id, place_m}) => [place_m.map((x, i) => (i === 2 ? p[3 * id - 1] : x + middle[i])), id]);
}

// --- shapes around (0, 0) ----------------------------------------------------------------------------------

const polygon = (points) => (pen) => {
  points.forEach(([x, y], k) => (k ? pen.lineTo(x, y) : pen.moveTo(x, y)));
  pen.closePath();
};
const diamond = (r) => polygon([[0, -r], [r, 0], [0, r], [-r, 0]]);
const ring = (r) => (pen) => pen.arc(0, 0, r, 0, 2 * Math.PI);
const star = (r) => polygon(Array.from({length: 10}, (_, k) => {
  const a = (k / 5 - 0.5) * Math.PI, length = k % 2 ? 0.42 * r : r;
  return [length * Math.cos(a), length * Math.sin(a)];
}));
const cross = (r) => (pen) => {
  pen.arc(0, 0, r, 0, 2 * Math.PI);
  for (const [x, y] of [[1, 0], [0, 1]]) {
    pen.moveTo(-1.5 * r * x, -1.5 * r * y);
    pen.lineTo(1.5 * r * x, 1.5 * r * y);
  }
};

// What a pointer does in the view: points at agents and edges, chooses an agent, sends it somewhere by dragging it,
// cuts and mends edges by clicking them.
import {Plane, Raycaster, Vector2, Vector3} from "/vendor/three/build/three.module.js";

import {edgesToml, gotoToml} from "../asking.js";
import {fixed} from "../numbers.js";

const AGENT_PX = {
  mouse: 14,
  touch: 24
};
const EDGE_PX = {
  mouse: 6,
  touch: 14
};
const STILL_PX = 5;  // a pointer that moved less was a click
// A metre of height has at least this part of the pixels of a metre on the ground when it is dragged.
const LEAST_UPRIGHT = 0.5;

export class Hand {
  #view;
  #model;
  #asking;
  #tip;
  #card;
  #down = null;  // {x, y, at, agent, canGo, moved, p}: while a button is pressed; `at`: where the drag has come to

  constructor(view, asking, tip, card) {
    this.#view = view;
    this.#model = view.model;
    this.#asking = asking;
    this.#tip = tip;
    this.#card = card;
    const on = (kind, listener) => view.canvas.addEventListener(kind, listener);
    on("pointerdown", (event) => this.#onDown(event));
    on("pointermove", (event) => this.#onMove(event));
    on("pointerup", (event) => this.#onUp(event));
    on("pointercancel", () => this.#letGo());
    on("pointerleave", () => this.#point(0, -1, null));
    this.#model.on("events", () => {
      if (!this.#tip.hidden && view.pointed.edge >= 0) this.#tip.textContent = this.#edgeWords(view.pointed.edge);
    });
  }

  // --- finding ---

  #agentAt(x, y, kind) {
    const {screen} = this.#view;
    const reach_px = AGENT_PX[kind] ?? AGENT_PX.touch;
    let found = 0, least = 1;  // of the reach, or of the body if that is larger
    for (let k = 0, number = 1; k < screen.length; k += 3, ++number) {
      if (screen[k + 2] > 1) continue;
      const away = Math.hypot(screen[k] - x, screen[k + 1] - y) / Math.max(reach_px, this.#view.radiusPx(number));
      if (away < least) [found, least] = [number, away];
    }
    return found;
  }

  #edgeAt(x, y, kind) {
    const {edges} = this.#view.layers;
    if (!edges?.visible) return -1;
    let found = -1, least = EDGE_PX[kind] ?? EDGE_PX.touch;
    edges.edges.forEach((_, index) => {
      const away = this.#distanceToEdge(edges, index, x, y);
      if (away < least) [found, least] = [index, away];
    });
    return found;
  }

  #distanceToEdge(edges, index, x, y) {
    const {screen} = this.#view, [hearer, heard] = edges.edges[index];
    const [ax, ay, az] = screen.subarray(3 * heard - 3), [bx, by, bz] = screen.subarray(3 * hearer - 3);
    if (az > 1 || bz > 1) return Infinity;
    const length = Math.hypot(bx - ax, by - ay) || 1, ux = (bx - ax) / length, uy = (by - ay) / length;
    const along = (x - ax) * ux + (y - ay) * uy;
    if (along < 0 || along > length) return Infinity;
    return Math.abs((x - ax) * uy - (y - ay) * ux - edges.shift(index));  // left of the arrow is up, and y points down
  }

  // --- pointers ---

  #onDown({offsetX: x, offsetY: y, pointerType, pointerId, button, isPrimary}) {
    this.#card.hidden = true;
    if (button !== 0 || !isPrimary || !this.#model.frame) return;
    const agent = this.#agentAt(x, y, pointerType);
    const canGo = agent > 0 && this.#model.agent(agent).goto && this.#model.canChange;
    this.#down = {x, y, at: [x, y], agent, canGo, moved: false, p: agent ? this.#model.vector("p", agent) : null};
    if (!canGo) return;
    this.#view.eye.free = false;
    this.#view.canvas.setPointerCapture(pointerId);
  }

  #onMove(event) {
    const {offsetX: x, offsetY: y, pointerType, buttons} = event;
    if (this.#down && Math.hypot(x - this.#down.x, y - this.#down.y) > STILL_PX) this.#down.moved = true;
    if (this.#down?.canGo && this.#down.moved)
      this.#drag(event);
    else if (buttons === 0 && pointerType === "mouse" && this.#model.frame)
      this.#hover(x, y, pointerType);
  }

  #onUp(event) {
    const down = this.#down, {ghost} = this.#view;
    this.#letGo();
    if (!down) return;
    if (down.canGo && down.moved && ghost)
      this.#send(ghost);
    else if (!down.moved)
      this.#click(event);
  }

  #letGo() {
    this.#down = null;
    this.#view.eye.free = true;
    this.#view.ghost = null;
    this.#view.touch();
  }

  // --- dragging: at its height, with Shift straight up and down; each move goes on from the one before ---

  #drag({offsetX: x, offsetY: y, shiftKey}) {
    const {agent, p, at} = this.#down, p_W = this.#view.ghost?.p ?? p;
    this.#tip.hidden = true;
    this.#view.ghost = {agent, p: shiftKey ? this.#raised(p_W, at[1] - y) : this.#shifted(p_W, at, [x, y])};
    this.#down.at = [x, y];
    this.#view.touch();
  }

  #ray(x, y) {
    const caster = new Raycaster(), {clientWidth, clientHeight} = this.#view.canvas;
    caster.setFromCamera(new Vector2(2 * x / clientWidth - 1, 1 - 2 * y / clientHeight), this.#view.camera);
    return caster.ray;
  }

  #planeAt([x, y], height) {
    return this.#ray(x, y).intersectPlane(new Plane(new Vector3(0, 0, 1), -height), new Vector3());
  }

  // Above the horizon there is no place: a pointer that is there moves nothing.
  #shifted([px, py, pz], last, now) {
    const from = this.#planeAt(last, pz), to = this.#planeAt(now, pz);
    return from && to ? [px + to.x - from.x, py + to.y - from.y, pz] : [px, py, pz];
  }

  // By what these pixels are upright at its place. From above nothing upright is seen; then they count as on the
  // ground.
  #raised([px, py, pz], up_px) {
    const [, foot] = this.#view.toScreen([px, py, pz]), [, head] = this.#view.toScreen([px, py, pz + 1]);
    const px_per_m = Math.max(foot - head, LEAST_UPRIGHT * this.#view.pxPerM());
    return [px, py, Math.max(0, pz + up_px / px_per_m)];
  }

  #send({agent, p}) {
    return this.#asking.event(gotoToml(agent, p), `Send agent ${agent} to ${p.map((x) => fixed(x)).join(", ")} m`);
  }

  // --- pointing and clicking ---

  #hover(x, y, kind) {
    const agent = this.#agentAt(x, y, kind), edge = agent ? -1 : this.#edgeAt(x, y, kind);
    this.#point(agent, edge, [x, y]);
  }

  #point(agent, edge, at) {
    const {pointed, canvas} = this.#view;
    if (pointed.agent !== agent || pointed.edge !== edge) {
      this.#view.pointed = {agent, edge};
      this.#view.takeAgain();
    }
    const words = agent ? this.#agentWords(agent) : edge >= 0 ? this.#edgeWords(edge) : "";
    canvas.style.cursor = words ? (agent && this.#canGo(agent) ? "grab" : "pointer") : "";
    this.#tip.hidden = !words || !at;
    this.#tip.textContent = words;
    if (at) this.#tip.style.transform = `translate(${at[0] + 14}px, ${at[1] + 14}px)`;
  }

  #canGo(number) { return this.#model.agent(number).goto && this.#model.canChange; }

  #agentWords(number) {
    const {model} = this.#model.agent(number);
    return `${["agent " + number, model.replaceAll("_", " "), ...this.#model.rolesOf(number)].join(", ")}${
        this.#canGo(number) ? ": drag it to send it" : ""}`;
  }

  #edgeWords(index) {
    const [hearer, heard] = this.#model.experiment.edges[index], waits = this.#model.pendingEdge(index);
    const action = !this.#model.canChange ? "" : this.#model.edgeWillWork(index) ? ": click to cut" : ": click to mend";
    const pending = waits === null ? "" : waits ? ", will be mended" : ", will be cut";
    return `${hearer} hears ${heard}, ${this.#model.edgeWords(index)}${pending}${action}`;
  }

  #click({offsetX: x, offsetY: y, pointerType}) {
    if (!this.#model.frame) return;
    const agent = this.#agentAt(x, y, pointerType), edge = agent ? -1 : this.#edgeAt(x, y, pointerType);
    if (edge < 0)
      this.#model.select(agent);
    else if (!this.#model.canChange)
      return;
    else if (pointerType === "mouse")
      cutOrMend(this.#asking, this.#model, edge);
    else
      this.#offer(edge, x, y);
  }

  /** A finger hides what it touches: the edge is named first, then cut. */
  #offer(edge, x, y) {
    const words = Object.assign(document.createElement("span"), {textContent: this.#edgeWords(edge).split(":")[0]});
    const button = Object.assign(
        document.createElement("button"),
        {type: "button", textContent: this.#model.edgeWillWork(edge) ? "Cut" : "Mend"});
    button.addEventListener("click", () => {
      this.#card.hidden = true;
      cutOrMend(this.#asking, this.#model, edge);
    });
    this.#card.replaceChildren(words, button);
    this.#card.hidden = false;
    const left = Math.min(x, this.#view.canvas.clientWidth - this.#card.offsetWidth - 8);
    this.#card.style.transform = `translate(${Math.max(8, left)}px, ${y + 12}px)`;
  }
}

/** Asks to cut an edge that works, or to mend one that does not, as it will be by what waits. */
export function cutOrMend(asking, model, index) {
  const [hearer, heard] = model.experiment.edges[index], works = !model.edgeWillWork(index);
  return asking.event(
      edgesToml(works ? "mend" : "cut", [[hearer, heard]]), `${works ? "Mend" : "Cut"} ${heard} → ${hearer}`,
      {index, works});
}

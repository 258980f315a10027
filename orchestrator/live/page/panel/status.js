// What is said about the run as a whole: its name, its state, a lost connection, the wind, the colours of edges, and
// which layers of the view are shown.
import {byId, element, setText} from "../dom.js";
import {figure} from "../numbers.js";

// What an experiment may have, or not.
const HAS = {
  edges: ({edges}) => edges.length > 0,
  range: ({edges, range_m}) => edges.length > 0 && range_m > 0,
  tree: ({agents}) => agents.some(({parent}) => parent > 0),
  cells: ({cells}) => cells.length > 0,
  hulls: ({hulls}) => hulls.length > 0,
  liars: ({agents}) => agents.some(({lies_from_s}) => lies_from_s !== null),
  lost: ({agents}) => agents.some(({lost}) => lost),
  leftOut: ({leaves_out}) => leaves_out
};
// Layer, words, what an experiment must have for it; nothing: it is there in all.
const LAYERS = [
  ["trails", "Trails"], ["edges", "Edges: who hears whom"], ["leftOut", "What laws leave out", HAS.leftOut],
  ["liars", "Who lies", HAS.liars], ["lost", "Who is lost", HAS.lost], ["cells", "Cells of the region", HAS.cells],
  ["hulls", "Hull of the leaders", HAS.hulls], ["numbers", "Numbers"], ["velocity", "Velocity"],
  ["acceleration", "Commanded acceleration"], ["plan", "Waypoints, places, prediction"],
  ["tree", "Tree of pursuit", HAS.tree], ["heights", "Heights"]
];
// Look in the style sheet, words, what an experiment must have.
const LEGEND = [
  ["heard", "heard", HAS.edges], ["lost", "lost", HAS.edges], ["left-out", "left out", HAS.leftOut],
  ["far", "out of range", HAS.range], ["none", "no edge", HAS.edges], ["tree", "pursues", HAS.tree],
  ["cells", "cells", HAS.cells], ["hulls", "hull of leaders", HAS.hulls], ["lies", "lies", HAS.liars],
  ["gone", "agent lost", HAS.lost]
];

export class Status {
  #model;

  constructor(model) {
    this.#model = model;
    for (const kind of ["connection", "experiment", "frame"]) model.on(kind, () => this.#show());
    model.on("experiment", () => this.#onExperiment());
    byId("legend").replaceChildren(
        ...LEGEND.map(([name, words]) => element("span", {}, element("i", {className: `line ${name}`}), words)));
  }

  #show() {
    const {connected, experiment, frame} = this.#model;
    const isOver = frame?.state === "done" || frame?.state === "failed";
    const state = !connected && !isOver ? (experiment ? "lost" : "connecting") : frame?.state ?? "waiting";
    byId("state").dataset.state = state;
    setText(byId("state"), {lost: "no connection", waiting: "waiting"}[state] ?? state);
    byId("watching").hidden = this.#model.maySteer || !experiment;
    byId("banner").hidden = connected || !experiment;
    setText(
        byId("banner"),
        isOver ?
            "The run has ended. This is its last tick; the next run at this address is shown as soon as there is one." :
            "The connection is lost. What you see is the last that came; the page connects again by itself as soon as it can.");
    byId("banner").classList.toggle("calm", isOver);
    byId("empty").hidden = Boolean(frame);
    setText(
        byId("empty-words"),
        connected ? "Connected. The run has not begun yet." :
                    "No run answers at this address yet. The page connects as soon as one does.");
    document.body.classList.toggle("stale", !connected && !isOver);
    byId("survives").hidden = this.#model.survives === "";
    setText(byId("survives"), this.#model.survives);
  }

  #onExperiment() {
    const {experiment, isRecording, loss} = this.#model;
    setText(byId("name"), experiment.name || "MASCOT");
    document.title = `${experiment.name || "run"} – MASCOT`;
    byId("source").hidden = false;
    setText(byId("source"), !isRecording ? experiment.engine : loss ? "recording, cut" : "recording");
    byId("source").title = loss;
    this.#showWind(experiment.wind_m_per_s ?? [0, 0, 0]);
    for (const [name, , isIn] of LEGEND)
      byId("legend").querySelector(`.${name}`).parentElement.hidden = !isIn(experiment);
    byId("legend").hidden = LEGEND.every(([, , isIn]) => !isIn(experiment));
  }

  #showWind([x, y, z]) {
    const speed = Math.hypot(x, y, z);
    byId("wind").hidden = speed === 0;
    setText(byId("wind-words"), `wind ${figure(speed)} m/s`);
  }

  /**
   * Turns the arrow of the wind as the view is turned: `heading` is the direction on the screen of east, in radians.
   */
  turnWind(toScreen, target) {
    const [x, y, z] = this.#model.experiment?.wind_m_per_s ?? [0, 0, 0], speed = Math.hypot(x, y, z);
    if (speed === 0) return;
    const [ax, ay] = toScreen(target),
               [bx, by] = toScreen([target[0] + x / speed, target[1] + y / speed, target[2] + z / speed]);
    byId("wind-arrow").setAttribute("transform", `rotate(${Math.atan2(bx - ax, ay - by) * 180 / Math.PI})`);
  }
}

/** The list of layers that can be shown. */
export class Layers {
  #view;
  #boxes = {};

  constructor(view, list) {
    this.#view = view;
    view.model.on("experiment", ({experiment}) => {
      for (const [name, , isIn] of LAYERS) this.#boxes[name].parentElement.hidden = isIn ? !isIn(experiment) : false;
    });
    for (const [name, words] of LAYERS) {
      const box = element("input", {type: "checkbox", checked: view.shown[name]});
      box.addEventListener("change", () => view.show(name, box.checked));
      this.#boxes[name] = box;
      list.append(element("label", {}, box, words));
    }
  }

  toggle(name) { this.#boxes[name].click(); }
}

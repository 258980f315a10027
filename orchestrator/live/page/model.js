// What the page knows: the experiment, the newest row of the run, its events, and what the viewer has chosen.
// Everything drawn is drawn from here. Numbers of agents begin at 1, indices at 0.

import {incidentsIn} from "./incidents.js";

/** States of an edge in a row. */
export const EDGE = {
  NONE: 0,
  HEARD: 1,
  LOST: 2,
  FAR: 3,
  SILENT: 4,
  UNKNOWN: 5  // of a recording: it is still being found out
};
const EDGE_WORDS = ["no edge now", "heard", "lost", "out of range", "nothing arrived yet", "not known yet"];

/** The axes along which a law does not use what was heard on an edge, from the bits of a row; empty: none. */
const leftOutWords = (bits) =>
    (bits ? `left out along ${["x", "y", "z"].filter((_, k) => bits >> k & 1).join(", ")}` : "");

/** Bits of a command's flags, in words. */
const LIMITS = [
  [1, "acceleration", "accel."], [8, "speed", "speed"], [2, "tilt", "tilt"], [4, "rotors", "rotors"],
  [16, "safety", "safe"], [32, "no safe command", "unsafe"]
];
const limitsOf = (flags) => LIMITS.filter(([bit]) => flags & bit);
export const limitWords = (flags) => limitsOf(flags).map(([, word]) => word).join(", ");
export const shortLimitWords = (flags) => limitsOf(flags).map(([, , word]) => word).join(" ");

export class Model {
  connected = false;
  maySteer = true;  // false: this page only watches
  experiment = null;
  frame = null;
  curves = {rows: []};  // of a run up to when the page was opened, of a recording as far as it has been read
  metrics = {metrics: [], rows: [], error: ""};  // the user's own, each for the run up to a time
  vehicles = [];                                 // of agents that have one: {agent, phase, words}
  events = [];
  #expected = [];     // granted here: {tick, words, toml, edge}
  selected = 0;       // number of an agent, 0: none
  lastAnswer = null;  // the server's last answer: {request, granted, words}
  #session = null;
  #listeners = {};

  /**
   * Calls `listener` after each change of a kind: "connection", "run" (another run, or other agents), "experiment" (a
   *  value of it), "frame", "curves", "metrics", "events", "vehicles", "selected".
   */
  on(kind, listener) { (this.#listeners[kind] ??= []).push(listener); }

  #tell(kind) {
    for (const listener of this.#listeners[kind] ?? []) listener(this);
  }

  get size() { return this.experiment?.agents.length ?? 0; }

  get isRecording() { return this.experiment?.source === "recording"; }

  /** Where time ends: what was planned, of a recording what there is. */
  get end_s() { return this.experiment.recorded?.end_s ?? this.experiment.duration_s; }

  /** Why a recording ends early: it was cut; empty: it is whole. */
  get loss() { return this.experiment?.recorded?.loss ?? ""; }

  /** What a recorded run came up against, but for events: {t_s, words}. */
  get incidents() { return incidentsIn(this.experiment?.recorded?.incidents ?? ""); }

  /** Whether this page may change what it shows: a run that it may steer. */
  get canChange() { return this.maySteer && !this.isRecording; }

  setConnection(connected, session = null, maySteer = this.maySteer) {
    this.maySteer = maySteer;
    if (connected && session !== this.#session) this.#forget();
    if (connected) this.#session = session;
    this.connected = connected;
    this.#tell("connection");
  }

  #forget() {
    this.experiment = this.frame = null;
    this.curves = {rows: []};
    this.metrics = {metrics: [], rows: [], error: ""};
    this.events = [];
    this.vehicles = [];
    this.#expected = [];
  }

  setExperiment(experiment) {
    const isOther = bodiesOf(this.experiment) !== bodiesOf(experiment);
    this.experiment = experiment;
    if (isOther) {
      this.frame = null;
      this.selected = Math.min(this.selected, experiment.agents.length);
      this.#tell("run");
    }
    this.#tell("experiment");
  }

  setFrame(frame) {
    if (!this.experiment || frame.p.length !== 3 * this.size) return;  // a row of a run that is not described yet
    this.frame = frame;
    this.#tell("frame");
  }

  setCurves(curves) {
    this.curves = curves;
    this.#tell("curves");
  }

  setMetrics(metrics) {
    this.metrics = metrics;
    this.#tell("metrics");
  }

  setVehicles(vehicles) {
    this.vehicles = vehicles;
    this.#tell("vehicles");
  }

  setEvents(events) {
    this.events = events;
    this.#tell("events");
  }

  /**
   * An event was granted: it takes effect at a later tick, of which the answer tells. `edge`: {index, works} of an edge
   *  that it cuts or mends.
   */
  expect(toml, words, edge = null) {
    const tick = Number(/tick (\d+)/.exec(words)?.[1] ?? 0);
    this.#expected.push({tick, words, toml, edge});
    this.#tell("events");
  }

  /** What was granted here and has not taken effect yet; all that waits for a tick comes with it. */
  get expected() { return this.#expected.filter(({tick}) => !this.events.some((event) => event.tick >= tick)); }

  /** What waits to become of an edge: true, it will be mended, false, cut; null: nothing waits. */
  pendingEdge(index) { return this.expected.findLast(({edge}) => edge?.index === index)?.edge.works ?? null; }

  /** Whether an edge is there, once all that waits has taken effect. */
  edgeWillWork(index) { return this.pendingEdge(index) ?? this.frame?.edge?.[index] !== EDGE.NONE; }

  select(number) {
    this.selected = number >= 1 && number <= this.size ? number : 0;
    this.#tell("selected");
  }

  agent(number) { return this.experiment?.agents[number - 1]; }

  /** Numbers of the agents of which others hear what is false at the time of the row. */
  get liars() {
    const t_s = this.frame?.t_s ?? -1, lies = ({lies_from_s: from_s}) => from_s !== null && t_s >= from_s - 1e-9;
    return (this.experiment?.agents ?? []).filter(lies).map(({id}) => id);
  }

  /** Numbers of the agents that are lost. */
  get lost() { return (this.experiment?.agents ?? []).filter(({lost}) => lost).map(({id}) => id); }

  /** What is wrong with an agent by faults, in words; empty: nothing. */
  faultsOf(number) { return this.agent(number).faults; }

  /** What the team can still do in spite of what is wrong, in words; empty: nothing is wrong. */
  get survives() {
    const t_s = this.frame?.t_s ?? -1;
    const now = this.experiment?.survives.findLast(({from_s}) => t_s >= from_s - 1e-9);
    return now?.is_wrong ? now.words : "";
  }

  /** What an agent is beside the others: "leads", "lies", "lost". */
  rolesOf(number) {
    const {leads, lost} = this.agent(number);
    return [...(leads ? ["leads"] : []), ...(this.liars.includes(number) ? ["lies"] : []), ...(lost ? ["lost"] : [])];
  }

  /** The number of an agent, and what it is. */
  nameOf(number) { return [number, ...this.rolesOf(number)].join(" "); }

  /** What became of an edge at the tick of the row, in words. */
  edgeWords(index) {
    const words = EDGE_WORDS[this.frame?.edge?.[index] ?? EDGE.UNKNOWN];
    return [words, leftOutWords(this.frame?.left_out?.[index])].filter(Boolean).join(", ");
  }

  /** Three numbers of an agent in a flat array of the row: "p", "v" or "a". */
  vector(name, number) { return this.frame[name].slice(3 * number - 3, 3 * number); }

  /** Edges on which an agent hears: {index, heard, weight, state, words, age_s}. */
  heardBy(number) {
    return this.experiment.edges.flatMap(([hearer, heard, weight], index) => hearer !== number ? [] : [{
                                           index,
                                           heard,
                                           weight,
                                           state: this.frame?.edge?.[index] ?? EDGE.UNKNOWN,
                                           words: this.edgeWords(index),
                                           age_s: this.frame?.age_s?.[index] ?? -1
                                         }]);
  }
}

// Two experiments with the same text here are drawn with the same bodies.
function bodiesOf(experiment) {
  if (!experiment) return "";
  const {name, source, recorded, ticks, edges, agents} = experiment;
  return JSON.stringify(
      [name, source, recorded, ticks, edges.length, agents.map(({rolls, arm_m, size_m}) => [rolls, arm_m, size_m])]);
}

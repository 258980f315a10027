// Time: what it is, how fast it goes, pause, step, stop; of a recording a time line.
import {byId, element, setText} from "../dom.js";
import {exact, fixed, seconds} from "../numbers.js";

const PACES = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100];
const AS_FAST_AS_IT_GOES = 0;
const SEEK_EVERY_MS = 80;
const MOST_MARKS = 150;  // of incidents on the time line; those that are nearer share one
const MOST_WORDS = 5;    // of incidents in the title of a mark

export class Transport {
  #model;
  #asking;
  #isSeeking = false;
  #lastSeek_ms = 0;
  #seeks = 0;     // that are not answered yet
  #aim_s = null;  // where the last one goes, until a row comes after its answer
  #marked = "";

  constructor(model, asking) {
    this.#model = model;
    this.#asking = asking;
    byId("play").addEventListener("click", () => this.playOrPause());
    byId("step").addEventListener("click", () => this.step());
    byId("stop").addEventListener("click", () => byId("confirm").showModal());
    byId("confirm-no").addEventListener("click", () => byId("confirm").close());
    byId("confirm-yes").addEventListener("click", () => this.#stop());
    byId("pace").addEventListener("change", ({target}) => this.#setPace(Number(target.value)));
    byId("seek").addEventListener("input", () => this.#onSeek(false));
    byId("seek").addEventListener("change", () => this.#onSeek(true));
    model.on("frame", () => this.#onFrame());
    for (const kind of ["connection", "vehicles"]) model.on(kind, () => this.#enable());
    model.on("experiment", () => this.#onExperiment());
    model.on("events", () => this.#mark());
  }

  // --- what can be asked ---

  playOrPause() {
    const {frame} = this.#model;
    return frame && this.#asking.ask({ask: frame.state === "running" ? "pause" : "resume"});
  }

  step(count = 1) { return this.#asking.ask({ask: "step", count}); }

  /** The next slower (-1) or faster (+1) pace of the list. */
  changePace(by) {
    const now = this.#model.frame?.pace ?? 1;
    const next = by > 0 ? PACES.find((pace) => pace > now) : PACES.findLast((pace) => pace < now);
    if (next !== undefined) this.#setPace(next);
  }

  seekBy(by_s) {
    const {frame} = this.#model;
    return frame && this.seek(Math.max(0, Math.min(this.#model.end_s, (this.#aim_s ?? frame.t_s) + by_s)));
  }

  async seek(t_s) {
    this.#aim_s = t_s;
    ++this.#seeks;
    await this.#asking.ask({ask: "seek", t_s});
    --this.#seeks;
  }

  async #setPace(value) {
    await this.#asking.ask({ask: "pace", value});
    this.#showPace();  // a refused pace goes back to what it is
  }

  #stop() {
    byId("confirm").close();
    return this.#asking.ask({ask: "stop"}, "Stop the run");
  }

  // While the handle is held, some of its places are asked for; where it is let go, always.
  #onSeek(isLast) {
    const t_s = Number(byId("seek").value), now = performance.now();
    this.#isSeeking = !isLast;
    if (!isLast && now - this.#lastSeek_ms < SEEK_EVERY_MS) return;
    this.#lastSeek_ms = now;
    this.seek(t_s);
  }

  // --- what is shown ---

  #onExperiment() {
    const {experiment, isRecording, end_s} = this.#model;
    byId("seek").hidden = !isRecording;
    byId("seek").max = end_s;
    byId("stop").hidden = isRecording;
    setText(byId("pace-label"), isRecording ? "Speed" : "Pace");
    const planned = end_s < experiment.duration_s ? ` of ${seconds(experiment.duration_s)}` : "";
    setText(byId("duration"), `/ ${seconds(end_s)}${planned}`);
    const paces =
        [...PACES.map((pace) => [pace, `× ${exact(pace)}`]), ...(isRecording ? [] : [[AS_FAST_AS_IT_GOES, "fastest"]])];
    byId("pace").replaceChildren(...paces.map(([value, textContent]) => element("option", {value, textContent})));
    this.#showPace();
    this.#mark();
  }

  #onFrame() {
    const {frame, end_s} = this.#model;
    if (this.#seeks === 0) this.#aim_s = null;
    const isRunning = frame.state === "running";
    setText(byId("time"), seconds(frame.t_s));
    setText(byId("tick"), `tick ${frame.tick}`);
    setText(byId("factor"), isRunning ? `${fixed(frame.real_time_factor)} × real time` : "");
    setText(byId("play-words"), isRunning ? "Pause" : this.#model.isRecording ? "Play" : "Resume");
    byId("play").dataset.running = isRunning;
    this.#enable();
    byId("progress").style.width = `${100 * Math.min(1, frame.t_s / end_s)}%`;
    if (!this.#isSeeking) byId("seek").value = frame.t_s;
    if (document.activeElement !== byId("pace")) this.#showPace();
  }

  // What cannot be asked for now is grey.
  #enable() {
    const {connected, frame, isRecording, maySteer, vehicles} = this.#model;
    const isOver = frame?.state === "done" || frame?.state === "failed";
    const canGoOn = connected && maySteer && (!isOver || isRecording);
    byId("play").disabled = byId("step").disabled = byId("pace").disabled = byId("seek").disabled = !canGoOn;
    if (vehicles.length > 0 && !isRecording)
      byId("play").disabled = byId("step").disabled = true;  // vehicles cannot wait
    byId("stop").disabled = !connected || !maySteer || isOver;
  }

  #showPace() {
    const pace = this.#model.frame?.pace ?? 1, select = byId("pace");
    if (![...select.options].some(({value}) => Number(value) === pace))
      select.append(element("option", {value: pace, textContent: `× ${exact(pace)}`}));
    select.value = String(pace);
  }

  #mark() {
    const {events, incidents, experiment, end_s} = this.#model;
    if (!experiment) return;
    const marks = [
      ...thinned(incidents, end_s).map(incidentMark),
      ...events.map(({t_s, number, toml, by_hand}) => ({
                      t_s,
                      title: `event ${number}${by_hand ? " by hand" : ""}\n${toml}`,
                      className: [...(by_hand ? ["by-hand"] : []), ...(isFault(toml) ? ["fault"] : [])].join(" ")
                    }))
    ];
    if (JSON.stringify(marks) === this.#marked) return;
    this.#marked = JSON.stringify(marks);
    byId("marks").replaceChildren(...marks.map(({t_s, title, className}) => {
      const mark = element("i", {title, className});
      mark.style.left = `${100 * t_s / end_s}%`;
      mark.addEventListener("click", () => this.#model.isRecording && this.seek(t_s));
      return mark;
    }));
  }
}

/** Whether an event lets something go wrong, or ends it: its text has a line for that. */
const isFault = (toml) => /^(fault|restart) = /m.test(toml);

/** Incidents in groups, in order of time: those of the same part of the time line are one. */
function thinned(incidents, end_s) {
  const groups = new Map();
  for (const incident of incidents) {
    const part = Math.floor(MOST_MARKS * incident.t_s / end_s);
    groups.set(part, [...(groups.get(part) ?? []), incident]);
  }
  return [...groups.values()];
}

function incidentMark(group) {
  const lines = group.slice(0, MOST_WORDS).map(({t_s, words}) => `${seconds(t_s)}: ${words}`);
  if (group.length > MOST_WORDS) lines.push(`and ${group.length - MOST_WORDS} more until ${seconds(group.at(-1).t_s)}`);
  return {t_s: group[0].t_s, title: lines.join("\n"), className: "incident"};
}

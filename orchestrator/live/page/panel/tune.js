// The live keys: a control for each, with its range and unit. A control asks when it is let go, and shows what the
// server says the value is, whatever was asked for.
import {setToml} from "../asking.js";
import {byId, element, setText} from "../dom.js";
import {exact, rounded, typeset} from "../numbers.js";

import {Scale} from "./scale.js";

const MOST_OWN = 3;  // agents whose own values are listed below a control

export class Tune {
  #model;
  #asking;
  #controls = new Map();  // key -> {row, show}
  #drawn = "";

  constructor(model, asking) {
    this.#model = model;
    this.#asking = asking;
    model.on("experiment", () => this.#onExperiment());
    model.on("selected", () => this.#nameTarget());
  }

  #onExperiment() {
    const keys = (this.#model.experiment.live_keys ?? []).filter(({key}) => key !== "run.pace");  // has its own control
    const wanted = JSON.stringify(keys.map(({value, ...key}) => ({...key, control: controlOf({...key, value})}))) +
        this.#model.canChange;
    if (wanted !== this.#drawn) this.#make(sorted(keys));
    this.#drawn = wanted;
    this.#showAll();
  }

  // What the controls are for: the team, or the chosen agent alone, which may have a value of its own.
  #showAll() {
    for (const {key, value, own} of this.#model.experiment?.live_keys ?? []) {
      const ownHere = this.#isForOne ? own.find(({agent}) => agent === this.#model.selected) : null;
      this.#controls.get(key)?.show(ownHere ? ownHere.value : value);
      this.#controls.get(key)?.showOwn(own);
    }
  }

  get #isForOne() { return Boolean(this.only?.checked); }

  #make(keys) {
    this.#controls.clear();
    this.only = this.onlyLabel = null;
    const hint = (textContent) => element("p", {className: "muted hint", textContent});
    if (this.#model.isRecording) return this.#list(keys, hint("A recording cannot be changed. At this time it has:"));
    if (!this.#model.maySteer) return this.#list(keys, hint("This page only watches. At this time the run has:"));
    if (keys.length === 0)
      return byId("tune").replaceChildren(hint("This run has no keys that can be changed while it goes on."));
    this.only = element("input", {type: "checkbox", id: "tune-only"});
    this.only.addEventListener("change", () => this.#showAll());
    this.onlyLabel = element("label", {className: "only", htmlFor: "tune-only"}, this.only, element("span"));
    byId("tune").replaceChildren(this.onlyLabel, ...keys.map((key) => this.#row(key)));
    this.#nameTarget();
  }

  // What the keys are, to be read only.
  #list(keys, hint) {
    const rows = keys.map(({key, unit}) => {
      const value = element("b"), own = ownValues();
      this.#controls.set(key, {show: (now) => setText(value, now === null ? "–" : show(now)), showOwn: own.show});
      const row = element(
          "div", {className: "reading"}, key, value, element("small", {className: "muted"}, typeset(unit)), own.body);
      row.dataset.key = key;
      return row;
    });
    byId("tune").replaceChildren(hint, ...rows);
  }

  #nameTarget() {
    if (!this.onlyLabel) return;
    const {selected} = this.#model;
    this.only.disabled = !selected;
    if (!selected) this.only.checked = false;
    this.#showAll();
    setText(this.onlyLabel.lastChild, selected ? `only for agent ${selected}` : "only for one agent: choose it first");
  }

  #row(key) {
    const words = element("p", {className: "refusal", role: "alert"});
    const ask = (value) => this.#ask(key, value, words);
    const {body, show} = CONTROLS[controlOf(key)](key, ask);
    const name = element(
        "label", {title: key.meaning ?? "", htmlFor: `key-${key.key}`}, key.key,
        element("small", {className: "muted", textContent: key.unit ? ` ${typeset(key.unit)}` : ""}));
    const own = ownValues();
    this.#controls.set(key.key, {show, showOwn: own.show});
    const row = element("div", {className: "key"}, name, ...body, own.body, words);
    row.dataset.key = key.key;
    return row;
  }

  async #ask({key, unit}, value, words) {
    const agents = this.#isForOne ? [this.#model.selected] : [];
    const answer = await this.#asking.event(
        setToml(key, value, agents), `${key} = ${show(value)}${unit ? ` ${typeset(unit)}` : ""}`);
    setText(words, answer.granted ? "" : answer.words);
    if (!answer.granted) this.#showAll();
  }
}

/** What is tuned most comes first: what the law has, then what else there is; last, what the experiment leaves out. */
function sorted(keys) {
  const rank = ({key, value}) => 2 * (value === null) + !key.startsWith("law.");
  return keys.toSorted((a, b) => rank(a) - rank(b));
}

/** A value in words: numbers as they were set, a list of points as such. */
const show = (value) =>
    (typeof value === "number" ? exact(value) :
         Array.isArray(value)  ? value.map((x) => (Array.isArray(x) ? `(${show(x)})` : show(x))).join(", ") :
                                                                      String(value));

/** A line below a control: the values that agents have of their own, which events with `agents` and drags give them. */
function ownValues() {
  const body = element("p", {className: "own", hidden: true});
  return {
    body,
    show(own) {
      const named = own.slice(0, MOST_OWN).map(({agent, value}) => `agent ${agent}: ${show(value)}`);
      if (own.length > MOST_OWN) named.push(`and ${own.length - MOST_OWN} more`);
      body.hidden = own.length === 0;
      setText(body, named.join("; "));
    }
  };
}

const idOf = ({key}) => `key-${key}`;
const boundsOf = ({min, max, open_min}) => ({low: `${open_min ? "> " : ""}${exact(min)}`, high: exact(max)});

// --- a control for each kind of value: what is shown, and a function that takes the value ------------------

function number(key, ask) {
  const scale = new Scale(key), {low, high} = boundsOf(key);
  const slider =
      element("input", {type: "range", min: 0, max: Scale.STEPS, step: 1, id: idOf(key), "aria-label": key.key});
  const box =
      element("input", {type: "number", step: "any", placeholder: "not given", "aria-label": `${key.key}, value`});
  slider.addEventListener("input", () => {
    box.value = scale.value(Number(slider.value));
  });
  slider.addEventListener("change", () => ask(scale.value(Number(slider.value))));
  box.addEventListener("change", () => box.value !== "" && ask(Number(box.value)));
  let latest = key.value;
  const showInBox = () => {
    box.value = latest === null ? "" : rounded(latest);
  };
  box.addEventListener("blur", showInBox);
  return {
    body: [
      element("div", {className: "slide"}, slider, box),
      element(
          "div", {className: "bounds muted"}, element("span", {textContent: low}), element("span", {textContent: high}))
    ],
    show(value) {
      latest = value;
      if (document.activeElement !== box) showInBox();
      if (!slider.matches(":active")) slider.value = scale.place(value ?? key.min);
      slider.setAttribute(
          "aria-valuetext", value === null ? "not given" : `${exact(value)} ${typeset(key.unit ?? "")}`);
    },
  };
}

function boolean(key, ask) {
  const box = element("input", {type: "checkbox", id: idOf(key), role: "switch"});
  box.addEventListener("change", () => ask(box.checked));
  return {
    body: [box],
    show: (value) => {
      box.checked = value;
    }
  };
}

function oneOf(key, ask) {
  const select = element(
      "select", {id: idOf(key)}, ...key.names.map((name) => element("option", {value: name, textContent: name})));
  select.addEventListener("change", () => ask(select.value));
  return {
    body: [select],
    show: (value) => {
      select.value = value;
    }
  };
}

function vector3(key, ask) {
  const boxes = ["x", "y", "z"].map(
      (axis, k) => element(
          "input", {type: "number", step: "any", "aria-label": `${key.key}, ${axis}`, ...(k ? {} : {id: idOf(key)})}));
  for (const box of boxes)
    box.addEventListener(
        "change", () => boxes.every(({value}) => value !== "") && ask(boxes.map(({value}) => Number(value))));
  return {
    body: [element("div", {className: "vector"}, ...boxes)],
    show: (value) => boxes.forEach((box, k) => {
      if (document.activeElement !== box) box.value = value === null ? "" : rounded(value[k]);
    }),
  };
}

const shortly = (_key, value) => (typeof value === "number" ? rounded(value) : value);

/** Any other value, as JSON, which TOML reads alike for numbers, texts and lists of them. */
function other(key, ask) {
  const box = element("input", {type: "text", id: idOf(key), spellcheck: false, placeholder: "not given"});
  box.addEventListener("change", () => {
    try {
      ask(JSON.parse(box.value));
      box.setCustomValidity("");
    } catch {
      box.setCustomValidity("expected a number, a \"text\" or a list [a, b, ...]");
      box.reportValidity();
    }
  });
  return {
    body: [box],
    show: (value) => {
      if (document.activeElement !== box) box.value = (value ?? null) === null ? "" : JSON.stringify(value, shortly);
    }
  };
}

const CONTROLS = {
  number,
  integer: number,
  boolean,
  one_of: oneOf,
  vector3,
  other
};

/** A number for each agent, where one for all would do, is no position on a slider. */
function controlOf({kind, value}) {
  return !(kind in CONTROLS) || Array.isArray(value) && kind !== "vector3" ? "other" : kind;
}

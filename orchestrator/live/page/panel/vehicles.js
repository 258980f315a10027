// The vehicles that agents fly: where each is in its flight, and what somebody may ask of them.
import {element, setText} from "../dom.js";

// Phases in which a vehicle can be asked to land.
const IN_THE_AIR = ["streaming", "armed", "taking off", "ready", "flying"];

export class Vehicles {
  #model;
  #asking;
  #box;
  #list = element("ul", {className: "vehicles"});
  #start = element("button", {type: "button", className: "small", textContent: "Take off"});
  #land = element("button", {type: "button", className: "small", textContent: "Land all"});

  constructor(model, asking, box) {
    this.#model = model;
    this.#asking = asking;
    this.#box = box;
    this.#start.title = "All vehicles arm, take off, and fly to their starts";
    this.#start.addEventListener("click", () => asking.ask({ask: "start"}, "Take off"));
    this.#land.addEventListener("click", () => asking.ask({ask: "land", agent: 0}, "Land all"));
    box.append(
        element("h2", {}, "Vehicles ", element("span", {className: "row"}, this.#start, this.#land)), this.#list);
    for (const kind of ["connection", "experiment", "vehicles"]) model.on(kind, () => this.#show());
  }

  #show() {
    const {vehicles, canChange} = this.#model, isIn = (phases) => vehicles.some(({phase}) => phases.includes(phase));
    this.#box.hidden = vehicles.length === 0;
    this.#start.hidden = !canChange || !isIn(["found"]);
    this.#land.hidden = !canChange || !isIn(IN_THE_AIR);
    while (this.#list.children.length > vehicles.length) this.#list.lastChild.remove();
    for (const [i, vehicle] of vehicles.entries()) this.#showOne(this.#list.children[i] ?? this.#newRow(), vehicle);
  }

  #newRow() {
    const land = element("button", {type: "button", className: "small", textContent: "Land"});
    const row = element(
        "li", {}, element("b"), element("span", {className: "phase"}), element("span", {className: "said"}), land);
    land.addEventListener("click", () => {
      const agent = Number(row.dataset.agent);
      this.#asking.ask({ask: "land", agent}, `Land ${agent}`);
    });
    this.#list.append(row);
    return row;
  }

  #showOne(row, {agent, phase, words}) {
    const [number, state, said, land] = row.children;
    row.dataset.agent = agent;
    row.dataset.phase = phase;
    setText(number, String(agent));
    setText(state, phase);
    setText(said, words.startsWith(`${phase}: `) ? words.slice(phase.length + 2) : words === phase ? "" : words);
    said.title = said.textContent;
    land.hidden = !this.#model.canChange || !IN_THE_AIR.includes(phase);
  }
}

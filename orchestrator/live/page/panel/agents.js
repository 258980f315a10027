// The table of agents, of which only the rows in sight exist, and all about the selected one.
import {agentColours} from "../colours.js";
import {byId, element, setText, throttled} from "../dom.js";
import {EDGE, limitWords, shortLimitWords} from "../model.js";
import {exact, fixed, seconds} from "../numbers.js";
import {cutOrMend} from "../scene/hand.js";

import {FaultMenu} from "./faults.js";
import {replayCommands} from "./replay.js";

const ROW_PX = 28;
const UPDATE_EVERY_MS = 150;
const COLUMNS = [["agent", ""], ["x", "m"], ["y", "m"], ["z", "m"], ["speed", "m/s"], ["limits", ""]];

export class Agents {
  #model;
  #asking;
  #rows = [];
  #spacer = element("div", {className: "spacer", role: "presentation"});
  #colours = [];
  #update = throttled(UPDATE_EVERY_MS, () => this.#fill());
  #detail;

  constructor(model, asking) {
    this.#model = model;
    this.#asking = asking;
    this.#detail = new Detail(model, asking);
    byId("table").addEventListener("scroll", () => this.#fill());
    byId("table").addEventListener("click", ({target}) => this.#onClick(target));
    new ResizeObserver(() => this.#fill()).observe(byId("table"));
    model.on("run", () => this.paint());
    model.on("experiment", () => this.#update());
    model.on("frame", () => this.#update());
    model.on("selected", () => this.#onSelected());
  }

  paint() {
    this.#colours = agentColours(this.#model.size);
    const head = element(
        "div", {className: "row head", role: "row"},
        ...COLUMNS.map(
            ([name, unit]) =>
                element("span", {role: "columnheader"}, name, element("small", {textContent: unit && ` ${unit}`}))));
    this.#rows = [];
    this.#spacer.style.height = `${ROW_PX * this.#model.size}px`;
    this.#spacer.replaceChildren();
    byId("table").replaceChildren(head, this.#spacer);
    this.#fill();
  }

  #onClick(target) {
    const row = target.closest("[data-agent]");
    if (row) this.#model.select(Number(row.dataset.agent));
  }

  #onSelected() {
    const {selected} = this.#model, table = byId("table");
    if (selected) {
      const top = ROW_PX * (selected - 1), room = table.clientHeight - 2 * ROW_PX;
      if (top < table.scrollTop || top > table.scrollTop + room) table.scrollTop = top - room / 2;
    }
    this.#fill();
  }

  #fill() {
    const {frame, size} = this.#model, table = byId("table");
    this.#detail.update();
    if (!frame || byId("agents").hidden) return;
    const first = Math.max(0, Math.floor(table.scrollTop / ROW_PX) - 2);
    const wanted = Math.max(0, Math.min(size - first, Math.ceil(table.clientHeight / ROW_PX) + 4));
    while (this.#rows.length < wanted) this.#rows.push(this.#spacer.appendChild(newRow()));
    while (this.#rows.length > wanted) this.#rows.pop().remove();
    this.#rows.forEach((row, k) => this.#fillRow(row, first + k));
  }

  #fillRow(row, index) {
    const {frame, selected} = this.#model, number = index + 1;
    row.dataset.agent = number;
    row.style.transform = `translateY(${ROW_PX * index}px)`;
    row.setAttribute("aria-selected", number === selected);
    row.classList.toggle("lost", this.#model.agent(number).lost);
    row.title = this.#model.faultsOf(number).join("; ");
    const [name, ...cells] = row.children;
    name.firstChild.style.background = this.#colours[index];
    setText(name.lastChild, this.#model.nameOf(number));
    const values = [...this.#model.vector("p", number), frame.speed_m_per_s[index]].map((x) => fixed(x));
    [...values, shortLimitWords(frame.flags[index])].forEach((text, k) => setText(cells[k], text));
    cells.at(-1).title = limitWords(frame.flags[index]);
  }
}

function newRow() {
  const name = element("span", {role: "cell"}, element("i", {className: "dot"}), element("span"));
  return element(
      "div", {className: "row", role: "row"}, name, ...COLUMNS.slice(1).map(() => element("span", {role: "cell"})));
}

// --- the selected agent ------------------------------------------------------------------------------------

class Detail {
  #model;
  #asking;
  #menu;
  #drawn = "";  // what the elements are made for
  #values = {};
  #wrong = null;  // what is wrong with the agent
  #heard = [];

  constructor(model, asking) {
    this.#model = model;
    this.#asking = asking;
    this.#menu = new FaultMenu(model, asking, byId("faults"));
  }

  update() {
    const {selected, frame, experiment} = this.#model;
    if (!experiment || !frame || byId("agents").hidden) return;
    const {law} = this.#model.agent(selected) ?? {};  // an event may change it, and who leads
    const wanted = [
      experiment.edges.length, experiment.name, law, selected && this.#model.nameOf(selected), this.#model.canChange
    ].join(" ");
    if (wanted !== this.#drawn) this.#make(selected);
    this.#drawn = wanted;
    if (selected) this.#fill(selected);
  }

  #make(selected) {
    if (!selected)
      return byId("detail").replaceChildren(element(
          "p", {className: "muted hint"},
          "Click an agent, in the view or in the table, to see its state, its command, its limits and its neighbours."));
    const agent = this.#model.agent(selected);
    const title = element("h3", {}, element("i", {className: "dot"}), `Agent ${selected}`, element("small", {
                            className: "muted",
                            textContent: ` ${agent.model.replaceAll("_", " ")}, ${agent.law}${
                                this.#model.rolesOf(selected).map((role) => `, ${role}`).join("")}`
                          }));
    title.firstChild.style.background = agentColours(this.#model.size)[selected - 1];
    if (this.#menu.isOffered) title.append(this.#faultButton(selected));
    this.#wrong = element("p", {className: "wrong"});
    const list = element("dl");
    this.#values =
        Object.fromEntries(["position", "velocity", "attitude", "commands", "actuators", "limits"].map((name) => {
          const value = element("dd");
          list.append(element("dt", {textContent: name}), value);
          return [name, value];
        }));
    const what = element("small", {className: "muted", textContent: agent.actuator});
    this.#values.actuators.after(element("dt"), element("dd", {}, what));
    const heard = element("div", {className: "heard"});
    this.#heard = this.#model.heardBy(selected).map((edge) => heard.appendChild(this.#heardRow(edge)));
    if (this.#heard.length === 0) heard.append(element("p", {className: "muted", textContent: "hears nobody"}));
    const {run} = this.#model.experiment.recorded ?? {};
    byId("detail").replaceChildren(
        title, this.#wrong, list, element("h4", {textContent: "hears"}), heard,
        ...run ? replayCommands(run, selected) : []);
  }

  #faultButton(selected) {
    const button = element("button", {type: "button", className: "small", id: "fault-open", textContent: "Fault …"});
    button.title = "Let something go wrong with this agent";
    button.addEventListener("click", () => this.#menu.open(selected));
    return button;
  }

  #heardRow({index, heard, weight}) {
    const button = element("button", {type: "button", className: "small"});
    button.addEventListener("click", () => cutOrMend(this.#asking, this.#model, index));
    button.hidden = !this.#model.canChange;
    return element(
        "div", {className: "ear"}, element("i", {className: "state"}), element("span", {textContent: `agent ${heard}`}),
        element("span", {className: "muted", textContent: weight === 1 ? "" : `weight ${exact(weight)}`}),
        element("span", {className: "words"}), button);
  }

  #fill(selected) {
    const {frame} = this.#model, vector = (name) => this.#model.vector(name, selected).map((x) => fixed(x)).join("  ");
    const actuators = frame.u.slice(4 * selected - 4, 4 * selected);
    const isLost = this.#model.lost.includes(selected), flags = isLost ? 0 : frame.flags[selected - 1];
    const texts = {
      position: `${vector("p")} m`,
      velocity: `${vector("v")} m/s`,
      attitude: attitude(frame.q.slice(4 * selected - 4, 4 * selected)),
      commands: isLost ? "none" : `${vector("a")} m/s²`,
      actuators: isLost ? "none commanded" : actuators.map((x) => fixed(x)).join("  "),
      limits: isLost ? "–" : limitWords(flags) || "none reached",
    };
    for (const [name, text] of Object.entries(texts)) setText(this.#values[name], text);
    setText(this.#wrong, this.#model.faultsOf(selected).join("; "));
    this.#values.limits.classList.toggle("warn", flags !== 0);
    this.#model.heardBy(selected).forEach((edge, k) => this.#fillHeard(this.#heard[k], edge));
  }

  #fillHeard(row, {state, words, age_s}) {
    row.dataset.state = state;
    setText(row.querySelector(".words"), `${words}${age_s >= 0 ? `, ${seconds(age_s)} old` : ""}`);
    setText(row.lastChild, state === EDGE.NONE ? "Mend" : "Cut");
  }
}

/** Roll, pitch and yaw in degrees of a unit quaternion (w, x, y, z). */
function attitude([w, x, y, z]) {
  const roll = Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y));
  const pitch = Math.asin(Math.max(-1, Math.min(1, 2 * (w * y - z * x))));
  const yaw = Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z));
  return [["roll", roll], ["pitch", pitch], ["yaw", yaw]]
      .map(([name, a]) => `${name} ${fixed(a * 180 / Math.PI, 1)}°`)
      .join("  ");
}

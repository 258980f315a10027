// The page of a live view or of a recording: puts the parts together. `window.mascot` says what the page shows, for
// tests and for the curious.
import {Asking} from "./asking.js";
import {isDark, setScheme} from "./colours.js";
import {Connection, parse} from "./connection.js";
import {byId} from "./dom.js";
import {Model} from "./model.js";
import {Agents} from "./panel/agents.js";
import {Charts} from "./panel/charts.js";
import {Events} from "./panel/events.js";
import {bindKeys, fillHelp} from "./panel/keys.js";
import {Notices} from "./panel/notices.js";
import {Results} from "./panel/results.js";
import {Layers, Status} from "./panel/status.js";
import {bindTabs} from "./panel/tabs.js";
import {Transport} from "./panel/transport.js";
import {Tune} from "./panel/tune.js";
import {Vehicles} from "./panel/vehicles.js";
import {Hand} from "./scene/hand.js";
import {places} from "./scene/overlay.js";
import {View} from "./scene/view.js";

const model = new Model();
let newestRow = null;  // bytes of a row that nobody has looked at: only the newest is worth reading

const prefersDark = matchMedia("(prefers-color-scheme: dark)");
setScheme(prefersDark.matches ? "dark" : "light");

// Who may steer, where not all may, has a token behind the address.
const token = new URLSearchParams(location.hash.slice(1)).get("steer");
const connection = new Connection(
    `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/${
        token ? `?steer=${encodeURIComponent(token)}` : ""}`,
    {
      "/ui/experiment": (bytes) => model.setExperiment(parse(bytes)),
      "/ui/events": (bytes) => model.setEvents(parse(bytes)),
      "/ui/curves": (bytes) => model.setCurves(parse(bytes)),
      "/ui/metrics": (bytes) => model.setMetrics(parse(bytes)),
      "/ui/vehicles": (bytes) => model.setVehicles(parse(bytes)),
      "/ui/frame": (bytes) => {
        newestRow = bytes;
      },
    },
    (state, session, maySteer) => model.setConnection(state === "open", session, maySteer));

/** The view; without WebGL there is no page, and it says so. */
function makeView() {
  try {
    return new View(byId("scene"), byId("overlay"), model);
  } catch (error) {
    byId("empty-words").textContent = "The view needs WebGL, which this browser does not give to this page.";
    throw error;
  }
}

const notices = new Notices(byId("notices"));
const asking = new Asking(connection, model, notices);
const view = makeView();
const status = new Status(model);
const transport = new Transport(model, asking);
const charts = new Charts(model);
const agents = new Agents(model, asking);
const tune = new Tune(model, asking);
const events = new Events(model, notices);
const results = new Results(model);
const vehicles = new Vehicles(model, asking, byId("vehicles"));
const hand = new Hand(view, asking, byId("tip"), byId("card"));
const layers = new Layers(view, byId("layer-list"));

// --- view ---

function follow() {
  view.eye.follow(view.eye.followed === model.selected ? 0 : model.selected);
  view.takeAgain();
}
byId("view-fit").addEventListener("click", () => view.fit());
byId("view-top").addEventListener("click", () => view.top());
byId("view-follow").addEventListener("click", follow);
addEventListener("pointerdown", ({target}) => {
  if (!byId("layers").contains(target)) byId("layers").open = false;
}, true);
model.on("selected", () => view.eye.followed && view.eye.follow(model.selected));

// --- colours ---

function paint() {
  view.paint();
  charts.paint();
  agents.paint();
}
prefersDark.addEventListener("change", ({matches}) => {
  setScheme(matches ? "dark" : "light");
  paint();
});
byId("theme").addEventListener("click", () => {
  setScheme(isDark() ? "light" : "dark");
  paint();
});

// --- keys ---

fillHelp(byId("help"));
byId("help-open").addEventListener("click", () => byId("help").showModal());
bindTabs(document.querySelector("[role=tablist]"), () => agents.paint());
bindKeys({model, view, transport, follow, layers});

// --- pictures ---

function picture(now_ms) {
  if (newestRow) {
    const row = newestRow;
    newestRow = null;
    model.setFrame(parse(row));
  }
  view.draw(now_ms);
  status.turnWind((p) => view.toScreen(p), view.eye.target.toArray());
  byId("view-follow").setAttribute("aria-pressed", view.eye.followed > 0);
  byId("view-follow").disabled = !model.selected;
  requestAnimationFrame(picture);
}
requestAnimationFrame(picture);

/** What a layer of areas has drawn; null: it is not there, or not shown. */
function drawnBy(name) {
  const layer = view.layers[name];
  return layer?.visible ? layer.drawn : null;
}

/**
 * What the page shows and knows. Positions are flat, by agent; places on the screen are [x, y] in pixels of the view.
 */
window.mascot = {
  get connected() { return model.connected; },
  get experiment() { return model.experiment; },
  get state() { return model.frame?.state ?? null; },
  get tick() { return model.frame?.tick ?? -1; },
  get t_s() { return model.frame?.t_s ?? null; },
  get pace() { return model.frame?.pace ?? null; },
  get positions() { return model.frame?.p ?? []; },
  get edgeStates() { return model.frame?.edge ?? []; },
  get events() { return model.events; },
  get vehicles() { return model.vehicles; },              // {agent, phase, words}
  get leftOut() { return model.frame?.left_out ?? []; },  // by edge: bit k for axis k
  get liars() { return model.liars; },                    // numbers of agents
  get lost() { return model.lost; },
  get cells() { return drawnBy("cells"); },  // {agent, corners [x, y]}
  get hulls() { return drawnBy("hulls"); },  // lists of points [x, y, z]
  get texts() { return view.texts; },        // {text, box: [left, top, right, bottom]}
  get selected() { return model.selected; },
  get followed() { return view.eye.followed; },
  get lastAnswer() { return model.lastAnswer; },
  get drawn() {
    return {
      agents: view.layers.bodies?.radii_m.length ?? 0,
      edges: view.layers.edges?.count ?? 0,
      trails: view.layers.trails?.count ?? 0,
      ...charts.drawn,
      pictures: view.renders
    };
  },
  placeOf: (number) => places(model.experiment.agents, model.frame.p).find(([, id]) => id === number)[0],
  agentOnScreen: (number) => [...view.screen.subarray(3 * number - 3, 3 * number - 1)],
  radiusOnScreen: (number) => view.radiusPx(number),
  edgeOnScreen(index) {  // its middle
    const [hearer, heard] = model.experiment.edges[index], a = this.agentOnScreen(heard),
                   b = this.agentOnScreen(hearer);
    const away = view.layers.edges.shift(index), length = Math.hypot(b[0] - a[0], b[1] - a[1]) || 1;
    return [(a[0] + b[0]) / 2 + away * (b[1] - a[1]) / length, (a[1] + b[1]) / 2 - away * (b[0] - a[0]) / length];
  },
  edgeLook: (index) => view.layers.edges.look(index),
  pixels: () => view.pixels(),
  fit: () => view.fit(),
  top: () => view.top(),
};

// The page on a real run, eight agents over DDS in lockstep, and on a real recording, in a real browser.
import assert from "node:assert/strict";

import {launch, open} from "./browser.mjs";
import {clickEdge, drag, edgeInTheOpen, edgeShowsAs, pausedFromAbove, until} from "./hand.mjs";
import {startRecording, startRun, startRunOf, switchOnPx4, textOf} from "./real_run.mjs";
import {test} from "./waits.mjs";

/** What follows each other on one run, which `body` functions get with its page. */
const TOUCHES = {
  async "its agents move, on the page and in its pixels"({page}) {
    const seen = await page.evaluate(() => {
      globalThis.seen = mascot.pixels();
      return {tick: mascot.tick, p: mascot.positions};
    });
    await until(page, (tick) => mascot.tick > tick + 50, seen.tick);
    await until(page, () => mascot.edgeStates.every((state) => state === 1));
    const {drawn, experiment, moved, changed} = await page.evaluate((p) => {
      const {data} = mascot.pixels(), changed = data.filter((x, k) => x !== globalThis.seen.data[k]).length;
      const moved = mascot.positions.some((x, k) => Math.abs(x - p[k]) > 0.01);
      return {drawn: mascot.drawn, experiment: mascot.experiment, moved, changed};
    }, seen.p);
    assert.equal(drawn.agents, 8);
    assert.equal(drawn.edges, 7);
    assert.ok(moved, "positions stay");
    assert.ok(changed > 200, `${changed} bytes of the picture have changed`);
    assert.equal(experiment.name, "watched");
    assert.deepEqual(experiment.agents.filter(({leads}) => leads).map(({id}) => id), [1]);
  },
  async "pause stops time, a step is one tick, and resume goes on"({page}) {
    await pausedFromAbove(page);
    const tick = await page.evaluate(() => mascot.tick);
    await page.evaluate(async () => {
      for (let k = 0; k < 10; ++k) await new Promise(requestAnimationFrame);
    });
    assert.equal(await page.evaluate(() => mascot.tick), tick);
    await page.keyboard.press(".");
    await until(page, (paused) => mascot.tick === paused + 1 && mascot.state === "paused", tick);
    await page.click("#play");
    await until(page, (paused) => mascot.state === "running" && mascot.tick > paused + 10, tick);
  },
  async "dragging its leader moves it"({page}) {
    await pausedFromAbove(page);
    const [x, y] = await page.evaluate(() => mascot.positions);
    await drag(page, 1);
    await until(page, () => document.querySelector(".notice.granted")?.textContent.includes("takes effect at tick"));
    await page.keyboard.press("Space");
    await until(page, ([x, y]) => mascot.positions[0] > x + 0.5 && mascot.positions[1] > y + 0.2, [x, y]);
    await until(page, () => mascot.events.length === 1);
    // Tune has the place to which it was sent, beside what the file says of the team.
    const toml = await page.evaluate(() => mascot.events[0].toml);
    const sentTo = toml.match(/position_m = \[(.*)\]/)[1].split(", ").map((x) => Number(Number(x).toPrecision(6)));
    const words = `agent 1: (${sentTo.map(String).join(", ").replaceAll("-", "−")})`;
    await until(
        page, (wanted) => document.querySelector("[data-key='law.leader_waypoints_m'] .own").textContent === wanted,
        words);
  },
  async "a click cuts an edge, which darkens, and another click mends it"({page}) {
    await pausedFromAbove(page);
    const index = await edgeInTheOpen(page);
    for (const [verb, state, low, high] of [["cut", 0, 0.1, 0.69], ["mend", 1, 0.7, 1]]) {
      await clickEdge(page, index);
      await until(
          page, (asked) => mascot.lastAnswer.granted && mascot.lastAnswer.request.toml?.startsWith(asked), verb);
      await page.keyboard.press(".");
      await edgeShowsAs(page, index, state, low, high);
    }
    await page.keyboard.press("Space");
    await until(page, () => mascot.state === "running");
  },
  async "a slider changes a gain, and the page shows what it is"({page}) {
    await page.click("#tab-tune");
    const row = page.locator("[data-key='law.p_gain']");
    await row.locator("input[type=range]").focus();
    await page.keyboard.press("ArrowRight");
    await until(page, () => mascot.events.length === 4);
    const toml = await page.evaluate(() => mascot.events.at(-1).toml), now = Number(toml.match(/= ([\d.]+) }/)[1]);
    assert.ok(now > 0.5 && now < 0.55, toml);
    await until(
        page, (value) => mascot.experiment.live_keys.find(({key}) => key === "law.p_gain").value === value, now);
    assert.equal(Number(await row.locator("input[type=number]").inputValue()), now);
  },
  async "a refusal is shown in the words of the run"({page}) {
    const row = page.locator("[data-key='law.p_gain']");
    await row.locator("input[type=number]").fill("5000");
    await page.keyboard.press("Enter");
    await until(page, () => mascot.lastAnswer?.granted === false);
    const words = "law.p_gain: expected a number in [0, 1000], got 5000";
    assert.ok((await row.locator(".refusal").textContent()).endsWith(words));
    assert.ok((await page.textContent(".notice.refused")).includes(words));
    assert.equal(await page.evaluate(() => mascot.events.length), 4);
  },
  async "a second run at the same time takes another port"({run}) {
    const second = await startRun("waypoint.toml", "--engine", "inprocess");
    try {
      assert.notEqual(second.url, run.url);  // which is lower depends on what else listens meanwhile
      for (const {url} of [run, second]) assert.equal((await fetch(url)).status, 200);
    } finally {
      await second.stop();
    }
  },
  async "once it is stopped, its config.toml has all that was done"({page, run, troubles}) {
    assert.deepEqual(troubles, []);  // afterwards the page tries to connect again
    const done = await page.evaluate(() => mascot.events.map(({toml}) => toml.trim()));
    await page.click("#stop");
    await page.click("#confirm-yes");
    assert.equal(await run.ended(), 0);
    const config = await run.read("config.toml");
    assert.deepEqual(done.map((toml) => toml.split(" = ")[0]), ["goto", "cut", "mend", "set"]);
    assert.equal(config.split("[[events]]").length - 1, done.length);
    for (const toml of done) assert.ok(config.includes(toml), `${toml} is not in\n${config}`);
  },
};

test("a run is watched and touched:", async (t) => {
  const browser = await launch(),
        run = await startRun("touch.toml", "--set", "run.name=watched", "--set", "output.save_plot=false");
  try {
    const window = await open(browser, run.url);
    for (const [what, body] of Object.entries(TOUCHES)) await t.test(what, () => body({...window, run}));
  } finally {
    await run.stop();
    await browser.close();
  }
});

const FLOWN = `
[run]
name = "flown"
duration_s = 20.0
[agents]
count = 3
position_m = [[0, 0, 1], [4, 0, 1], [0, 4, 2]]
model = "double_integrator"
[graph]
edges = [[1, 2], [2, 3], [3, 1]]
[link]
loss = 0.2
[law]
name = "consensus"
p_gain = 0.1
[[events]]
at_s = 5.0
cut = [[2, 3]]
[[events]]
at_s = 15.0
set = { "law.p_gain" = 0.3 }
`;

test("the page of a run becomes that of its recording when the run has ended, with pictures and summary", async () => {
  const browser = await launch();
  const run = await startRunOf(FLOWN, "--engine", "inprocess", "--stay");
  try {
    const {page, troubles} = await open(browser, run.url);
    await until(page, () => mascot.tick > 0 && mascot.state === "running");
    assert.ok(await page.isHidden("#tab-results"), "a run that goes on has no results");
    await page.selectOption("#pace", "20");  // not before: the run would be over when the page is open
    await until(page, () => mascot.experiment?.source === "recording" && mascot.state === "paused");
    await page.click("#tab-results");
    await until(page, () => [...document.querySelectorAll("#results img")].some((image) => image.naturalWidth > 100));
    assert.ok((await page.locator("#results img").count()) >= 3);
    await until(page, () => document.querySelectorAll("#results tr").length > 20);
    const row = page.locator("#results tr").filter({has: page.locator("th", {hasText: /^sim_s$/})});
    assert.equal(await row.locator("td").textContent(), "20.00");
    await page.locator("#seek").fill("10");
    await until(page, () => mascot.tick === 1000);
    assert.deepEqual(troubles.filter((words) => !words.includes("WebSocket")), []);
  } finally {
    await run.stop();
    await browser.close();
  }
});

test("the page of a recording goes where it is asked to, and shows what was so at that time", async () => {
  const browser = await launch(), recording = await startRecording(FLOWN);
  try {
    const {page, troubles} = await open(browser, recording.url);
    const shows = (condition, argument) => until(page, condition, argument);
    await shows(() => mascot.experiment.live_keys.length > 0 && mascot.state === "paused");
    const first = await page.evaluate(() => mascot.positions);
    assert.equal(await page.locator("#marks i:not(.incident)").count(), 2);
    const gain = () => page.textContent("[data-key='law.p_gain'] b");
    assert.equal(await gain(), "0.1");
    await page.locator("#seek").fill("15");
    await shows(() => mascot.tick === 1500 && mascot.edgeStates[1] === 0);
    await shows(() => document.querySelector("[data-key='law.p_gain'] b").textContent === "0.3");
    await page.locator("#scene").focus();
    await page.keyboard.press("ArrowLeft");
    await shows(() => mascot.tick === 1499);
    await shows(() => document.querySelector("[data-key='law.p_gain'] b").textContent === "0.1");
    await page.selectOption("#pace", "100");
    await page.keyboard.press("Space");
    await shows(() => mascot.tick === 2000 && mascot.state === "paused");
    await page.locator("#seek").fill("0");
    await shows(() => mascot.tick === 0 && mascot.edgeStates.length === 3);
    assert.deepEqual(await page.evaluate(() => mascot.positions), first);
    assert.deepEqual(troubles, []);
  } finally {
    await recording.stop();
    await browser.close();
  }
});

/** Serves the recording of an experiment of configs/; `body` gets its page, and `at`, which goes to a time. */
async function watchRecording(config, body) {
  const browser = await launch(), recording = await startRecording(await textOf(config));
  try {
    const {page, troubles} = await open(browser, recording.url);
    await until(page, () => mascot.experiment.live_keys.length > 0 && mascot.state === "paused");
    const at = async (t_s) => {
      await page.locator("#seek").fill(String(t_s));
      await until(page, (t) => mascot.t_s === t && mascot.edgeStates?.length > 0, t_s);
      // The picture of this row is drawn before the second of these.
      await page.evaluate(() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn))));
    };
    await body({page, at});
    assert.deepEqual(troubles, []);
  } finally {
    await recording.stop();
    await browser.close();
  }
}

test(
    "coverage is drawn with the cells of its region, which follow the agents",
    () => watchRecording("coverage.toml", async ({page, at}) => {
      const areaOf = ({corners}) => corners.reduce((sum, [x, y], k) => {
        const [u, v] = corners[(k + 1) % corners.length];
        return sum + (x * v - y * u) / 2;
      }, 0);
      const least = [];  // area of a cell (m²)
      for (const t_s of [0, 10]) {
        await at(t_s);
        const cells = await page.evaluate(() => mascot.cells), areas = cells.map(areaOf);
        assert.deepEqual(cells.map(({agent}) => agent), [1, 2, 3, 4, 5, 6]);
        assert.ok(Math.abs(areas.reduce((a, b) => a + b) - 65) < 1e-9, "the region has 65 m²");
        least.push(Math.min(...areas));
      }
      assert.ok(least[1] > 3 * least[0], `the smallest cell grows: ${least}`);
      assert.equal(await page.evaluate(() => mascot.hulls), null);
      assert.deepEqual(await page.evaluate(() => [mascot.liars, mascot.leftOut]), [[], []]);
    }));

test(
    "containment is drawn with the hull of its leaders, which moves with them",
    () => watchRecording("containment.toml", async ({page, at}) => {
      for (const t_s of [0, 10]) {
        await at(t_s);
        const {hulls, leaders} = await page.evaluate(
            () => ({hulls: mascot.hulls, leaders: [0, 3, 6].map((k) => mascot.positions.slice(k, k + 3))}));
        assert.deepEqual(hulls.map((corners) => corners.map(String).sort()), [leaders.map(String).sort()]);
      }
      assert.equal(await page.evaluate(() => mascot.cells), null);
      await until(page, () => /1 leads.*2 leads.*3 leads/s.test(document.getElementById("table").textContent));
    }));

/** Which edges of a page's run are left out along x, as "hearer heard". */
const leftOutAlongX = (page) => page.evaluate(
    () =>
        mascot.experiment.edges.filter((_, k) => mascot.leftOut[k] & 1).map(([hearer, heard]) => `${hearer} ${heard}`));
const LIAR_IS_LEFT_OUT = [1, 2, 3, 4, 5, 6].map((hearer) => `${hearer} 7`);

test(
    "a resilient law is drawn with who lies, and with what each agent leaves out",
    () => watchRecording("resilient.toml", async ({page, at}) => {
      await at(0.5);
      assert.deepEqual(await page.evaluate(() => mascot.liars), []);
      const honest = await leftOutAlongX(page);
      assert.ok(honest.includes("7 5") && !honest.includes("2 7"), `from the starts: ${honest}`);
      await at(2);
      assert.deepEqual(await page.evaluate(() => mascot.liars), [7]);
      const left = await leftOutAlongX(page);
      for (const edge of LIAR_IS_LEFT_OUT) assert.ok(left.includes(edge), `${edge} of ${left}`);
      assert.ok(left.length < 42, "not all is left out");
      assert.deepEqual(await page.evaluate(() => [mascot.cells, mascot.hulls]), [null, null]);
    }));

test("a run that goes on tells who lies and what is left out, as its recording does", async () => {
  const browser = await launch(), run = await startRun("resilient.toml", "--engine", "inprocess");
  try {
    const {page} = await open(browser, run.url);
    await until(page, () => mascot.liars.length === 1);
    assert.deepEqual(await page.evaluate(() => mascot.liars), [7]);
    await until(page, (wanted) => {
      const {leftOut, experiment} = mascot;
      return wanted.every((edge) => leftOut[experiment.edges.findIndex(([i, j]) => `${i} ${j}` === edge)] & 1);
    }, LIAR_IS_LEFT_OUT);
  } finally {
    await run.stop();
    await browser.close();
  }
});

const PHASES = `
[run]
name = "phases"
duration_s = 100.0
[agents]
count = 3
position_m = [[0, 0, 1], [4, 0, 1], [0, 4, 2]]
model = "double_integrator"
[graph]
edges = [[1, 2], [2, 3], [3, 1]]
[law]
name = "consensus"
p_gain = 0.1
[[law.schedule]]
at_s = 0.02
name = "formation"
shape = "line"
p_gain = 0.2
[[law.schedule]]
at_s = 0.04
leader = 1
leader_waypoints_m = [[6.0, 4.0, 2.0]]
`;

/** What a page says of the law: of agent 1, which is chosen, in the list of live keys, and of the events so far. */
async function lawOn(page) {
  const {agents, keys, changes} = await page.evaluate(
      () => ({
        agents: mascot.experiment.agents.map(({law, leads}) => `${law}${leads ? ", leads" : ""}`),
        keys: Object.fromEntries(["law.p_gain", "law.spacing_m"].map(
            (key) => [key, mascot.experiment.live_keys.find((live) => live.key === key)?.value ?? null])),
        changes: mascot.events.map(({tick}) => tick),
      }));
  const title = await page.textContent("#detail h3 small");
  return {agents: agents[0], others: agents[1], title: title.trim(), ...keys, changes};
}

const CONSENSUS = {
  agents: "consensus",
  others: "consensus",
  title: "double integrator, consensus",
  "law.p_gain": 0.1,
  "law.spacing_m": null,
};
const FORMATION = {
  agents: "formation",
  others: "formation",
  title: "double integrator, formation",
  "law.p_gain": 0.2,
  "law.spacing_m": 2,
};
const LED = {
  ...FORMATION,
  agents: "formation, leads",
  title: "double integrator, formation, leads"
};

test("a run whose law changes shows the law that it has, and lists the changes", async () => {
  // So slow that it stands still but for the steps below.
  const browser = await launch(), run = await startRunOf(PHASES, "--engine", "inprocess", "--set", "run.pace=0.0001");
  try {
    const {page, troubles} = await open(browser, run.url);
    await until(page, () => mascot.state === "running");
    await page.keyboard.press("Space");
    await until(page, () => mascot.state === "paused");
    await page.keyboard.press("1");
    const stepTo = async (tick) => {
      while (await page.evaluate(() => mascot.tick) < tick) {
        const now = await page.evaluate(() => mascot.tick);
        await page.keyboard.press(".");
        await until(page, (before) => mascot.tick === before + 1, now);
      }
      await until(page, (count) => mascot.events.length === count, Math.floor(tick / 2));
      await until(
          page, (words) => document.querySelector("#detail h3 small")?.textContent.trim().endsWith(words),
          ["consensus", "formation", "leads"][Math.floor(tick / 2)]);
      return lawOn(page);
    };
    assert.deepEqual(await stepTo(1), {...CONSENSUS, changes: []});
    assert.deepEqual(await stepTo(2), {...FORMATION, changes: [2]});
    assert.deepEqual(await stepTo(4), {...LED, changes: [2, 4]});
    await page.click("#tab-events");
    const listed = await page.locator("#events .event").allTextContents();
    assert.equal(listed.length, 2);
    assert.match(listed[0], /^tick 4 0\.04 s *file.*law = \{.*"leader" = 1,/s);
    assert.match(listed[1], /^tick 2 0\.02 s *file.*law = \{.*"name" = "formation"/s);
    assert.deepEqual(troubles, []);
  } finally {
    await run.stop();
    await browser.close();
  }
});

test("a fault that the page asks for happens, is told, and ends", async () => {
  const toml =
      (await textOf("faults.toml")).split("[[events]]")[0].replace("restart_after_s = 2.0", "restart_after_s = 0.1");
  const browser = await launch(), run = await startRunOf(toml, "--set", "output.save_plot=false");
  try {
    const {page, troubles} = await open(browser, run.url);
    const isSeen = (lost, wrong, words) => until(
        page,
        ([numbers, told, survive]) => mascot.lost.join() === numbers &&
            document.querySelector("#detail .wrong")?.textContent === told && survives.textContent === survive,
        [lost, wrong, words]);
    await until(page, () => mascot.state === "running");
    await page.keyboard.press("Space");
    await until(page, () => mascot.state === "paused");
    await page.keyboard.press("3");
    const choose = async (what) => {
      await page.click("#fault-open");
      await page.click(`[data-fault="${what}"]`);
      await until(page, () => mascot.lastAnswer?.granted);
      await page.locator("#scene").focus();
      await page.keyboard.press(".");
    };
    await choose("link delayed");
    await isSeen("", "link delayed by 0.5 s", "");
    await choose("agent kill");
    await isSeen(
        "3", "lost: its process has died; link delayed by 0.5 s", "agent 3 is lost: the others have a spanning tree");
    await until(
        page,
        () => mascot.experiment.edges.every(
            (edge, k) => !edge.slice(0, 2).includes(3) || mascot.edgeStates[k] === 0));  // nobody hears it
    await page.keyboard.press("Space");
    await isSeen("", "link delayed by 0.5 s", "");
    await until(page, () => mascot.events.length === 3);
    assert.deepEqual(
        await page.locator("#marks i").evaluateAll((marks) => marks.map(({className}) => className)),
        ["by-hand fault", "by-hand fault", "fault"]);
    assert.deepEqual(troubles, []);
  } finally {
    await run.stop();
    await browser.close();
  }
});

test("the page of a recording whose law changes shows the law of the tick", async () => {
  const browser = await launch(), recording = await startRecording(await textOf("formation_change.toml"));
  try {
    const {page, troubles} = await open(browser, recording.url);
    await until(page, () => mascot.experiment?.live_keys.length > 0 && mascot.state === "paused");
    await page.keyboard.press("1");
    const at = async (t_s, title) => {
      await page.locator("#seek").fill(String(t_s));
      await until(page, (t_s) => mascot.t_s === t_s, t_s);
      await until(page, (title) => document.querySelector("#detail h3 small")?.textContent.trim() === title, title);
      return page.evaluate(() => mascot.experiment.agents.map(({place_m}) => place_m.map((x) => x.toFixed(3)).join()));
    };
    const circle = await at(10, "quadrotor, formation"), vee = await at(15, "quadrotor, formation");
    assert.notDeepEqual(circle, vee);
    assert.deepEqual(await at(30, "quadrotor, formation, leads"), vee);
    assert.deepEqual(await at(14.99, "quadrotor, formation"), circle);
    await page.click("#tab-events");
    assert.deepEqual(
        await page.locator("#events .event header").allTextContents(),
        ["tick 3000 30.00 sfileCopy as TOML", "tick 1500 15.00 sfileCopy as TOML"]);
    assert.equal(await page.locator("#marks i:not(.incident):not(.by-hand)").count(), 2);
    assert.deepEqual(troubles, []);
  } finally {
    await recording.stop();
    await browser.close();
  }
});

test(
    "the page has a curve of each of the user's own metrics, whose value is that at the time that is shown",
    async () => {
      const metrics = new URL("own_metrics.py", import.meta.url).pathname;
      const browser = await launch();
      const recording = await startRecording(await textOf("leaderless.toml"), "--metric", metrics);
      try {
        const {page, troubles} = await open(browser, recording.url);
        await until(page, () => mascot.drawn.metrics.length === 2 && mascot.drawn.metrics[0]?.[0] === 40);
        assert.deepEqual(
            await page.locator("#metric-charts h2 .own").allTextContents(), ["flown", "height"],
            "in the order of METRICS");
        assert.equal(await page.locator("#metric-charts canvas").count(), 4, "each has a curve, on two layers");
        const at = async (t_s) => {
          await page.locator("#seek").fill(String(t_s));
          await until(page, (t_s) => mascot.t_s === t_s, t_s);
          return page.locator("#metric-charts h2 b").allTextContents();
        };
        assert.deepEqual(await at(4), ["4.000 s", ""], "None: no value yet");
        const [flown, height] = await at(20);
        assert.equal(flown, "20.00 s");
        assert.match(height, / m$/);
        assert.equal(await page.textContent("#metric-error"), "");
        assert.deepEqual(troubles, []);
      } finally {
        await recording.stop();
        await browser.close();
      }
    });

test("a leader with a real vehicle flies to where it is dragged, and lands when it is asked to", async () => {
  // A domain that no run chooses for itself, with a name that no other test has.
  const domain = 100, namespace = `px4_of_${process.pid}`;
  const toml = `
[run]
mode = "realtime"
agent_timeout_s = 2.0
duration_s = 1000.0
[agents]
count = 2
model = "double_integrator"
position_m = [[0.0, 0.0, 0.8], [0.0, 3.0, 0.8]]
[law]
name = "consensus"
leader = 1
[output]
save_plot = false
[[vehicles]]
agents = [1]
kind = "px4"
address = "127.0.0.1"
domain = ${domain}
namespace = "${namespace}"
`;
  const switchOff = switchOnPx4("--domain", String(domain), "--namespace", namespace, "--system-id", "2");
  const browser = await launch(), run = await startRunOf(toml, "--go");
  try {
    const {page, troubles} = await open(browser, run.url);
    await until(page, () => mascot.vehicles[0]?.phase === "flying");
    await page.keyboard.press("t");
    await page.evaluate(() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn))));
    const [x, y] = await page.evaluate(() => mascot.positions);
    await drag(page, 1);
    await until(page, ([x, y]) => mascot.positions[0] > x + 0.5 && mascot.positions[1] > y + 0.2, [x, y]);
    assert.equal(await page.textContent("#vehicles li .phase"), "flying");
    await page.click('#vehicles button:text-is("Land all")');
    await until(page, () => mascot.vehicles[0].phase === "landed");
    assert.deepEqual(troubles, []);
  } finally {
    await run.stop();
    await browser.close();
    switchOff();
  }
});

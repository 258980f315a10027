// The page in a real browser, on made-up runs: what it shows, what it asks for, and what it says of the answers.
import assert from "node:assert/strict";
import {after, before} from "node:test";

import {launch, open, PHONE, WIDE} from "./browser.mjs";
import {startFake} from "./fake_server.mjs";
import {clickEdge, drag, edgeInTheOpen, edgeShowsAs, isPaused, pausedFromAbove, placeOf, until} from "./hand.mjs";
import {test} from "./waits.mjs";

let browser;
before(async () => {
  browser = await launch();
});
after(() => browser.close());

/** Runs `body` with a window on a made-up run; the window must have had no troubles. */
async function watching({run = {}, ...window}, body) {
  const fake = await startFake(run);
  try {
    const {page, troubles} = await open(browser, fake.url, window);
    await body({page, fake});
    assert.deepEqual(troubles, []);
    await page.context().close();
  } finally {
    await fake.stop();
  }
}

const events = (fake) => fake.asked.filter(({ask}) => ask === "event").map(({toml}) => toml);

/** A finger goes from a place of the window by (dx, dy). */
async function swipe(page, [x, y], [dx, dy]) {
  const fingers = await page.context().newCDPSession(page);
  const touch = (type, ...touchPoints) => fingers.send("Input.dispatchTouchEvent", {type, touchPoints});
  await touch("touchStart", {x, y});
  for (const share of [0.3, 0.6, 1]) await touch("touchMove", {x: x + share * dx, y: y + share * dy});
  await touch("touchEnd");
}

/** Tests that follow each other in one window: opening one takes a second or two of the processor. */
function inOneWindow(name, tests) {
  test(name, (t) => watching({}, async (window) => {
               for (const [what, body] of Object.entries(tests)) {
                 window.fake.asked.length = 0;
                 await t.test(what, () => body(window));
               }
             }));
}

// --- what it shows -----------------------------------------------------------------------------------------

test(
    "agents move, in wide and narrow windows, light and dark",
    () => watching({}, async ({page}) => {
      for (const [size, colorScheme, ground] of [
               [WIDE, "light", "243, 245, 248"], [WIDE, "dark", "13, 17, 22"], [PHONE, "dark", "13, 17, 22"],
               [PHONE, "light", "243, 245, 248"]]) {
        await page.emulateMedia({colorScheme});
        await page.setViewportSize(size);
        await until(page, (wanted) => getComputedStyle(document.body).backgroundColor === wanted, `rgb(${ground})`);
        await until(page, () => scene.width === scene.parentElement.clientWidth);  // the view has taken its size
        const {tick, p} = await page.evaluate(() => {
          globalThis.seen = mascot.pixels();
          return {tick: mascot.tick, p: mascot.positions};
        });
        await until(page, (last) => mascot.tick > last + 20, tick);
        const {now, changed, overflow} = await page.evaluate(() => {
          const {data} = mascot.pixels();
          let changed = 0;
          for (let k = 0; k < data.length; k += 4) changed += data[k] !== globalThis.seen.data[k];
          return {now: mascot.positions, changed, overflow: document.documentElement.scrollWidth - innerWidth};
        });
        assert.ok(p.some((x, k) => Math.abs(x - now[k]) > 0.02), "positions stay");
        assert.ok(changed > 200, `${changed} pixels have changed`);
        assert.ok(overflow <= 0, `${overflow} px stick out`);
      }
      assert.equal(await page.evaluate(() => mascot.drawn.agents), 10);
    }));

test(
    "a thousand agents are drawn, and listed by the rows in sight; text is text",
    () => watching({run: {agents: 1000, name: "<b>bold</b>"}}, async ({page}) => {
      const {drawn, rows} =
          await page.evaluate(() => ({drawn: mascot.drawn, rows: document.querySelectorAll("#table .row").length}));
      assert.equal(drawn.agents, 1000);
      assert.ok(drawn.edges > 1000);
      assert.ok(rows < 60, `${rows} rows`);
      await until(page, (tick) => mascot.tick > tick, await page.evaluate(() => mascot.tick));
      assert.equal(await page.textContent("#name"), "<b>bold</b>");
      assert.equal(await page.locator("#name b").count(), 0);
    }));

test(
    "keys choose an agent, which is told in full and followed, and open the help sheet",
    () => watching({}, async ({page}) => {
      await page.keyboard.press("3");
      await until(page, () => mascot.selected === 3);
      await until(page, () => document.querySelector("#detail h3")?.textContent.startsWith("Agent 3"));
      await until(page, () => /agent 4.*(heard|lost).*s old/.test(document.querySelector("#detail .ear")?.textContent));
      await page.keyboard.press("f");
      await until(page, () => mascot.followed === 3);
      await until(page, () => {
        const [x, y] = mascot.agentOnScreen(3);
        return Math.hypot(x - scene.clientWidth / 2, y - scene.clientHeight / 2) < 5;
      });
      await page.keyboard.press("Escape");
      await until(page, () => mascot.selected === 0);
      await page.keyboard.press("?");
      assert.ok(await page.evaluate(() => help.open));
    }));

inOneWindow("the view is looked at:", {
  async "from above, where an agent is on the grid does not depend on its height"({page}) {
    await pausedFromAbove(page);
    const {wrong_px, heights_m} = await page.evaluate(() => {
      const places = mascot.experiment.agents.map(
          ({id}) => ({p: mascot.positions.slice(3 * id - 3, 3 * id), at: mascot.agentOnScreen(id)}));
      const of = (pick) => [...places].sort((a, b) => pick(a) - pick(b));
      const [west, east] = [0, -1].map((k) => of(({p}) => p[0]).at(k)),
                   scale = (east.at[0] - west.at[0]) / (east.p[0] - west.p[0]);
      const wrong = ({p, at}) =>
          Math.hypot(at[0] - west.at[0] - scale * (p[0] - west.p[0]), at[1] - west.at[1] + scale * (p[1] - west.p[1]));
      const [low, high] = [0, -1].map((k) => of(({p}) => p[2]).at(k).p[2]);
      return {wrong_px: Math.max(...places.map(wrong)), heights_m: high - low};
    });
    assert.ok(heights_m > 0.5, `heights differ by ${heights_m} m`);
    assert.ok(wrong_px < 2, `an agent is ${wrong_px} px from its place on the grid`);
  },
  async "from above, a drag with Shift raises an agent by what its pixels are on the ground"({page, fake}) {
    const was = fake.run.p[3], px_per_m = await page.evaluate(() => {
      const [a, b] = [4, 10].map((id) => [mascot.positions[3 * id - 3], mascot.agentOnScreen(id)[0]]);
      return (b[1] - a[1]) / (b[0] - a[0]);
    });
    const [x, y] = await placeOf(page, "agentOnScreen", 4);
    await page.keyboard.down("Shift");
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x, y - 60, {steps: 3});
    await page.mouse.up();
    await page.keyboard.up("Shift");
    await until(page, () => mascot.events.length === 1);
    const [, px, py, pz] = events(fake)[0].match(/-?\d+(\.\d+)?/g).map(Number), wanted = was[2] + 2 * 60 / px_per_m;
    assert.ok(Math.hypot(px - was[0], py - was[1]) < 2e-3, `from ${was} to ${px}, ${py}`);
    assert.ok(Math.abs(pz - wanted) < 0.1, `to ${pz} m, not ${wanted} m`);
  },
  async "an agent is chosen by a click on any part of it, however near it is"({page}) {
    await page.keyboard.press("3");
    await page.keyboard.press("f");
    await page.locator("#scene").hover();
    for (let k = 0; k < 40; ++k) await page.mouse.wheel(0, -200);
    await until(page, () => mascot.radiusOnScreen(3) > 60);
    await page.keyboard.press("Escape");
    const [x, y] = await placeOf(page, "agentOnScreen", 3);
    await page.mouse.click(x + 0.7 * await page.evaluate(() => mascot.radiusOnScreen(3)), y);
    await until(page, () => mascot.selected === 3);
  },
  async "the view has a frame for those who come to it by the keyboard, and none when it is clicked"({page}) {
    const frame = () => page.evaluate(() => getComputedStyle(scene).outlineStyle);
    await page.mouse.click(...await placeOf(page, "agentOnScreen", 3));
    assert.equal(await page.evaluate(() => document.activeElement.id), "scene");
    assert.equal(await frame(), "none");
    await page.keyboard.press("Tab");
    await page.keyboard.press("Shift+Tab");
    assert.equal(await page.evaluate(() => document.activeElement.id), "scene");
    assert.equal(await frame(), "solid");
  },
});

test(
    "a trail is gone after 8 s of simulated time, however few rows come",
    () => watching({}, async ({page}) => {
      const shares = await page.evaluate(async () => {
        const {Trails} = await import("/scene/trails.js");
        const trails = new Trails(1);
        for (let t_s = 0; t_s <= 12; t_s += 2) trails.update({p: [t_s, 0, 1], t_s});
        const {newest, lifetime} = trails.material.uniforms;
        return [...trails.geometry.attributes.born.array.slice(0, trails.count)].map(
            (born) => 1 - (newest.value - born) / lifetime.value);
      });
      assert.deepEqual(shares, [-0.25, 0, 0.25, 0.5, 0.75, 1]);
    }));

test(
    "curves say that they are empty, and end where the logarithmic axis does",
    () => watching({run: {disagreement_m: 1e-9}}, async ({page, fake}) => {
      await page.keyboard.press("Space");
      await isPaused(page);
      fake.run.past.length = 0;  // as of a run that is paused before its first tick
      await page.reload();
      await isPaused(page);
      for (const id of ["disagreement", "speed"])
        await until(page, (chart) => document.getElementById(chart).textContent.includes("begins here"), id);
      await page.keyboard.press("Space");
      await until(page, () => document.querySelectorAll("#speed canvas").length > 0 && mascot.drawn.chartRows > 2);
      await until(page, () => disagreement.textContent === "Nothing above 10⁻⁶ m yet.");
      const [, measured, theory] = await page.evaluate(() => mascot.drawn.disagreement);
      assert.deepEqual([measured, theory], [null, null]);
      fake.run.disagreement_m = null;
      await until(page, () => document.querySelectorAll("#disagreement canvas").length > 0);
    }));

test(
    "on a phone, what is opened is in the window, from its beginning",
    () => watching({size: PHONE}, async ({page}) => {
      await page.click("#layers summary");
      const {x, width} = await page.locator("#layer-list").boundingBox();
      assert.ok(x >= 0 && x + width <= PHONE.width, `from ${x} on, ${width} wide`);
      await page.click("#help-open");
      assert.equal(await page.evaluate(() => help.scrollTop), 0);
      assert.ok(await page.evaluate(() => help.scrollHeight > help.clientHeight), "there is more than fits");
    }));

test(
    "space pauses, also after the pointer has pressed something else",
    () => watching({}, async ({page, fake}) => {
      for (const pressed of ["#tab-tune", "#view-top", "#tab-agents"]) {
        await page.click(pressed);
        await page.keyboard.press("Space");
        await isPaused(page);
        await page.keyboard.press("Space");
        await until(page, () => mascot.state === "running");
      }
      await page.focus("#tab-events");
      await page.keyboard.press("Space");
      await until(page, () => document.querySelector("#tab-events").getAttribute("aria-selected") === "true");
      assert.equal(fake.asked.length, 6);
    }));

// --- what is drawn of a law --------------------------------------------------------------------------------

const REGION = [[-9, -9], [9, -9], [9, 9], [0, 12], [-9, 9]];
const ALL = Array.from({length: 10}, (_, k) => k + 1);

/** The words of the legend, and of the menu of layers, that can be seen. */
const offered = (page) => page.evaluate(() => {
  const seen = (list) => [...list.children].filter(({hidden}) => !hidden).map(({textContent}) => textContent);
  return {legend: seen(legend), menu: seen(document.getElementById("layer-list"))};
});

/** Hides or shows a layer by its words in the menu. */
async function toggle(page, words) {
  await page.click("#layers summary");
  await page.click(`#layer-list label:has-text("${words}")`);
  await page.keyboard.press("Escape");
}

/** The picture of what is known now is drawn before the second of these. */
const nextPicture = (page) =>
    page.evaluate(() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn))));

test(
    "a run has only what its law has: no cells, no hull, no liars, nothing left out",
    () => watching({}, async ({page}) => {
      await until(page, () => mascot.tick > 0);
      const drawn = await page.evaluate(() => [mascot.cells, mascot.hulls, mascot.liars, mascot.leftOut]);
      assert.deepEqual(drawn, [null, null, [], []]);
      const {legend, menu} = await offered(page);
      assert.deepEqual(legend, ["heard", "lost", "out of range", "no edge"]);
      for (const words of ["What laws leave out", "Who lies", "Cells of the region", "Hull of the leaders"])
        assert.ok(!menu.includes(words), words);
    }));

test("the cells of a region are its parts that are nearest to each agent, and follow the agents", async () => {
  await watching({run: {cells: [{region_m: REGION, agents: ALL}], drift_m_per_s: 1}}, async ({page}) => {
    await until(page, () => mascot.cells?.length === 10);
    const seen = await page.evaluate((region) => {
      const area = (corners) => corners.reduce((sum, [x, y], k) => {
        const [u, v] = corners[(k + 1) % corners.length];
        return sum + (x * v - y * u) / 2;
      }, 0);
      const isIn = (corners, [px, py]) => corners.length > 2 && corners.every(([x, y], k) => {
        const [u, v] = corners[(k + 1) % corners.length];
        return (u - x) * (py - y) - (v - y) * (px - x) > -1e-9;
      });
      const {cells, positions: p} = mascot;
      const nearest = (q) =>
          cells.map(({agent}) => [Math.hypot(p[3 * agent - 3] - q[0], p[3 * agent - 2] - q[1]), agent])
              .sort(([a], [b]) => a - b)[0][1];
      const wrong = [];
      for (let x = -8.7; x < 9; x += 0.61)
        for (let y = -8.7; y < 9; y += 0.61)
          if (!isIn(cells.find(({agent}) => agent === nearest([x, y])).corners, [x, y])) wrong.push([x, y]);
      return {wrong, areas: cells.map(({corners}) => area(corners)), whole: area(region), cells};
    }, REGION);
    assert.deepEqual(seen.wrong, []);
    assert.ok(Math.abs(seen.areas.reduce((a, b) => a + b) - seen.whole) < 1e-9, `${seen.areas} of ${seen.whole}`);
    await until(page, (before) => JSON.stringify(mascot.cells) !== before, JSON.stringify(seen.cells));
    const {legend} = await offered(page);
    assert.ok(legend.includes("cells"), legend);
    await toggle(page, "Cells of the region");
    await until(page, () => mascot.cells === null);
  });
});

test("the convex hull of leaders is drawn through them, in the plane or in space, and follows them", async () => {
  const leaders = [2, 4, 5, 7, 9];
  for (const [axes, least] of [["xy", 3], ["xyz", 4]])
    await watching({run: {hulls: [{agents: leaders, axes}]}}, async ({page, fake}) => {
      await until(page, () => mascot.hulls?.[0].length > 2);
      const {corners, places} = await page.evaluate((ids) => {
        const round = (x) => x.toFixed(3);
        return {
          corners: mascot.hulls[0].map((p) => p.map(round).join()),
          places: ids.map((id) => mascot.positions.slice(3 * id - 3, 3 * id).map(round).join())
        };
      }, leaders);
      assert.ok(corners.length >= least, `${corners}`);
      for (const corner of corners) assert.ok(places.includes(corner), `${corner} is none of ${places}`);
      await until(page, (before) => mascot.hulls[0].map(String).join() !== before, corners.join());
      await until(page, () => /2 leads.*9 leads/s.test(document.getElementById("table").textContent));
      assert.ok((await offered(page)).legend.includes("hull of leaders"));
      await drag(page, 2);
      assert.deepEqual(events(fake), [], "a leader that flies no waypoints is not sent");
      await toggle(page, "Hull of the leaders");
      await until(page, () => mascot.hulls === null);
    });
});

test("the hull of leaders that stand in a line, or at one place, is drawn as far as there is one", async () => {
  await watching({}, async ({page}) => {
    const drawn = await page.evaluate(async () => {
      const {Hulls} = await import("/scene/areas.js");
      const hullOf = (axes, ...points) => {
        const layer = new Hulls([{agents: points.map((_, k) => k + 1), axes}]);
        layer.update({p: points.flat()});
        return layer.drawn[0].length;
      };
      return {
        line: hullOf("xyz", [0, 0, 1], [1, 1, 1], [2, 2, 1]),
        place: hullOf("xy", [3, 3, 1], [3, 3, 1]),
        square: hullOf("xyz", [0, 0, 1], [4, 0, 1], [4, 4, 1], [0, 4, 1]),
        tetrahedron: hullOf("xyz", [0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0.1, 0.1, 0.1]),
      };
    });
    assert.deepEqual(drawn, {line: 2, place: 1, square: 4, tetrahedron: 4});
  });
});

test("who lies is marked and named from the time on at which it lies", async () => {
  await watching({run: {source: "recording", liars: {3: 20}}}, async ({page}) => {
    const isNamed = () => page.evaluate(() => mascot.texts.some(({text}) => text === "3 lies"));
    const seek = async (t_s) => {
      await page.locator("#seek").fill(String(t_s));
      await until(page, (t) => Math.abs(mascot.t_s - t) < 0.02, t_s);
      await nextPicture(page);
    };
    await seek(19);
    assert.deepEqual(await page.evaluate(() => mascot.liars), []);
    assert.ok(!await isNamed());
    assert.ok((await offered(page)).legend.includes("lies"));
    await seek(20);
    assert.deepEqual(await page.evaluate(() => mascot.liars), [3]);
    assert.ok(await isNamed());
    await page.locator("#scene").focus();
    await page.keyboard.press("3");
    await until(page, () => document.querySelector("#detail h3")?.textContent.endsWith(", lies"));
    await until(page, () => document.querySelector("#table .row[data-agent='3']").textContent.startsWith("3 lies"));
    await toggle(page, "Who lies");
    await nextPicture(page);
    assert.ok(!await isNamed());
  });
});

test("what goes wrong with an agent is chosen from a menu, asked for, and seen", async () => {
  await watching({run: {on_agent_loss: "hold"}}, async ({page, fake}) => {
    const choose = async (what) => {
      await page.click("#fault-open");
      await page.click(what);
      assert.ok(await page.locator("#faults").isHidden(), "the menu closes");
    };
    const isGone = (number) =>
        page.evaluate((id) => mascot.texts.some(({text}) => text === `${id} lost`) && mascot.lost.includes(id), number);
    await pausedFromAbove(page);
    assert.ok(await page.locator("#survives").isHidden());
    assert.ok(!(await offered(page)).legend.includes("agent lost"));
    await page.keyboard.press("3");
    await page.click("#fault-open");
    assert.equal(await page.textContent("#faults-title"), "A fault of agent 3");
    assert.deepEqual(await page.locator("#faults h4").allTextContents(), ["agent", "sensor", "motor", "link"]);
    assert.deepEqual(
        await page.locator("#faults .choices button").allTextContents(),
        ["kill", "mute", "ok", "stuck", "off", "delayed"]);
    assert.equal(
        await page.getAttribute("[data-fault='link delayed']", "title"),
        "what it sends arrives delay_s later\nwith the usual delay_s");
    assert.match(await page.textContent("#faults p"), /killed or hangs is lost \(run\.on_agent_loss = "hold"\)/);
    await page.keyboard.press("Escape");
    assert.ok(await page.locator("#faults").isHidden());
    assert.equal(await page.evaluate(() => mascot.selected), 3, "Escape closes the menu alone");

    await choose("[data-fault='agent kill']");
    await until(page, () => document.querySelector("#detail .wrong")?.textContent === "lost");
    const values = () => page.locator("#detail dd").allTextContents();
    assert.deepEqual((await values()).slice(3, 5).filter((text) => /\d/.test(text)), [], "it commands nothing");
    await nextPicture(page);
    assert.ok(await isGone(3));
    assert.equal(await page.textContent("#survives"), "agent 3 is lost: the others go on");
    assert.ok((await offered(page)).legend.includes("agent lost"));
    await until(page, () => document.querySelector("#table .row[data-agent='3']").matches(".lost"));
    assert.match(await page.textContent("#table .row[data-agent='3']"), /^3 lost/);
    await toggle(page, "Who is lost");
    await nextPicture(page);
    assert.ok(!await page.evaluate(() => mascot.texts.some(({text}) => text === "3 lost")));
    await choose("#faults .row-end button");
    await until(page, () => document.querySelector("#detail .wrong")?.textContent === "");
    assert.ok(await page.locator("#survives").isHidden());
    await choose("[data-fault='motor off']");
    await until(page, () => document.querySelector("#detail .wrong")?.textContent === "motor off");
    assert.deepEqual(
        events(fake),
        ['fault = { agent = 3, kind = "kill" }', "restart = 3", 'fault = { agent = 3, of = "motor", kind = "off" }']);
    assert.equal(await page.locator("#marks i.fault.by-hand").count(), 3);
  });
});

test("a fault that ends the run says so before it is asked for", async () => {
  await watching({run: {on_agent_loss: "abort"}}, async ({page}) => {
    await page.keyboard.press("2");
    await page.click("#fault-open");
    assert.match(await page.textContent("#faults p.warn"), /kill and hang end the run/);
    assert.deepEqual(await page.locator("#faults .danger").allTextContents(), ["kill"]);
    assert.deepEqual(await page.locator("#faults .row-end button").allTextContents(), ["Close"]);
    await page.locator("#faults .row-end button").click();
    await until(page, () => !document.getElementById("faults").open);
  });
});

test("faults of a recording are marked on its time line, told at their time, and not changed", async () => {
  const happened = [
    [5, "goto = { agent = 4, position_m = [1.0, 6.0, 3.0] }", false],
    [12, 'fault = { agent = 3, kind = "kill" }', false], [14, "restart = 3\nafter_loss = true", false],
    [20, 'fault = { agent = 2, of = "motor", kind = "off" }', true]
  ];
  const run = {
    source: "recording",
    happened,
    faults: {3: ["lost: its process has died"]},
    survives: [
      {from_s: 12, is_wrong: true, words: "agent 3 is lost: nobody hears anybody"},
      {from_s: 14, is_wrong: false, words: "no agent is lost"}
    ]
  };
  await watching({run}, async ({page}) => {
    const marks = page.locator("#marks i.fault");
    assert.equal(await marks.count(), 3);
    assert.match(await marks.nth(0).getAttribute("title"), /^event 2\n(.*\n)*fault = \{ agent = 3, kind = "kill" \}/);
    assert.match(await marks.nth(1).getAttribute("title"), /^event 3\n(.*\n)*restart = 3/);
    const colours = await page.locator("#marks i")
                        .evaluateAll((each) => each.map((mark) => getComputedStyle(mark).backgroundColor));
    assert.equal(new Set(colours.slice(1)).size, 1, "one colour for faults, by hand or not");
    assert.notEqual(colours[0], colours[1]);
    await marks.nth(0).click();
    await until(page, () => mascot.tick === 1200);
    await until(page, () => survives.textContent === "agent 3 is lost: nobody hears anybody" && !survives.hidden);
    await marks.nth(1).click();
    await until(page, () => mascot.tick === 1400 && survives.hidden);
    await page.locator("#scene").focus();
    await page.keyboard.press("3");
    await until(page, () => document.querySelector("#detail .wrong")?.textContent === "lost: its process has died");
    assert.equal(await page.locator("#fault-open").count(), 0);
  });
});

test("what a law leaves out of what it hears looks so, and is told with its axes", async () => {
  await watching({run: {left_out: () => [0, 3, 0, 4]}}, async ({page, fake}) => {
    const looks = (k, l, same) => until(page, ([k, l, same]) => {
      const [a, b] = [k, l].map((edge) => mascot.edgeLook(edge).slice(0, 3));
      return (Math.max(...a.map((x, i) => Math.abs(x - b[i]))) < 0.05) === same;
    }, [k, l, same]);
    await looks(1, 3, true);
    await looks(1, 0, false);
    const [hearer] = fake.run.edges[1];
    await page.keyboard.press(String(hearer));
    await until(
        page,
        () => /heard, left out along x, y, 0\.01 s old/.test(document.querySelector("#detail .heard")?.textContent));
    assert.ok((await offered(page)).legend.includes("left out"));
    await page.keyboard.press("Escape");
    await toggle(page, "What laws leave out");
    await looks(1, 0, true);
  });
});

// --- texts and numbers -------------------------------------------------------------------------------------

/** Pairs of texts of the view, of what stands above it, and of the labels of each chart, that stand on each other. */
const collisions = (page) => page.evaluate(() => {
  const hits = (texts) => texts.flatMap(
      ({text, box: [l, t, r, b]}, k) => texts.slice(k + 1)
                                            .filter(({box: [l2, t2, r2, b2]}) => l < r2 && l2 < r && t < b2 && t2 < b)
                                            .map((other) => [text, other.text]));
  const stage = scene.getBoundingClientRect();
  const boxOf = (element, range = element) => {
    const {left, top, right, bottom} = range.getBoundingClientRect();
    return {
      text: element.textContent,
      box: [left - stage.left, top - stage.top, right - stage.left, bottom - stage.top]
    };
  };
  const textIn = (element) => {
    const range = document.createRange();  // of the text: an element may be wider
    range.selectNodeContents(element);
    return boxOf(element, range);
  };
  const above = [...document.querySelectorAll(".views, #wind, #legend")].filter(({hidden}) => !hidden);
  return [
    ...hits([...mascot.texts, ...above.map((element) => boxOf(element))]),
    ...["law", "disagreement", "speed"].flatMap(
        (id) => hits([...document.querySelectorAll(`#${id} .dygraph-axis-label`)].map(textIn)))
  ];
});

test("no text stands on another, wherever agents, waypoints and axes are, in wide and narrow windows", async () => {
  for (const run of [{}, {agents: 40}, {hulls: [{agents: ALL, axes: "xy"}], liars: {1: 0, 2: 0}}])
    await watching({run}, async ({page, fake}) => {
      for (const size of [WIDE, PHONE])
        for (const look of ["a", "t"]) {
          await page.setViewportSize(size);
          await page.keyboard.press(look);
          await until(page, (tick) => mascot.tick > tick + 20, await page.evaluate(() => mascot.tick));
          assert.deepEqual(await collisions(page), [], JSON.stringify([run, size, look]));
          assert.ok(await page.evaluate(() => mascot.texts.length) > 5);
        }
      // All at one place: those numbers are left out that have none.
      fake.run.p.forEach((p) => p.splice(0, 3, 1, 1, 1));
      fake.run.v.forEach((v) => v.fill(0));
      await page.keyboard.press(".");
      await until(page, () => Math.abs(mascot.positions[0] - mascot.positions[3]) < 0.1);
      await page.evaluate(() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn))));
      assert.deepEqual(await collisions(page), []);
      assert.ok(await page.evaluate(() => mascot.texts.some(({text}) => text === "4 leads")));
    });
});

test("labels of a logarithmic axis have room, whatever its range is", async () => {
  for (const [from, to] of [[25, 5], [11, 4], [9.5, 3], [9.02, 0.161], [1000, 1e-5], [0.3, 0.2], [1e-6, 1e-7]])
    await watching(
        {
          run: {
            source: "recording",
            curve: {name: "lag", unit: "m", meaning: "", decays: true, agrees: false, since_s: 0, predicted: null},
            law_value: (t_s) => from * (to / from) ** (t_s / 60)
          }
        },
        async ({page}) => {
          await until(page, () => document.querySelectorAll("#law .dygraph-axis-label-x").length > 1);
          assert.deepEqual(await collisions(page), [], `${from} to ${to}`);
          assert.ok(await page.locator("#law .dygraph-axis-label-y").count() >= 1, `${from} to ${to}`);
        });
});

test("axes and figures do not dwell on what rounding leaves of a zero", async () => {
  for (const decays of [true, false])
    await watching(
        {
          run: {
            source: "recording",
            disagreement_m: 1.3e-13,
            curve: {name: "lag", unit: "m", meaning: "", decays, agrees: true, since_s: 0, predicted: null},
            law_value: (t_s) => (decays && t_s < 1 ? 1 : 1e-13 * (1 + Math.sin(t_s)))
          }
        },
        async ({page}) => {
          await until(page, () => document.querySelectorAll("#law .dygraph-axis-label-y").length > 0);
          const labels = await page.locator("#law .dygraph-axis-label-y").allTextContents();
          for (const label of labels) assert.ok(!/10⁻(?:[7-9]|¹)|0\.00000/.test(label), `${labels}`);
          await page.locator("#seek").fill("30");
          await until(
              page, (words) => document.getElementById("law-now").textContent === words,
              decays ? "< 10⁻⁶ m" : "0.000 m");
          assert.equal(await page.textContent("#disagreement-now"), "< 10⁻⁶ m");
        });
});

test("a number is written in one way, wherever it stands", async () => {
  await watching({}, async ({page}) => {
    const wrote = await page.evaluate(async () => {
      const {exact, figure, fixed, seconds} = await import("/numbers.js");
      return {
        figures: [0, 1e-13, 2.345e-5, 0.25, 12.345, 678.9, 54321, 1.5e6, -0.5, null].map(figure),
        exact: [0, 0.1 + 0.2, 1e6, -200, 1.5e-7, 12345.678, -1e-6].map(exact),
        fixed: [fixed(-0.001), fixed(-2.5), fixed(1 / 3, 1)],
        seconds: [seconds(0), seconds(12.345), seconds(600)]
      };
    });
    assert.deepEqual(wrote, {
      figures: ["0.000", "0.000", "2.3·10⁻⁵", "0.250", "12.35", "678.90", "54321", "1.5·10⁶", "−0.500", "–"],
      exact: ["0", "0.3", "10⁶", "−200", "1.5·10⁻⁷", "12345.7", "−10⁻⁶"],
      fixed: ["0.00", "−2.50", "0.3"],
      seconds: ["0.00 s", "12.35 s", "600.00 s"]
    });
    await page.keyboard.press("2");
    for (const tab of ["agents", "tune"]) {
      await page.click(`#tab-${tab}`);
      const text = await page.innerText("#panel");
      assert.doesNotMatch(text, /\d[eE][+−-]?\d/);
      assert.doesNotMatch(text, /(?:^|\s)-\d/);
    }
  });
});

// --- what it asks for --------------------------------------------------------------------------------------

inOneWindow("the view is touched:", {
  async "pause stops time, and a step is one tick"({page, fake}) {
    await page.click("#play");
    await isPaused(page);
    const tick = await page.evaluate(() => mascot.tick);
    await page.keyboard.press(".");
    await until(page, (last) => mascot.tick === last + 1, tick);
    await page.selectOption("#pace", "5");
    await until(page, () => mascot.pace === 5);
    await page.click("#play");
    await until(page, () => mascot.state === "running");
    assert.deepEqual(fake.asked.map(({ask}) => ask), ["pause", "step", "pace", "resume"]);
  },
  async "dragging the leader sends it there, and the answer is shown; others are not dragged"({page, fake}) {
    await pausedFromAbove(page);
    const was = fake.run.p[3];
    await drag(page, 4);
    await until(page, () => mascot.events.length === 1);
    const [toml] = events(fake), [agent, px, py, pz] = toml.match(/-?\d+(\.\d+)?/g).map(Number);
    assert.match(toml, /^goto = \{ agent = 4, position_m = \[.*\] \}$/);
    assert.equal(agent, 4);
    assert.ok(px > was[0] && py > was[1], `from ${was} to ${px}, ${py}`);  // right is east, up is north
    assert.ok(Math.abs(pz - was[2]) < 2e-3, "its height stays");
    await until(page, () => document.querySelector(".notice.granted")?.textContent.includes("takes effect at tick"));
    await drag(page, 10);
    assert.equal(events(fake).length, 1);
  },
  async "edges darken when samples are lost, and when a click cuts them, until a click mends them"({page, fake}) {
    const index = await edgeInTheOpen(page), pair = fake.run.edges[index].slice(0, 2).join(", ");
    const showsAs = (state, low, high) => edgeShowsAs(page, index, state, low, high);
    await showsAs(1, 0.7, 1);
    fake.run.losing.add(index);
    await page.keyboard.press(".");
    await showsAs(2, 0.4, 0.6);
    fake.run.losing.clear();
    await page.keyboard.press(".");
    await showsAs(1, 0.7, 1);
    await clickEdge(page, index);
    await showsAs(0, 0.1, 0.69);
    await clickEdge(page, index);
    await showsAs(1, 0.7, 1);
    assert.deepEqual(events(fake), [`cut = [[${pair}]]`, `mend = [[${pair}]]`]);
  },
  async "a run is stopped after a question"({page, fake}) {
    await page.click("#stop");
    await page.click("#confirm-no");
    assert.deepEqual(fake.asked, []);
    await page.click("#stop");
    await page.click("#confirm-yes");
    await until(page, () => mascot.state === "done" && document.getElementById("play").disabled);
    assert.deepEqual(fake.asked, [{ask: "stop"}]);
  },
});

test(
    "a finger names an edge before it is cut, and drags the leader",
    () => watching({size: PHONE}, async ({page, fake}) => {
      await pausedFromAbove(page);
      const index = await edgeInTheOpen(page), [hearer, heard] = fake.run.edges[index];
      await page.touchscreen.tap(...await placeOf(page, "edgeOnScreen", index));
      await until(page, () => !card.hidden);
      assert.match(await page.textContent("#card"), new RegExp(`^${hearer} hears ${heard}, heard`));
      assert.deepEqual(events(fake), []);
      await page.click("#card button");
      await until(page, () => mascot.events.length === 1);
      assert.deepEqual(events(fake), [`cut = [[${hearer}, ${heard}]]`]);
      await swipe(page, await placeOf(page, "agentOnScreen", 4), [40, -30]);
      await until(page, () => mascot.events.length === 2);
      assert.match(events(fake)[1], /^goto = \{ agent = 4,/);
    }));

inOneWindow("keys are tuned:", {
  async "a slider reaches both ends of a range, and every value between them within a step"({page}) {
    const wrong = await page.evaluate(async () => {
      const {Scale} = await import("/panel/scale.js");
      const keys = [
        {min: 0, max: 1000, value: 0.045}, {min: 0, max: 1, value: 0.2}, {min: 1e-3, max: 1e6, value: 3},
        {min: -10, max: 10, value: 0}, {min: 0, max: 100, value: 0}, {min: 1, max: 10_000, value: 12, kind: "integer"}
      ];
      return keys.flatMap((key) => {
        const scale = new Scale(key), {min, max, value} = key;
        const wrong = [[0, min], [Scale.STEPS, max]].filter(([step, end]) => scale.value(step) !== end);
        const found = scale.value(scale.place(value));
        const step = Math.max((max - min) / Scale.STEPS, 0.03 * value);  // of a linear scale, of a logarithmic one
        return Math.abs(found - value) <= (key.max > 50 * value ? 0.03 * value : step) ? wrong :
                                                                                         [...wrong, [key, found]];
      });
    });
    assert.deepEqual(wrong, []);
  },
  async "what the law has comes first, and what is not given last, and empty"({page}) {
    await page.click("#tab-tune");
    const keys = await page.locator("#tune .key").evaluateAll((rows) => rows.map(({dataset}) => dataset.key));
    assert.deepEqual([keys[0], keys.at(-1)], ["law.p_gain", "law.safety.distance_m"]);
    const box = page.locator("[data-key='law.safety.distance_m'] input[type=number]");
    assert.equal(await box.inputValue(), "");
    assert.equal(await box.getAttribute("placeholder"), "not given");
  },
  async "numbers of the agents one by one, in place of one for all, are a list in a box"({page}) {
    const row = page.locator("[data-key='law.reach_m']");
    assert.equal(await row.locator("input").inputValue(), "[0.5,1,1.5]");
  },
  async "a slider sets a gain, for one agent if asked"({page, fake}) {
    await page.keyboard.press("2");
    await page.click("#tab-tune");
    const row = page.locator("[data-key='law.p_gain']");
    await row.locator("input[type=range]").focus();
    await page.keyboard.press("ArrowRight");
    await until(page, () => mascot.events.length === 1);
    const now = Number(await row.locator("input[type=number]").inputValue());
    assert.ok(now > 0.35 && now < 0.37, `one step is ${now}`);
    assert.equal(events(fake)[0], `set = { "law.p_gain" = ${now} }`);
    await page.check("#tune-only");
    await row.locator("input[type=number]").fill("0.5");
    await page.keyboard.press("Enter");
    await until(page, () => mascot.events.length === 2);
    assert.equal(events(fake)[1], `set = { "law.p_gain" = 0.5 }\nagents = [2]`);
  },
  async "a refusal is shown in the server's words, and the value stays what it is"({page}) {
    const row = page.locator("[data-key='law.p_gain']");
    const words = "event by hand: law.p_gain: expected a number in [0, 1000], got 5000";
    await row.locator("input[type=number]").fill("5000");
    await page.keyboard.press("Enter");
    await until(page, () => mascot.lastAnswer?.granted === false);
    assert.equal(await row.locator(".refusal").textContent(), words);
    assert.ok((await page.textContent(".notice.refused")).includes(words));
    await row.locator("input[type=number]").blur();
    assert.equal(await row.locator("input[type=number]").inputValue(), "0.5");
    assert.equal(await page.evaluate(() => mascot.events.length), 2);
  },
  async "what single agents have of their own is told, and is shown for the agent that is tuned alone"({page, fake}) {
    const row = page.locator("[data-key='law.beta']"), own = row.locator(".own"),
          box = row.locator("input[type=number]");
    assert.ok(await own.isHidden());
    fake.run.own["law.beta"] = [{agent: 2, value: 0.25}, {agent: 4, value: 3}];
    await page.uncheck("#tune-only");
    await page.locator("[data-key='law.p_gain'] input[type=number]").fill("0.6");
    await page.keyboard.press("Enter");
    await until(page, () => mascot.events.length === 3);
    assert.equal(await own.textContent(), "agent 2: 0.25; agent 4: 3");
    assert.equal(await box.inputValue(), "1.1");
    await page.check("#tune-only");  // 2 is chosen
    assert.equal(await box.inputValue(), "0.25");
    await page.uncheck("#tune-only");
    assert.equal(await box.inputValue(), "1.1");
  },
  async "events are listed with their ticks, to be copied as TOML"({page, fake}) {
    await page.context().grantPermissions(["clipboard-read", "clipboard-write"]);
    await page.click("#tab-events");
    const {tick, toml} = fake.run.events.at(-1);
    assert.ok((await page.textContent("#events")).includes(`tick ${tick}`));
    await page.click(".event button");
    await until(page, () => document.querySelector(".notice.granted:last-child")?.textContent.includes("Copied"));
    assert.equal(await page.evaluate(() => navigator.clipboard.readText()), toml);
  },
});

test(
    "what is granted while the run is paused is pending in the list of events until it goes on",
    () => watching({run: {waits: true}}, async ({page}) => {
      await pausedFromAbove(page);
      await page.click("#tab-events");
      await clickEdge(page, await edgeInTheOpen(page));
      await until(page, () => document.querySelectorAll("#events .event").length === 1);
      const words = await page.textContent("#events");
      assert.match(words, /^pending takes effect at tick \d+/);
      assert.ok(words.includes("cut = [["));
      assert.equal(await page.textContent("#event-count"), "1 pending");
      await page.keyboard.press("Space");
      await until(page, () => mascot.events.length === 1);
      assert.match(await page.textContent("#events"), /tick \d+/);
      assert.ok(!(await page.textContent("#events")).includes("pending"));
      assert.equal(await page.locator("#events .event").count(), 1);
      assert.equal(await page.textContent("#event-count"), "1");
    }));

test(
    "a second click on an edge undoes the first, also while that is pending",
    () => watching({run: {waits: true}}, async ({page, fake}) => {
      await pausedFromAbove(page);
      const index = await edgeInTheOpen(page);
      const place = await placeOf(page, "edgeOnScreen", index);
      for (const clicks of [1, 2, 3]) {
        await page.mouse.click(...place);
        await until(
            page, (words) => document.getElementById("tip").textContent.endsWith(words),
            clicks % 2 ? ", will be cut: click to mend" : ", will be mended: click to cut");
        assert.equal(await page.textContent("#event-count"), `${clicks} pending`);
      }
      assert.deepEqual(events(fake).map((toml) => toml.split(" ")[0]), ["cut", "mend", "cut"]);
    }));

test("the menu of layers closes by Escape, which keeps the chosen agent, and by a press anywhere else", async () => {
  await watching({}, async ({page}) => {
    await page.keyboard.press("2");
    const isOpen = () => page.evaluate(() => document.getElementById("layers").open);
    for (const close of [() => page.keyboard.press("Escape"), () => page.click("#agents"), () => page.click("#name")]) {
      await page.click("#layers summary");
      assert.ok(await isOpen());
      await page.click("#layer-list label");
      assert.ok(await isOpen(), "a layer is chosen in it");
      await close();
      assert.ok(!await isOpen());
    }
    await page.keyboard.press("2");
    await page.click("#layers summary");
    await page.keyboard.press("Escape");
    assert.equal(await page.evaluate(() => mascot.selected), 2);
    await page.keyboard.press("Escape");
    assert.equal(await page.evaluate(() => mascot.selected), 0);
  });
});

test("the labels of an axis all differ, however little the values do", async () => {
  const curve = {name: "messages", unit: "", meaning: "", decays: false, agrees: false, since_s: 0, predicted: null};
  for (const [base, swing] of [[5.4, 1e-3], [1e-3, 1e-4], [120, 40]])
    await watching(
        {run: {source: "recording", curve, law_value: (t_s) => base + swing * Math.sin(t_s)}}, async ({page}) => {
          await until(page, () => document.querySelectorAll("#law .dygraph-axis-label-y").length > 1);
          const labels = await page.locator("#law .dygraph-axis-label-y").allTextContents();
          assert.equal(new Set(labels).size, labels.length, `${labels}`);
          const times = await page.locator("#law .dygraph-axis-label-x").allTextContents();
          assert.equal(new Set(times).size, times.length, `${times}`);
        });
});

test(
    "places of a formation are drawn around its leader",
    () => watching({run: {places_m: 3}}, async ({page}) => {
      await until(page, () => mascot.tick > 0);
      const [place, leader] = await page.evaluate(() => [mascot.placeOf(4), mascot.positions.slice(9, 12)]);
      place.forEach((x, axis) => assert.ok(Math.abs(x - leader[axis]) < 1e-9, `${place} and ${leader}`));
    }));

test("three speeds of many agents are named by their colours", async () => {
  for (const [agents, words] of [[8, null], [9, "fastestmeanslowestselected"]])
    await watching({run: {agents}}, async ({page}) => {
      await until(page, () => mascot.tick > 0);
      const names = page.locator("#speed-names");
      assert.equal(await names.isVisible() ? await names.textContent() : null, words);
    });
});

test("vehicles are shown with what happens to them, and are asked to take off and to land", async () => {
  const fake = await startFake();
  const rows = (page) =>
      page.locator("#vehicles li")
          .evaluateAll(
              (items) =>
                  items.map(({children}) => [...children].map((child) => child.hidden ? "" : child.textContent)));
  for (const size of [WIDE, PHONE]) {
    fake.asked.length = 0;
    fake.tellVehicles([]);
    const {page, troubles} = await open(browser, fake.url, {size});
    await until(page, () => mascot.tick > 0);
    assert.ok(!await page.isVisible("#vehicles"), "no agent has one");
    assert.ok(await page.isEnabled("#play"));
    fake.tellVehicles([
      {agent: 1, phase: "found", words: "found: PX4 1.18, at [0.00, 0.00, 0.00]"},
      {agent: 2, phase: "absent", words: "absent: its heading is unknown"}
    ]);
    await until(page, () => mascot.vehicles.length === 2);
    assert.deepEqual(
        await rows(page),
        [["1", "found", "PX4 1.18, at [0.00, 0.00, 0.00]", ""], ["2", "absent", "its heading is unknown", ""]]);
    for (const id of ["#play", "#step"]) assert.ok(await page.isDisabled(id), `vehicles cannot wait: ${id}`);
    assert.ok(!await page.isVisible('#vehicles button:text-is("Land all")'), "none flies");
    await page.click('#vehicles button:text-is("Take off")');
    fake.tellVehicles(
        [{agent: 1, phase: "flying", words: "flying"}, {agent: 2, phase: "lost", words: "lost: it has tumbled"}]);
    await until(page, () => mascot.vehicles[0].phase === "flying");
    assert.deepEqual(await rows(page), [["1", "flying", "", "Land"], ["2", "lost", "it has tumbled", ""]]);
    assert.ok(!await page.isVisible('#vehicles button:text-is("Take off")'), "none stands on the ground");
    await page.click("#vehicles li button:visible");
    await page.click('#vehicles button:text-is("Land all")');
    await until(page, () => mascot.lastAnswer?.request.agent === 0);
    assert.deepEqual(fake.asked, [{ask: "start"}, {ask: "land", agent: 1}, {ask: "land", agent: 0}]);
    assert.deepEqual(troubles, []);
    await page.context().close();
  }
  await fake.stop();
});

test("who only watches sees everything, is told so, and can change nothing", async () => {
  const fake = await startFake({steer: "t0k"});
  const {page} = await open(browser, fake.url);
  await until(page, () => mascot.tick > 0 && !document.getElementById("watching").hidden);
  for (const id of ["play", "step", "pace", "stop"])
    assert.ok(await page.evaluate((name) => document.getElementById(name).disabled, id), id);
  await page.click("#tab-tune");
  assert.match(await page.textContent("#tune"), /^This page only watches\. At this time the run has:law\./);
  assert.equal(await page.locator("#tune input").count(), 0);
  await page.click("#tab-agents");
  await page.locator("#scene").focus();
  await page.keyboard.press("3");
  await until(page, () => document.querySelector("#detail h3")?.textContent.startsWith("Agent 3"));
  assert.equal(await page.locator("#fault-open").count(), 0);
  const [x, y] = await placeOf(page, "edgeOnScreen", await edgeInTheOpen(page));
  await page.mouse.click(x, y);
  await page.keyboard.press("Space");
  await until(page, () => document.querySelector(".notice.refused")?.textContent.includes("this view only watches"));
  assert.deepEqual(fake.asked, []);
  await page.context().close();

  const steering = await open(browser, `${fake.url}#steer=t0k`);
  await until(steering.page, () => mascot.tick > 0 && document.getElementById("watching").hidden);
  await steering.page.keyboard.press("Space");
  await isPaused(steering.page);
  assert.deepEqual(fake.asked, [{ask: "pause"}]);
  await steering.page.context().close();
  await fake.stop();
});

// --- recordings and connections ----------------------------------------------------------------------------

test(
    "a recording is played, sought and not changed",
    () =>
        watching({run: {source: "recording", own: {"law.p_gain": [{agent: 2, value: 0.5}]}}}, async ({page, fake}) => {
          assert.equal(await page.locator("#marks i").count(), 2);
          const title = (k) => page.locator("#marks i").nth(k).getAttribute("title");
          assert.match(await title(0), /^event 1\n/);
          assert.match(await title(1), /^event 2 by hand\n/);
          const widths =
              await page.locator("#marks i").evaluateAll((marks) => marks.map(({offsetWidth}) => offsetWidth));
          assert.ok(widths[1] > 2 * widths[0], `a dot and a bar: ${widths}`);
          assert.deepEqual(await page.locator("#events .event .badge").allTextContents(), ["by hand", "file"]);
          fake.run.events[1].by_hand = null;
          fake.tellEvents();
          await until(page, () => document.querySelectorAll("#events .event .badge").length === 1);
          assert.match(await title(1), /^event 2\n/);
          assert.ok(await page.locator("#stop").isHidden());
          await page.locator("#seek").fill("30");
          await until(page, () => Math.abs(mascot.t_s - 30) < 0.02);
          await page.locator("#scene").focus();
          await page.keyboard.press("Shift+ArrowRight");
          await until(page, () => mascot.tick === 3100);
          await page.keyboard.press("ArrowLeft");
          await until(page, () => mascot.tick === 3099);
          await page.keyboard.press("PageUp");
          await until(page, () => mascot.tick === 2099);
          await page.locator("#marks i").nth(1).click();
          await until(page, () => mascot.tick === 3200);
          await page.selectOption("#pace", "100");
          await page.keyboard.press("Space");
          await until(page, () => mascot.t_s > 40);
          await page.click("#tab-tune");
          assert.match(await page.textContent("#tune"), /cannot be changed/);
          assert.match(await page.textContent("[data-key='law.p_gain']"), /0\.35.*agent 2: 0\.5$/);
          assert.equal(await page.locator("#tune input").count(), 0);
          assert.deepEqual(events(fake), []);
        }));

test("what a recorded run came up against is marked on its time line, and is sought by a click", () => {
  const incidents = `t_s,until_s,what,count,agent,with,detail
12,12,contact,1,3,obstacle 2,1.25 m/s
24.5,31,acceleration_limit,70,2,,
32,32,event,1,,event 1,"set = { ""law.p_gain"" = 0.2, x = 1 }"
`;
  return watching({run: {source: "recording", incidents}}, async ({page}) => {
    const marks = page.locator("#marks i.incident");
    assert.equal(await marks.count(), 2);
    assert.equal(await marks.nth(0).getAttribute("title"), "12.00 s: contact of agent 3, obstacle 2, 1.25 m/s");
    assert.equal(await marks.nth(1).getAttribute("title"), "24.50 s: acceleration limit of agent 2, until 31.00 s");
    assert.equal(await page.locator("#marks i").count(), 4);  // with two events
    await marks.nth(0).click();
    await until(page, () => mascot.tick === 1200);
  });
});

test(
    "the selected agent of a recording has the commands that replay it",
    () => watching({run: {source: "recording"}}, async ({page}) => {
      await page.click("#table .row[data-agent='2']");
      const commands = page.locator("#detail .to-type code");
      await until(page, () => document.querySelectorAll("#detail .to-type").length === 2);
      assert.deepEqual(
          await commands.allTextContents(),
          ["orchestrator replay 'runs/made up' --to 2", "orchestrator replay 'runs/made up' --speed 1"]);
      await page.locator("#detail .to-type button").first().click();
      await until(page, () => /Copied|Selected/.test(document.querySelector("#detail .to-type button").textContent));
    }));

test("a team that has left the picture is looked at again", async () => {
  const isSeen = (page) => page.evaluate(() => {
    const {clientWidth, clientHeight} = document.getElementById("scene");
    return mascot.experiment.agents.some(({id}) => {
      const [x, y] = mascot.agentOnScreen(id);
      return x >= 0 && x <= clientWidth && y >= 0 && y <= clientHeight;
    });
  });
  const sees = async (page, wanted) => {
    for (const end = Date.now() + 60_000; Date.now() < end && await isSeen(page) !== wanted;)
      await page.evaluate(() => new Promise(requestAnimationFrame));
    assert.equal(await isSeen(page), wanted);
  };
  await watching({run: {source: "recording", drift_m_per_s: 50}}, async ({page}) => {
    await until(page, () => mascot.drawn.pictures > 1);
    await sees(page, true);
    await page.locator("#scene").focus();
    await page.keyboard.press("PageDown");
    await until(page, () => mascot.t_s === 10);
    await sees(page, true);
  });
});

test("incidents that are near each other share a mark of the time line", async () => {
  const rows = Array.from({length: 3000}, (_, k) => `${(k / 50).toFixed(2)},${(k / 50).toFixed(2)},late_command,1,3,,`);
  const incidents = `t_s,until_s,what,count,agent,with,detail\n${rows.join("\n")}\n`;
  await watching({run: {source: "recording", incidents}}, async ({page}) => {
    const marks = page.locator("#marks i.incident");
    assert.equal(await marks.count(), 150);
    const lines = (await marks.nth(1).getAttribute("title")).split("\n");
    assert.equal(lines.length, 6);
    assert.equal(lines[0], "0.40 s: late command of agent 3");
    assert.equal(lines[5], "and 15 more until 0.78 s");
  });
});

test(
    "a recording that was cut says so, and its time line ends at the cut",
    () => watching({run: {source: "recording", end_s: 40, loss: "the file ends inside a record"}}, async ({page}) => {
      assert.equal(await page.textContent("#source"), "recording, cut");
      assert.equal(await page.getAttribute("#source", "title"), "the file ends inside a record");
      assert.equal(await page.textContent("#duration"), "/ 40.00 s of 60.00 s");
      await page.locator("#scene").focus();
      for (let k = 0; k < 5; ++k) await page.keyboard.press("PageDown");
      await until(page, () => mascot.t_s === 40);
    }));

test("the first look shows where a formation will be, though all start near its middle", async () => {
  const radii = [];
  for (const places_m of [0, 100]) {
    await watching({run: {places_m}}, async ({page}) => {
      await until(page, () => mascot.drawn.pictures > 0 && mascot.tick > 0);
      radii.push(await page.evaluate(() => mascot.radiusOnScreen(1)));
    });
  }
  assert.ok(radii[1] < 0.3 * radii[0], `${radii}`);
});

test(
    "a rate that theory has of the slowest mode alone is said, and drawn by this name from where the curve begins",
    () => watching({run: {rate_per_s: null, why: "agents settle after their leader"}}, async ({page}) => {
      await until(page, () => mascot.drawn.disagreement?.length > 0);
      assert.equal(await page.textContent("#prediction"), "Theory: in the long run decays at 0.150 1/s or faster");
      const [, measured, theory, ideal, mode] = await page.evaluate(() => mascot.drawn.disagreement);
      assert.ok(measured > 0 && mode > 0);
      assert.deepEqual([theory, ideal], [null, null]);
    }));

test("theory's response is drawn phase by phase, and where there is none, none", async () => {
  const responses = [
    {from_s: 0, until_s: 20, every_s: 1, of_ideal_bodies: false, value_m: [8, 4, 2, 1, 0.5, 0.25]},
    {from_s: 20, until_s: 30, every_s: 10, of_ideal_bodies: true, value_m: [3, 0.03]}
  ];
  await watching({run: {source: "recording", responses}}, async ({page}) => {
    await until(page, () => mascot.drawn.chartRows > 500);
    const at = (t_s) => page.evaluate((t) => mascot.drawn.disagreementAt(t).slice(2), t_s);
    const near = (values, wanted) => values.forEach(
        (value, k) => assert.ok(wanted[k] === null ? value === null : Math.abs(value - wanted[k]) < 1e-9, `${values}`));
    near(await at(3), [1, null, null]);
    near(await at(0.5), [8 * Math.SQRT1_2, null, null]);
    near(await at(6), [null, null, null]);
    near(await at(25), [null, 0.3, null]);
    assert.match(await page.textContent("#prediction"), /^Theory: decays at /);
    const [mode] = (await at(40)).slice(2);
    assert.ok(mode > 0, "after the last response the slowest mode goes on");
  });
});

test("what is drawn beside disagreement is named, also where theory has no rate", async () => {
  const responses = [{from_s: 0, until_s: 60, every_s: 60, of_ideal_bodies: true, value_m: [3, 0.03]}];
  await watching({run: {responses, rate_per_s: null, slowest_per_s: null}}, async ({page}) => {
    await until(page, () => mascot.tick > 0);
    assert.equal(await page.textContent("#prediction"), "Ideal bodies, flown ahead by the same laws");
  });
});

test("a curve that counts has no decimals", async () => {
  const curve = {name: "messages", unit: "", meaning: "", decays: false, agrees: true, since_s: 0, predicted: null};
  await watching({run: {curve, law_value: () => 57}}, async ({page}) => {
    await until(page, () => document.getElementById("law-now").textContent === "57");
  });
});

test(
    "a law's own figure comes first, with its unit, its prediction and, where agents do not agree, nothing else",
    async () => {
      const curve = {
        name: "coverage cost",
        unit: "m^2",
        meaning: "mean square distance",
        decays: false,
        agrees: false,
        since_s: 0,
        predicted: {figure: "cost_end_m2", value: 20, bound: "at_most"}
      };
      await watching({run: {curve, law_value: (t_s) => 20 / (1 + t_s)}}, async ({page}) => {
        await until(page, () => document.querySelectorAll("#law canvas").length > 0);
        assert.equal(await page.textContent("#law-name"), "Coverage cost");
        assert.match(await page.textContent("#law-now"), /^\d+\.\d+ m²$/);
        assert.equal(await page.textContent("#law-words"), "Theory: cost_end_m2 at most 20.00 m²");
        const [t_s, value, predicted] = await page.evaluate(() => mascot.drawn.curve);
        assert.ok(Math.abs(value - 20 / (1 + t_s)) < 1e-6);
        assert.equal(predicted, 20);
        assert.ok(await page.isHidden("#disagreement-chart"));
        const [law, speed] = await page.evaluate(
            () => ["law-chart", "speed-chart"].map((id) => document.getElementById(id).getBoundingClientRect().top));
        assert.ok(law < speed);
      });
      await watching({run: {curve: {...curve, agrees: true}, law_value: () => 3}}, async ({page}) => {
        await until(page, () => document.querySelectorAll("#law canvas, #disagreement canvas").length > 1);
      });
    });

test("the curve of a law that took over from another begins with it", async () => {
  const curve = {name: "lag", unit: "m", meaning: "", decays: true, agrees: false, since_s: 20, predicted: null};
  await watching({run: {source: "recording", curve, law_value: (t_s) => 1 + t_s}}, async ({page}) => {
    await until(page, () => mascot.drawn.chartRows > 500);
    assert.deepEqual(await page.evaluate(() => mascot.drawn.curveFrom), [20, 21, null]);
  });
});

test("the curves of a recording are whole at once, and a line marks the time that is shown", async () => {
  await watching({run: {source: "recording"}}, async ({page}) => {
    await until(page, () => mascot.drawn.chartRows > 500 && document.querySelectorAll("#speed canvas").length > 0);
    assert.equal(await page.evaluate(() => mascot.t_s), 0);
    const cursor = () => page.evaluate(() => mascot.drawn.cursor);
    assert.equal(await cursor(), 0);
    await page.locator("#scene").focus();
    await page.keyboard.press("PageDown");
    await until(page, () => mascot.t_s > 0 && mascot.drawn.cursor === mascot.t_s);
  });
});

test("a page that is opened late has the curves from the start", async () => {
  await watching({}, async ({page, fake}) => {
    await until(page, () => mascot.t_s > 1);
    const late = await open(browser, fake.url);
    await until(late.page, () => mascot.drawn.chartRows > 5);
    assert.ok(await late.page.evaluate(() => mascot.drawn.firstRow_s) < 0.2);
    await late.page.context().close();
  });
});

test("a lost connection is said, and mended by itself, also to another run", async () => {
  const first = await startFake({agents: 5});
  const {page} = await open(browser, first.url);
  await first.stop();
  await until(page, () => !mascot.connected && !banner.hidden);
  assert.match(await page.textContent("#banner"), /connection is lost/);
  const isGrey = (isDisabled) => ["play", "step", "pace", "stop"].every(
      (id) => document.getElementById(id).disabled === isDisabled);
  assert.ok(await page.evaluate(isGrey, true));
  const second = await startFake({agents: 3, port: first.port, session: "2", name: "the next"});
  await until(page, () => mascot.connected && mascot.drawn.agents === 3 && banner.hidden);
  assert.equal(await page.textContent("#name"), "the next");
  await until(page, isGrey, false);
  await page.context().close();
  await second.stop();
});

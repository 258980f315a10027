// The page on a real run, ten agents over DDS in real time, and on a real recording, watched by a real browser.
import assert from "node:assert/strict";
import {test} from "node:test";

import {launch, open} from "./browser.mjs";
import {startRecording, startRun} from "./real_run.mjs";

test("the page of a run shows its agents, who hears whom, and how long it has flown", async () => {
  const browser = await launch(), run = await startRun("leader_follower.toml", "--set", "run.name=watched");
  try {
    const {page, troubles} = await open(browser, run.url);
    const until = (condition, argument) => page.waitForFunction(condition, argument, {timeout: 60_000});
    const seen = await page.evaluate(() => ({tick: mascot.tick, p: mascot.positions}));
    await until((tick) => mascot.tick > tick + 50, seen.tick);
    await until(() => mascot.edgeStates.every((state) => state === 1));
    const {drawn, positions, experiment} =
        await page.evaluate(() => ({drawn: mascot.drawn, positions: mascot.positions, experiment: mascot.experiment}));
    assert.equal(drawn.agents, 10);
    assert.equal(drawn.edges, 13);
    assert.ok(positions.some((x, k) => Math.abs(x - seen.p[k]) > 0.01), "positions stay");
    assert.equal(experiment.name, "watched");
    assert.deepEqual(experiment.agents.filter(({leads}) => leads).map(({id}) => id), [4]);
    assert.deepEqual(troubles, []);
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

test("the page of a recording goes where it is asked to, and shows what was so at that time", async () => {
  const browser = await launch(), recording = await startRecording(FLOWN);
  try {
    const {page, troubles} = await open(browser, recording.url);
    const until = (condition, argument) => page.waitForFunction(condition, argument, {timeout: 60_000});
    await until(() => mascot.experiment.live_keys.length > 0 && mascot.state === "paused");
    const first = await page.evaluate(() => mascot.positions);
    assert.equal(await page.locator("#marks i").count(), 2);
    const gain = () => page.textContent("[data-key='law.p_gain'] b");
    assert.equal(await gain(), "0.100");
    await page.locator("#seek").fill("15");
    await until(() => mascot.tick === 1500 && mascot.edgeStates[1] === 0);
    await until(() => document.querySelector("[data-key='law.p_gain'] b").textContent === "0.300");
    await page.locator("#scene").focus();
    await page.keyboard.press("ArrowLeft");
    await until(() => mascot.tick === 1499);
    await until(() => document.querySelector("[data-key='law.p_gain'] b").textContent === "0.100");
    await page.selectOption("#pace", "100");
    await page.keyboard.press("Space");
    await until(() => mascot.tick === 2000 && mascot.state === "paused");
    await page.locator("#seek").fill("0");
    await until(() => mascot.tick === 0 && mascot.edgeStates.length === 3);
    assert.deepEqual(await page.evaluate(() => mascot.positions), first);
    assert.deepEqual(troubles, []);
  } finally {
    await recording.stop();
    await browser.close();
  }
});

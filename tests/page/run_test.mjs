// The page on a real run: ten agents over DDS, in real time, watched by a real browser.
import assert from "node:assert/strict";
import {test} from "node:test";

import {launch, open} from "./browser.mjs";
import {startRun} from "./real_run.mjs";

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

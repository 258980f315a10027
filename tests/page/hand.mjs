// What a hand does on the page, on made-up runs and on real ones.

export const until = (page, condition, argument) => page.waitForFunction(condition, argument, {timeout: 60_000});
export const isPaused = (page) => until(page, () => mascot.state === "paused");

/** Where in the window an agent, or the middle of an edge, is. */
export async function placeOf(page, what, number) {
  const [x, y] = await page.evaluate(([name, k]) => mascot[name](k), [what, number]);
  const box = await page.locator("#scene").boundingBox();
  return [box.x + x, box.y + y];
}

/** The edge whose middle is farthest from all agents. */
export const edgeInTheOpen = (page) => page.evaluate(() => {
  const agents = mascot.experiment.agents.map(({id}) => mascot.agentOnScreen(id));
  const room = mascot.experiment.edges.map((_, index) => {
    const [x, y] = mascot.edgeOnScreen(index);
    return Math.min(...agents.map(([ax, ay]) => Math.hypot(ax - x, ay - y)));
  });
  return room.indexOf(Math.max(...room));
});

export async function pausedFromAbove(page) {
  await page.evaluate(() => {
    globalThis.answered = mascot.lastAnswer;
  });
  await page.keyboard.press("Space");
  await isPaused(page);
  // The rows before a pause may come after the state. A real run's answer names the last one.
  await until(page, () => {
    const answer = mascot.lastAnswer, last = /paused after tick (\d+)/.exec(answer?.words);
    return answer !== globalThis.answered && (!last || mascot.tick === Number(last[1]));
  });
  await page.keyboard.press("t");
  // The picture with this view is drawn before the second of these: one that was under way may come in between.
  await page.evaluate(() => new Promise((drawn) => requestAnimationFrame(() => requestAnimationFrame(drawn))));
}

/** Drags an agent by 80 pixels to the right and 40 up. */
export async function drag(page, number) {
  const [x, y] = await placeOf(page, "agentOnScreen", number);
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.mouse.move(x + 30, y - 20, {steps: 2});
  await page.mouse.move(x + 80, y - 40, {steps: 2});
  await page.mouse.up();
}

/** Waits until an edge has this state and is drawn with an opacity between `low` and `high`. */
export const edgeShowsAs = (page, index, state, low, high) => until(page, ([k, wanted, from, to]) => {
  const [, , , alpha] = mascot.edgeLook(k);
  return mascot.edgeStates[k] === wanted && alpha > from && alpha < to;
}, [index, state, low, high]);

/** Clicks an edge, and takes the mouse away, so that the edge is drawn as others are. */
export async function clickEdge(page, index) {
  const [x, y] = await placeOf(page, "edgeOnScreen", index);
  await page.mouse.click(x, y);
  await page.mouse.move(x, y - 200);
}

#!/usr/bin/env node
// Makes the pictures of the page that the documents have, from runs that are flown now:
//   tests/page/pictures.mjs [FOLDER]     docs/pictures/ unless given
import {execFileSync} from "node:child_process";
import {join} from "node:path";
import {fileURLToPath} from "node:url";

import {launch, open, PHONE, WIDE} from "./browser.mjs";
import {startRun} from "./real_run.mjs";

const FOLDER = process.argv[2] ?? fileURLToPath(new URL("../../docs/pictures", import.meta.url));
// A picture with a palette is a third of the size.
const FEW_COLOURS = `
import sys
from PIL import Image
Image.open(sys.argv[1]).convert("RGB").quantize(256, dither=Image.Dither.NONE).save(sys.argv[1], optimize=True)`;
// Name, experiment, tick from which on, keys that are pressed, window.
const PICTURES = [
  ["live", "formation.toml", 500, "2", {size: WIDE, colorScheme: "light"}],
  ["live_phone", "minmax.toml", 700, "3v", {size: PHONE, colorScheme: "dark"}],
];

const browser = await launch({fine: true});
for (const [name, config, tick, keys, window] of PICTURES) {
  // Slowly: without a graphics card, drawing takes the processor that the agents fly by.
  const run = await startRun(config, "--set", "run.pace=0.5");
  const {page, troubles} = await open(browser, run.url, window);
  for (const key of keys) await page.keyboard.press(key);
  await page.waitForFunction((least) => mascot.tick >= least, tick, {timeout: 120_000});
  const path = join(FOLDER, `${name}.png`);
  await page.screenshot({path});
  execFileSync("/usr/bin/python3", ["-c", FEW_COLOURS, path]);
  await page.context().close();
  await run.stop();
  console.log(name, ...troubles);
}
await browser.close();

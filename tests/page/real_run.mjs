// The page of the real program: on a run over DDS, and on a recording.
import {spawn} from "node:child_process";
import {once} from "node:events";
import {mkdtemp, readFile, rm, writeFile} from "node:fs/promises";
import {tmpdir} from "node:os";
import {join} from "node:path";
import {createInterface} from "node:readline";
import {fileURLToPath} from "node:url";

import {within} from "./waits.mjs";

const ROOT = fileURLToPath(new URL("../..", import.meta.url));
const BINARIES = process.env.MASCOT_BINARY_DIR ?? join(ROOT, "build/release");
const ORCHESTRATOR = join(BINARIES, "orchestrator");

/**
 * Starts an experiment of configs/, in lockstep and at one simulated second a second unless `options` say otherwise.
 * Returns the address of its page; `ended`, which gives its exit code once it has ended; `read`, to read a file of its
 * results; and `stop`, which ends it and throws its results away.
 */
export async function startRun(config, ...options) {
  const folder = await mkdtemp(join(tmpdir(), "mascot-page-"));
  return serve(folder, ["up", join(ROOT, "configs", config), "--view", "--out", join(folder, "run"), ...options]);
}

/** Starts an experiment that is given as TOML; likewise. */
export async function startRunOf(toml, ...options) {
  const {folder, file} = await written(toml);
  return serve(folder, ["up", file, "--view", "--out", join(folder, "run"), ...options]);
}

/** Switches on a PX4 that is not there, with these options. Returns what switches it off. */
export function switchOnPx4(...options) {
  const vehicle = spawn(join(BINARIES, "fake_px4"), options, {stdio: "ignore"});
  return () => vehicle.kill("SIGKILL");
}

/** Flies an experiment, given as TOML, as fast as it goes, and serves its recording with these options; likewise. */
export async function startRecording(toml, ...options) {
  const {folder, file} = await written(toml);
  const flight = spawn(
      ORCHESTRATOR,
      ["up", file, "--engine", "inprocess", "--set", "output.save_plot=false", "--out", join(folder, "run"), "--quiet"],
      {stdio: ["ignore", "ignore", "inherit"]});
  await within("the end of a flight", once(flight, "exit"));
  return serve(folder, ["view", join(folder, "run"), ...options]);
}

/** The text of an experiment of configs/. */
export const textOf = (config) => readFile(join(ROOT, "configs", config), "utf8");

async function written(toml) {
  const folder = await mkdtemp(join(tmpdir(), "mascot-page-")), file = join(folder, "flown.toml");
  await writeFile(file, toml);
  return {folder, file};
}

async function serve(folder, words) {
  const run = spawn(ORCHESTRATOR, words, {stdio: ["ignore", "ignore", "pipe"]});
  const exit = once(run, "exit").then(([code]) => code), name = `the end of orchestrator ${words.join(" ")}`;
  const stop = async () => {
    run.kill("SIGINT");
    try {
      await within(name, exit);
    } finally {
      run.kill("SIGKILL");
      await rm(folder, {recursive: true});
    }
  };
  try {
    return {
      url: await within("the address of a page", addressOf(run)),
      ended: () => within(name, exit),
      read: (file) => readFile(join(folder, "run", file), "utf8"),
      stop,
    };
  } catch (error) {
    await stop();
    throw error;
  }
}

/** The address that a run prints. */
async function addressOf(run) {
  const lines = createInterface({input: run.stderr}), said = [];
  return new Promise((found, failed) => {
    lines.on("line", (line) => {
      said.push(line);
      const [, url] = line.match(/^view\s+(http\S+)/) ?? [];
      if (url) found(url);
    });
    lines.on("close", () => failed(new Error(`no address in:\n${said.join("\n")}`)));
  });
}

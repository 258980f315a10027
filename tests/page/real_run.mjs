// The page of the real program: on a run over DDS in real time, and on a recording.
import {spawn} from "node:child_process";
import {once} from "node:events";
import {mkdtemp, rm, writeFile} from "node:fs/promises";
import {tmpdir} from "node:os";
import {join} from "node:path";
import {createInterface} from "node:readline";
import {fileURLToPath} from "node:url";

const ROOT = fileURLToPath(new URL("../..", import.meta.url));
const ORCHESTRATOR = join(process.env.MASCOT_BINARY_DIR ?? join(ROOT, "build/release"), "orchestrator");

/**
 * Starts an experiment of configs/. Its results are thrown away. Returns the address of its page, and how to stop it.
 */
export async function startRun(config, ...options) {
  const folder = await mkdtemp(join(tmpdir(), "mascot-page-"));
  return serve(folder, [
    "up", join(ROOT, "configs", config), "--set", "run.mode=realtime", "--view", "--out", join(folder, "run"),
    ...options
  ]);
}

/** Flies an experiment, given as TOML, as fast as it goes, and serves its recording; likewise. */
export async function startRecording(toml) {
  const folder = await mkdtemp(join(tmpdir(), "mascot-page-")), file = join(folder, "flown.toml");
  await writeFile(file, toml);
  const flight = spawn(
      ORCHESTRATOR,
      ["up", file, "--engine", "inprocess", "--set", "output.save_plot=false", "--out", join(folder, "run"), "--quiet"],
      {stdio: ["ignore", "ignore", "inherit"]});
  await once(flight, "exit");
  return serve(folder, ["view", join(folder, "run")]);
}

async function serve(folder, words) {
  const run = spawn(ORCHESTRATOR, words, {stdio: ["ignore", "ignore", "pipe"]});
  const ended = once(run, "exit");
  const stop = async () => {
    run.kill("SIGINT");
    await ended;
    await rm(folder, {recursive: true});
  };
  try {
    return {url: await addressOf(run), stop};
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

#!/usr/bin/python3
"""Tries agents on aarch64, by qemu, on experiments.
scripts/arm64 fly [FILE...]: flies them over DDS with all agents on aarch64, and compares each recording with a flight in one
  process of this machine.
scripts/arm64 replay [FILE...]: flies them in one process of this machine, and lets each of their agents live through the
  recording on aarch64: its decisions must be those recorded.
Exit code 1 if a bit differs, or a run fails."""

import json
import pathlib
import re
import subprocess
import sys
import tempfile
import time
import tomllib

ROOT = pathlib.Path(__file__).resolve().parent.parent
ORCHESTRATOR = ROOT / "build/release/orchestrator"
LIMIT_S = 20  # of simulated time, more if events come later
OF_USERS = re.compile(r'^name\s*=\s*"(custom|octave|plugin|fmu)"', re.MULTILINE)  # laws whose bits are not promised
WAIT_S = 600  # for all agents to start, or one to decide: qemu computes about ten times slower than the processor
ON_ARM64 = f"'{ROOT / 'scripts/arm64'}' run '{ROOT / 'build/arm64/agent'}'"
HAND = re.compile(r"^waiting for: agent (.*)\n", re.MULTILINE)


def inline(value):
    """A value in TOML, on one line."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return '"' + value.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n") + '"'
    if isinstance(value, list):
        return "[" + ", ".join(map(inline, value)) + "]"
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {inline(one)}" for key, one in value.items()) + " }"
    return repr(value)


def started_by_up(event):
    """Agents of which `up` starts a fresh process at an event, as it does only of those that it has started."""
    fault = event.get("fault", {})
    return {fault["agent"]} if fault.get("kind") in ("kill", "hang") else {event.get("restart")}


def agents_of(experiment):
    return range(1, 1 + (experiment["agents"].get("count") or len(experiment["agents"]["position_m"])))


def duration_of(experiment):
    last_event_s = max((event["at_s"] for event in experiment.get("events", [])), default=0)
    return min(max(LIMIT_S, last_event_s), experiment["run"]["duration_s"])


def by_hand(experiment):
    """Options of `up` by which the agents of an experiment are started by hand."""
    overrides = {override["id"]: override for override in experiment["agents"].get("override", [])}
    for agent in set(agents_of(experiment)).difference(*map(started_by_up, experiment.get("events", []))):
        overrides.setdefault(agent, {"id": agent})["host"] = "external"
    return ["--set", f"agents.override={inline(list(overrides.values()))}", "--set", f"run.start_timeout_s={WAIT_S}",
            "--set", f"run.agent_timeout_s={WAIT_S}"]


def start(words):
    """An agent, with these arguments, on aarch64."""
    words = words.replace("THIS-HOST", "127.0.0.1").split()
    return subprocess.Popen([ROOT / "scripts/arm64", "run", ROOT / "build/arm64/agent", *words, "--transport", "udp"],
                            stderr=subprocess.DEVNULL)


def fly(path, folder):
    """Flies an experiment. Returns what failed, in words; empty: nothing did."""
    experiment = tomllib.loads(path.read_text())
    duration = ["--set", f"run.duration_s={duration_of(experiment)}"]
    command = [ORCHESTRATOR, "up", path, "--out", folder, *duration, *by_hand(experiment)]
    agents = {}  # by their command
    with open(folder.with_suffix(".log"), "w+") as log:
        up = subprocess.Popen(command, stdout=log, stderr=subprocess.STDOUT)
        try:
            while (code := up.poll()) is None:
                for words in HAND.findall(pathlib.Path(log.name).read_text()):
                    if words not in agents:
                        agents[words] = start(words)
                time.sleep(0.1)
        finally:
            for process in [*agents.values(), up]:
                if process.poll() is None:
                    process.terminate()
                process.wait()
    if code != 0:
        return f"exit code {code}\n{pathlib.Path(log.name).read_text()}"
    verified = subprocess.run([ORCHESTRATOR, "verify", folder], capture_output=True, text=True)
    print(verified.stdout.strip(), flush=True)
    return "" if verified.returncode == 0 else verified.stdout + verified.stderr


def replay(path, folder):
    """Lets the agents of an experiment live through its recording. Returns what failed, in words; empty: nothing did."""
    experiment = tomllib.loads(path.read_text())
    flown = subprocess.run([ORCHESTRATOR, "up", path, "--out", folder, "--quiet", "--engine", "inprocess",
                            "--duration-s", str(duration_of(experiment))], capture_output=True, text=True)
    if flown.returncode != 0:
        return flown.stderr
    ticks = 0
    for agent in agents_of(experiment):
        replayed = subprocess.run([ORCHESTRATOR, "replay", folder, "--to", str(agent), "--json", "--agent", ON_ARM64],
                                  capture_output=True, text=True)
        if replayed.returncode != 0:
            return f"agent {agent}: exit code {replayed.returncode}\n{replayed.stdout}{replayed.stderr}"
        ticks += json.loads(replayed.stdout)["ticks"]
    print(f"{path.stem}: {ticks} ticks of {len(agents_of(experiment))} agents", flush=True)
    return ""


def main():
    trial = {"fly": fly, "replay": replay}[sys.argv[1]]
    paths = [pathlib.Path(path) for path in sys.argv[2:]] or sorted((ROOT / "configs").glob("*.toml"))
    failed = 0
    for path in paths:
        if OF_USERS.search(path.read_text()):
            print(f"{path.stem}: left out, because its law is not built in", flush=True)
            continue
        with tempfile.TemporaryDirectory() as folder:
            words = trial(path, pathlib.Path(folder) / path.stem)
        print(f"{path.stem}: {'FAILED: ' + words if words else 'the same, bit for bit'}", flush=True)
        failed += bool(words)
    sys.exit(1 if failed else 0)


main()

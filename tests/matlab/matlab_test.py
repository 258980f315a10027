#!/usr/bin/python3
"""MATLAB's side of a team, matlab/+mascot, in Octave: mascot.Team beside a client of the same protocol in Python,
mascot.read_run beside Python's mascot.load, the S-function with stub blocks, and the examples. Takes octave and
octave-instrument-control; ends with code 77 without them, which ctest counts as skipped."""

import contextlib
import json
import os
import pathlib
import random
import re
import shutil
import socket
import subprocess
import sys
import tempfile
import threading
import time
import unittest
import zipfile

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = pathlib.Path(os.environ["MASCOT_BINARY_DIR"]).resolve()
sys.path[:0] = [str(ROOT / "tests/orchestrator/serving"), str(BUILD / "python")]
import serve_test  # noqa: E402
import mascot  # noqa: E402

SKIPPED = 77  # SKIP_RETURN_CODE of CMakeLists.txt
LIMIT_S = 200
# The engines of `orchestrator serve`, with the options of mascot.Team that choose them.
ENGINES = {"inprocess": [], "dds": ["engine", "dds"]}
TEAM = serve_test.TEAM.replace("position_m = [[0, 0, 1], [4, 0, 1], [0, 3, 1]]",
                               "random = { min_m = [0, 0, 1], max_m = [9, 9, 3] }")
FAILING = serve_test.TEAM.replace('"consensus"', '''"custom"
python = """
def control(t, me, neighbours):
    return [0, 0, 1 / (3 - round(100 * t))]
"""''')


def as_matlab(value):
    """A value as an expression of MATLAB's language."""
    if isinstance(value, (list, tuple)):
        return "{" + ", ".join(map(as_matlab, value)) + "}"
    return repr(value) if isinstance(value, (int, float)) else "'" + str(value).replace("'", "''") + "'"


def octave(function, *arguments, matlab=ROOT / "matlab"):
    run(f"{function}({', '.join(map(as_matlab, arguments))});", matlab)


def left_in(folder):
    """What is left there once servers that were told to end have had the time to."""
    deadline = time.monotonic() + LIMIT_S
    while os.listdir(folder) and time.monotonic() < deadline:
        time.sleep(0.02)
    return os.listdir(folder)


def run(code, matlab=ROOT / "matlab"):
    folders = [matlab, matlab / "examples", ROOT / "tests/matlab"]
    text = f"addpath({', '.join(map(as_matlab, folders))});\n{code}"
    path = f"{BUILD}:{os.environ['PATH']}"
    with tempfile.TemporaryDirectory(prefix="mascot-octave-") as temporary:
        done = subprocess.run(["octave-cli", "--norc", "--quiet", "--eval", text], capture_output=True, text=True,
                              timeout=LIMIT_S, env={**os.environ, "TMPDIR": temporary, "PATH": path})
        left = left_in(temporary)
    if done.returncode:
        raise AssertionError(f"{code}: {done.stderr}")
    if left:
        raise AssertionError(f"{code} leaves files: {left}")


def options(engine):
    """Those of mascot.Team that start a server of this build."""
    return ["orchestrator", BUILD / "orchestrator", *ENGINES[engine]]


def lines_of(path):
    return [json.loads(line) for line in path.read_text().splitlines()]


def as_written(state):
    """A state as docs/serve.md has it, in the form of write_state.m."""
    numbers = [sum(row, []) for row in zip(state["p"], state["v"], state["attitude"], state["w"])]
    return {"tick": state["tick"], "t": state["t_s"], "over": int(state["over"]), "failed": int(state["failure"] != ""),
            "numbers": numbers, "heard": state["heard"], "lost": state["lost"],
            "figures": list(state["figures"].values())}


class Teams(serve_test.Served):
    def setUp(self):
        super().setUp()
        self.team.write_text(TEAM)

    def for_each_engine(self):
        for engine in ENGINES:
            with self.subTest(engine=engine):
                yield engine

    def test_have_the_bits_of_the_protocol(self):
        for engine in self.for_each_engine():
            folder = self.folder / engine
            folder.mkdir()
            octave("steps", self.team, options(engine), folder)
            expected, answers = [], []
            more = [word if word != "engine" else "--engine" for word in ENGINES[engine]]
            more += ["--ports", "1,2", "--seed", "3", "--set", "run.on_agent_loss=drop"]
            with self.client(self.team, *more) as client:
                ask = client.ask

                def note(state):
                    self.assertNotIn("error", state)
                    expected.append(as_written(state))

                answers += [client.about["name"], [1, 2], client.about["rate_hz"]]
                note(ask("look"))
                note(ask("step", actions=[[1 / 3, -0.1, 0], [0, 0.2, 1e-3]], ticks=3))
                note(ask("step"))
                note(ask("step", ticks=2))
                kept = ask("snapshot")["snapshot"]
                note(ask("step", actions=[[0.5, 0, 0], [0, 0.5, 0]]))
                note(ask("restore", snapshot=kept))
                note(ask("step", ticks=5))
                note(ask("restore", snapshot=kept))
                answers.append(ask("set", set={"law.p_gain": 1 / 7}, agents=[3])["tick"])
                note(ask("look"))
                note(ask("step", ticks=4))
                answers.append(ask("set", set={"law.p_gain": 0.3, "law.beta": 0.7})["tick"])
                answers.append(ask("event", event={"fault": {"agent": 2, "kind": "kill"}})["tick"])
                note(ask("step", ticks=4))
                note(ask("reset", seed=4, set={"law.p_gain": 0.1, "graph.topology": "ring"}))
                note(ask("step", ticks=7))
                note(ask("reset", seed=4, set={}, ports=[3]))
                answers.append([3])
                note(ask("step", actions=[0.1, 0.2, 0.3], ticks=1000))
            self.assertEqual(lines_of(folder / "states"), expected)
            self.assertEqual(lines_of(folder / "answers")[:-1], answers)
            recording = pathlib.Path(lines_of(folder / "answers")[-1])
            self.assertEqual(recording.parent, folder / "episodes")
            subprocess.run([BUILD / "orchestrator", "verify", recording], check=True, capture_output=True,
                           timeout=LIMIT_S)

    def test_mistakes_are_told_in_words(self):
        failing = self.folder / "failing.toml"
        failing.write_text(FAILING)
        silent, pid = self.folder / "silent", self.folder / "pid"
        silent.write_text(f"#!/bin/sh\necho not yet >&2\necho $$ > '{pid}'\nexec sleep 1000\n")
        silent.chmod(0o755)
        for engine in self.for_each_engine():
            octave("mistakes", self.team, options(engine), self.folder, failing, silent)
            self.await_end_of(int(pid.read_text()))

    def test_give_their_options_to_the_server(self):
        program, noted = self.folder / "it's a program", self.folder / "noted"
        program.write_text(f"#!/bin/sh\nprintf '%s\\n' \"$@\" > '{noted}'\necho error: as asked >&2\nexit 2\n")
        program.chmod(0o755)
        octave("words", program)
        self.assertEqual(noted.read_text().splitlines(), [
            "serve", "it's $HOME.toml", "--once", "--json", "--at", "127.0.0.1:0", "--ports", "1,12,3", "--seed",
            "9007199254740992", "--out", 'a "b"', "--engine", "dds", "--set", "run.duration_s=0.10000000000000001",
            "--set", "law.axes=xyz", "--set", "agents.position_m=[[1,2,3],[4,5,0.33333333333333331]]", "--set",
            "output.save_plot=false"])

    def await_end_of(self, process):
        deadline = time.monotonic() + LIMIT_S
        while pathlib.Path(f"/proc/{process}").exists():
            self.assertLess(time.monotonic(), deadline, "a server is left")
            time.sleep(0.01)

    def test_join_servers_that_run(self):
        leader = '"consensus"\nleader = 1\nleader_waypoints_m = [[9, 0, 1]]'
        self.team.write_text(serve_test.TEAM.replace('"consensus"', leader))
        with contextlib.ExitStack() as stack:
            address, _ = stack.enter_context(self.server(self.team, once=False))
            silent = stack.enter_context(socket.create_server(("127.0.0.1", 0)))  # nobody accepts
            closing = stack.enter_context(socket.create_server(("127.0.0.1", 0)))
            thread = threading.Thread(target=lambda: closing.accept()[0].close())
            thread.start()
            stack.callback(thread.join, LIMIT_S)
            octave("joins", address, *("127.0.0.1:%d" % server.getsockname()[1] for server in (silent, closing)))

    def test_simulink_steps_them(self):
        for engine in self.for_each_engine():
            octave("simulink", self.team, options(engine), self.folder / engine)

    def test_examples_hold_what_they_say(self):
        for engine in self.for_each_engine():
            octave("examples", ROOT / "configs/leaderless.toml", options(engine))

    def test_are_flown_by_the_program_that_is_installed_with_them(self):
        installed = self.folder / "prefix/share/mascot/matlab"
        shutil.copytree(ROOT / "matlab", installed)
        (self.folder / "prefix/bin").mkdir()
        (self.folder / "prefix/bin/orchestrator").symlink_to(BUILD / "orchestrator")
        config = self.folder / "a team that's mine.toml"
        config.write_text(TEAM)
        octave("installed", config, matlab=installed)


class Runs(serve_test.Served):
    def test_are_read_as_in_python(self):
        self.team.write_text(serve_test.TEAM.replace("duration_s = 0.5", "duration_s = 0.5\non_agent_loss='drop'") + """
[[events]]
at_s = 0.1
set = { "law.p_gain" = 0.02, "law.beta" = 0.3 }
[[events]]
at_s = 0.2
fault = { agent = 2, kind = "kill" }
""")
        out = self.up(self.team, "--set", "output.save_plot=false")
        run = mascot.load(out)
        self.check(out, run)
        other = self.folder / "with_mat"
        shutil.copytree(out, other, ignore=shutil.ignore_patterns("states.npz"))
        subprocess.run([BUILD / "orchestrator", "export", other, "--format", "mat"], check=True, capture_output=True,
                       timeout=LIMIT_S)
        self.check(other, run)

    def check(self, folder, run):
        octave("reads", folder, self.folder / "answers")
        lines = lines_of(self.folder / "answers")
        for name, shape, values in lines[:len(run.arrays)]:
            array = np.atleast_2d(run[name])
            array = array.T if name == "t" else array
            self.assertEqual((name, shape), (name, list(array.shape)))
            self.assertEqual(np.array(values, float).tobytes(), array.astype(float).tobytes("F"))
        self.assertEqual({name for name, *_ in lines[:len(run.arrays)]}, set(run.arrays))
        _, names, values = lines[len(run.arrays)]
        self.assertEqual(dict(zip(names, values)), run.figures)
        events = [line[1] for line in lines if line[0] == "event"]
        self.assertGreater(len(events), 1)
        self.assertTrue(any("\n" in event["detail"] or '"' in event["detail"] for event in events), events)
        expected = run.events
        for event in expected:
            event.update({key: float(event[key]) for key in ("t_s", "until_s", "count")})
            event["agent"] = float(event["agent"]) if event["agent"] else ""
        self.assertEqual(events, expected)
        self.assertEqual(lines[-1][1], (folder / "config.toml").read_text())

    def test_of_other_files_are_refused_in_words(self):
        np.savez_compressed(self.folder / "packed.npz", a=np.zeros(9))
        np.savez(self.folder / "whole.npz", a=np.zeros(9))
        np.savez(self.folder / "words.npz", a=np.array(["x"]))
        (self.folder / "cut.npz").write_bytes((self.folder / "whole.npz").read_bytes()[:180])
        (self.folder / "text.npz").write_text("no zip")
        with zipfile.ZipFile(self.folder / "other.npz", "w") as file:
            file.writestr("a.txt", "no array")
        octave("refused", self.folder)


class Page(serve_test.Served):
    def test_shows_code_that_runs(self):
        blocks = re.findall(r"^```matlab\n(.*?)^```$", (ROOT / "docs/matlab.md").read_text(), re.M | re.S)
        steps, = (block for block in blocks if "mascot.Team(" in block)
        config, options = "/usr/share/mascot/configs", "'ports', [1 2]"
        self.assertTrue(config in steps and options in steps)
        run(steps.replace(config, str(ROOT / "configs")).replace(options, f"{options}, 'set', {{'run.duration_s', 1}}"))
        reads, = (block for block in blocks if "mascot.read_run(" in block)
        out = self.up(self.team, "--set", "output.save_plot=false")
        run(re.sub(r"'runs/[^']*'", as_matlab(out), reads).replace("plot(", "isequal("))


class Json(serve_test.Served):
    def test_numbers_keep_their_bits(self):
        dice = random.Random(1)
        numbers = [dice.uniform(-1, 1) * 10.0 ** dice.randint(-300, 300) for _ in range(5000)]
        numbers += [0.1, 5e-324, 1e23, -0.0]
        content = {"list": numbers, "nested": {"a": [0.3, {"b": numbers[0]}], "c": -1.5e-7}, "holes": [1, None, 3],
                   "text": 'a "1.5" \\ 2.5 \n\t \u00e9'}
        (self.folder / "numbers").write_text(json.dumps(content))
        octave("json", self.folder / "numbers", self.folder / "answers")
        (values, nested, text, *others), = lines_of(self.folder / "answers")
        self.assertEqual(np.array(values).tobytes(), np.array(numbers).tobytes())
        self.assertEqual((nested, text), (content["nested"], content["text"]))
        self.assertEqual(others, [True, [], [1], [[1, 2], [3, 4]], 7, [{"a": 1}, {"a": 2}], {"law.p_gain": 0.1}])


if __name__ == "__main__":
    known = "exit(isempty(pkg('list', 'instrument-control')))"
    if shutil.which("octave-cli") is None or subprocess.run(["octave-cli", "--norc", "--eval", known],
                                                            capture_output=True, timeout=LIMIT_S).returncode:
        print("skipped: octave-instrument-control is not there; `scripts/setup --test` installs what the tests need")
        sys.exit(SKIPPED)
    unittest.main()

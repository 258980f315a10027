#!/usr/bin/python3
"""Episodes are runs: record(), fly(), load(), Policy, and the same bits as those of the programs."""

import ctypes
import inspect
import os
import pathlib
import pydoc
import shutil
import signal
import subprocess
import sys
import threading
import typing
import unittest

import numpy as np
from support import BINARIES, LEADERLESS, SOURCES, TestCase, mascot, orchestrator

SHORT = {"run.duration_s": 1.0}
CRASH = """
[run]
duration_s = 3.0
[agents]
count = 2
position_m = [[0, 0, 1.0], [1.5, 0.05, 1.03]]
[graph]
topology = "complete"
"""


def pushes(env, tick):
    return {agent: [np.sin(0.1 * tick + k), np.cos(0.07 * tick), 0.2 * k] for k, agent in enumerate(env.agents)}


def fly(env):
    env.reset()
    states = [env.state()]
    while env.agents:
        env.step(pushes(env, len(states)))
        states.append(env.state())
    return np.array(states)


def quiet_up(*words):
    return orchestrator("up", *words, "--quiet", "--set", "output.save_plot=false")


class Records(TestCase):
    def test_an_episode_is_a_run_folder_like_any_other(self):
        env = mascot.parallel_env(LEADERLESS, set={**SHORT, "link.loss": 0.2, "record.ros_types": True}, dtype="float64")
        env.record("run")
        states = fly(env)
        self.assertEqual(sorted(os.listdir("run")), ["config.toml", "events.csv", "logs", "run.mcap", "states.npz",
                                                     "summary.json"])
        self.assertIn("the same, bit for bit: 101 ticks", orchestrator("verify", "run"))
        self.assertIn("complete", orchestrator("info", "run"))
        orchestrator("plot", "run")
        self.assertTrue(pathlib.Path("run/paths.png").exists())
        shutil.copytree("run", "other")
        orchestrator("compare", "run", "other")
        run = mascot.load("run")
        np.testing.assert_array_equal(run["position"], states[:, :, :3])
        np.testing.assert_array_equal(np.load("run/states.npz")["position"], states[:, :, :3])

    def test_it_takes_the_episode_that_begins_and_no_other(self):
        env = mascot.parallel_env(LEADERLESS, set=SHORT)
        env.reset(seed=5)
        env.record("five")  # of this one: it has not moved yet
        fly_on = pushes(env, 0)
        env.step(fly_on)
        with self.assertRaisesRegex(mascot.ConfigError, "expected one recording at a time, got another one before the episode"):
            env.record("again")
        env.reset(seed=6)
        env.step(fly_on)
        env.close()
        run = mascot.load("five")
        self.assertEqual(run.config["run"]["seed"], 5)
        self.assertEqual(len(run["t"]), 2)
        self.assertEqual(run.config["run"]["duration_s"], 0.01)  # it ended there
        self.assertIn("the same, bit for bit: 2 of 101 ticks", orchestrator("verify", "five"))
        env.reset(seed=7)
        env.step(fly_on)
        env.record("next")
        env.reset(seed=8)
        fly(env)
        self.assertEqual(len(mascot.load("next")["t"]), 101)
        self.assertNotEqual(mascot.load("next").config["run"]["seed"], 7)

    def test_a_folder_of_a_run_is_not_overwritten_unless_forced(self):
        env = mascot.parallel_env(LEADERLESS, set=SHORT)
        env.record("run")
        fly(env)
        with self.assertRaisesRegex(mascot.ConfigError, r"^folder run: expected a new or empty folder, got one with files in it "
                                    r"\(force=True replaces those of an earlier run, and keeps others\)$"):
            env.record("run")
        with self.assertRaisesRegex(mascot.ConfigError, "^out run: expected a new or empty folder"):
            mascot.fly(LEADERLESS, set=SHORT, out="run")
        env.record("run", force=True)
        fly(env)

    def test_events_by_hand_and_losses_are_in_it(self):
        env = mascot.parallel_env(LEADERLESS, set={**SHORT, "run.on_agent_loss": "hold"})
        env.record("run")
        env.reset()
        for tick in range(100):
            if tick == 10:
                env.event(set={"control.max_acceleration_m_per_s2": 0.5})
            if tick == 20:
                env.event(fault={"agent": 2, "kind": "kill"})
            env.step(pushes(env, tick))
        self.assertIn("the same, bit for bit: 101 ticks", orchestrator("verify", "run"))
        details = [event["detail"] for event in mascot.load("run").events if event["what"] == "event"]
        self.assertEqual([("set" in detail, "kill" in detail) for detail in details], [(True, False), (False, True)])

    def test_a_restored_episode_is_recorded_from_its_start(self):
        env = mascot.parallel_env(LEADERLESS, set=SHORT)
        env.reset()
        for tick in range(30):
            env.step(pushes(env, tick))
        snapshot = env.snapshot()
        env.record("run")
        env.restore(snapshot)
        while env.agents:
            env.step(pushes(env, 0))
        self.assertIn("the same, bit for bit: 101 ticks", orchestrator("verify", "run"))

    def test_one_of_many(self):
        envs = mascot.vector_env(LEADERLESS, 3, 2, set=SHORT)
        envs.record(1, "run")
        envs.reset(seed=4)
        for _ in range(120):
            envs.step(np.ones(envs.action_space.shape))
        self.assertEqual(mascot.load("run").config["run"]["seed"], 5)
        self.assertIn("the same, bit for bit: 101 ticks", orchestrator("verify", "run"))


class SameBits(TestCase):
    """Episodes have the bits of MASCOT's programs."""

    def test_a_policy_flies_in_the_environment_as_in_up(self):
        for name in ("policy.toml", "policy.onnx"):
            shutil.copy(SOURCES / "configs" / name, name)
        changes = {"run.duration_s": 2.0, "link.loss": 0.2, "sensors.own.position_std_m": 0.01}
        sets = [word for key, value in changes.items() for word in ("--set", f"{key}={value}")]
        quiet_up("policy.toml", "--engine", "inprocess", "--out", "up", *sets)
        expected = mascot.load("up")["position"]
        policy = mascot.Policy("policy.onnx")

        def by_numpy(observation):
            rows = observation[10:].reshape(-1, 9)
            pull = np.zeros(3)
            for row in rows:
                pull = pull + row[:3] * row[6]
            return pull * (3 / 64) - observation[3:6] * (29 / 32)

        for decide in (policy, by_numpy):
            env = mascot.parallel_env("policy.toml", set=changes, dtype="float64")
            self.assertEqual(policy.metadata["mascot_observation"], env.observation_layout["hash"])
            observations, _ = env.reset()
            positions = [env.state()[:, :3]]
            while env.agents:
                observations = env.step({agent: decide(row) for agent, row in observations.items()})[0]
                positions.append(env.state()[:, :3])
            np.testing.assert_array_equal(positions, expected)

    def test_bodies_that_touch_fly_as_in_the_programs(self):
        """Bullet computes what touches, in a library of its own: with the sines of the module, as in the programs."""
        env = mascot.parallel_env(self.write(CRASH), dtype="float64")
        env.record("run")
        env.reset()
        while env.agents:
            env.step({"agent_1": [1, 0, 0], "agent_2": [-1, 0, 0]})
        self.assertGreater(mascot.load("run").figures["safety.contacts.agents"], 0)
        self.assertIn("the same, bit for bit: 301 ticks", orchestrator("verify", "run"))

    def test_the_rounding_of_somebody_else_does_not_matter(self):
        expected = fly(mascot.parallel_env(LEADERLESS, set=SHORT, dtype="float64"))
        libm = ctypes.CDLL("libm.so.6")
        upward = 0x800 if os.uname().machine == "x86_64" else 0x400000
        env = mascot.parallel_env(LEADERLESS, set=SHORT, dtype="float64")
        env.reset()
        states = [env.state()]
        while env.agents:
            actions = pushes(env, len(states))
            libm.fesetround(upward)
            try:
                env.step(actions)
                self.assertEqual(libm.fegetround(), upward)  # which is left as it was
            finally:
                libm.fesetround(0)
            states.append(env.state())
        np.testing.assert_array_equal(states, expected)

    def test_pythons_own_functions_are_left_alone(self):
        script = ("import math, sys; before = math.sin(1e22); sys.path.insert(0, sys.argv[1]); import mascot; "
                  "assert math.sin(1e22) == before")
        subprocess.run([sys.executable, "-c", script, BINARIES / "python"], check=True, timeout=60)


class Fly(TestCase):
    def test_a_function_is_the_law_of_each_agent(self):
        """The law of the file as a function, in its order of operations: the same bits."""
        def consensus(t, me, neighbours):
            wanted = np.zeros(3)
            for j in neighbours:
                wanted += j.weight * (0.045 * (j.position - me.position))
            return wanted - 0.9 * me.velocity

        run = mascot.fly(LEADERLESS, consensus, set={"run.duration_s": 5.0}, out="run")
        quiet_up(LEADERLESS, "--engine", "inprocess", "--duration-s", "5.0", "--out", "up")
        np.testing.assert_allclose(run["position"], mascot.load("up")["position"], atol=1e-9)
        self.assertIn("the same, bit for bit: 501 ticks", orchestrator("verify", "run"))

    def test_a_law_gets_what_its_agent_measures_and_hears(self):
        seen = []

        def law(t, me, neighbours):
            if me.id == 2:
                seen.append((t, me, neighbours))
            return [0, 0, 0, me.id]

        mascot.fly(LEADERLESS, law, set={"run.duration_s": 0.03, "law.message": 1}, out="run")
        self.assertEqual([t for t, _, _ in seen], [0, 0.01, 0.02])
        self.assertEqual(len({id(me) for _, me, _ in seen}), 1)  # the own agent is the same object at each call
        _, me, neighbours = seen[2]
        self.assertEqual([j.id for j in neighbours], [1, 3, 4])
        self.assertEqual([j.message.tolist() for j in neighbours], [[1], [3], [4]])
        self.assertEqual((me.weight, me.message, me.orientation.shape, neighbours[0].weight), (0, None, (4,), 1))

    def test_a_law_may_return_x_and_y_alone(self):
        run = mascot.fly(LEADERLESS, lambda t, me, neighbours: (1, 0), set=SHORT, out="run", seed=3)
        self.assertEqual(run.config["run"]["seed"], 3)

    def test_without_a_function_the_files_law_flies(self):
        run = mascot.fly(LEADERLESS, set={**SHORT, "output.save_plot": False}, out="run")
        quiet_up(LEADERLESS, "--engine", "inprocess", "--duration-s", "1", "--out", "up")
        self.assertEqual(pathlib.Path("run/run.mcap").read_bytes(), pathlib.Path("up/run.mcap").read_bytes())
        self.assertEqual(run.summary["exit"], 0)

    def test_what_a_law_raises_arrives_and_the_run_up_to_there_is_recorded(self):
        def law(t, me, neighbours):
            if t > 0.1:
                raise KeyError("the map ends here")
            return [0, 0, 0]

        with self.assertRaisesRegex(KeyError, "the map ends here"):
            mascot.fly(LEADERLESS, law, set=SHORT, out="run")
        self.assertEqual(len(mascot.load("run")["t"]), 12)
        with self.assertRaisesRegex(ValueError, "agent 1 at 0.0 s: expected the law to return 3 finite numbers, got"):
            mascot.fly(LEADERLESS, lambda *_: [1], set=SHORT, out="other")

    def test_ctrl_c_ends_a_flight_in_order(self):
        main = threading.main_thread().ident
        with self.assertRaises(KeyboardInterrupt):
            timer = threading.Timer(0, lambda: signal.pthread_kill(main, signal.SIGINT))
            timer.start()
            mascot.fly(LEADERLESS, set={"run.duration_s": 100000.0, "record.topics": [], "output.fidelity": False}, out="run")
        timer.join()

    def test_a_file_of_another_kind_is_refused_in_words(self):
        for changes, words in [({"run.mode": "realtime"}, 'leaderless.toml: expected run.mode = "lockstep", got "realtime"'),
                               ({"law": {"name": "actions"}}, "actions")]:
            with self.assertRaisesRegex(mascot.ConfigError, words):
                mascot.fly(LEADERLESS, set=changes, out="run")

    def test_a_run_that_fails_raises_its_words(self):
        text = CRASH + '\n[[events]]\nat_s = 0.1\nfault = { agent = 2, kind = "kill" }\n'
        with self.assertRaisesRegex(RuntimeError, "tick 10: agent 2"):
            mascot.fly(self.write(text), out="run")
        with self.assertRaisesRegex(RuntimeError, "tick 10: agent 2"):
            mascot.fly("team.toml", lambda *_: [0, 0, 0], out="other")


class Load(TestCase):
    def test_arrays_events_summary_figures(self):
        quiet_up(LEADERLESS, "--engine", "inprocess", "--duration-s", "1", "--out", "runs/one")
        run = mascot.load("runs")
        with np.load("runs/one/states.npz") as arrays:
            self.assertEqual(sorted(run.arrays), sorted(arrays.files))
            for name in arrays.files:
                np.testing.assert_array_equal(run[name], arrays[name])
        self.assertEqual(mascot.load().folder, run.folder)
        self.assertEqual(run.figures["consensus.final_disagreement_m"],
                         run.summary["consensus"]["final_disagreement_m"])
        self.assertEqual(run.loss, "")
        self.assertEqual(repr(run), "Run('runs/one': 101 rows, 4 agents)")
        self.assertEqual(run.config["agents"]["count"], 4)

    def test_what_is_no_recording_is_refused(self):
        with self.assertRaisesRegex(mascot.ConfigError, "nothing"):
            mascot.load("nothing")


class Words(TestCase):
    def test_everything_is_documented_and_typed(self):
        for name in mascot.__all__:
            thing = getattr(mascot, name)
            self.assertTrue(inspect.getdoc(thing), name)
            if inspect.isfunction(thing):
                hints = typing.get_type_hints(thing)
                self.assertEqual(set(inspect.signature(thing).parameters) | {"return"}, set(hints), name)
        page = pydoc.plain(pydoc.render_doc(mascot))
        self.assertIn("All vectors are in the world frame W", page)
        self.assertIn("parallel_env(file", page)

    def test_a_network_that_cannot_be_flown_is_refused(self):
        pathlib.Path("bad.onnx").write_bytes(b"no network")
        with self.assertRaisesRegex(ValueError, "expected"):
            mascot.Policy("bad.onnx")
        policy = mascot.Policy(SOURCES / "configs/policy.onnx")
        with self.assertRaisesRegex(ValueError, r"observation: expected the shape \(..., 37\), got \(3,\)"):
            policy([1, 2, 3])
        self.assertEqual(policy(np.zeros((2, 5, 37))).shape, (2, 5, 3))


class Memory(TestCase):
    def test_it_does_not_grow_over_resets(self):
        env = mascot.parallel_env(LEADERLESS, set={"run.duration_s": 0.02, "link.loss": 0.1})

        def size_kb():
            return int(pathlib.Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGESIZE") // 1024

        def resets(count):
            for _ in range(count):
                env.reset()
                env.step(pushes(env, 0))

        resets(300)
        before = size_kb()
        resets(700)
        self.assertLess(size_kb() - before, 700)  # less than 1 KiB a reset: an episode that stays takes more


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/python3
"""parallel_env(): PettingZoo's rules, what agents observe, rewards, losses, events, seeds, words of errors."""

import inspect
import os
import pickle
import signal
import subprocess
import sys
import threading
import time
import unittest
import urllib.request

import numpy as np
import support
from support import BINARIES, LEADERLESS, TestCase, mascot, orchestrator

SHORT = {"run.duration_s": 0.5}
LOST = """
[run]
duration_s = 1.0
on_agent_loss = "hold"
[agents]
count = 3
position_m = [[0, 0, 1], [5, 0, 2], [0, 5, 3]]
[graph]
topology = "complete"
[[events]]
at_s = 0.2
fault = { agent = 2, kind = "kill" }
[[events]]
at_s = 0.4
restart = 2
"""


def second_with(law):
    """Two agents, of which the second has a law of its own."""
    return f"""
[run]
duration_s = 1.0
[agents]
count = 2
position_m = [[0, 0, 1], [5, 0, 2]]
[[agents.override]]
id = 2
law = {{ {law} }}
[graph]
topology = "complete"
"""


def team(**keys):
    return mascot.parallel_env(LEADERLESS, set={**SHORT, **keys.pop("set", {})}, **keys)


def still(env):
    return {agent: np.zeros(env.action_space(agent).shape) for agent in env.agents}


class Rules(TestCase):
    """What PettingZoo's own tests of an environment look at."""

    def test_an_episode_from_start_to_end(self):
        env = team(set={"link.loss": 0.2, "law.message": 2})
        for _ in range(2):
            observations, infos = env.reset()
            self.assertEqual(env.agents, env.possible_agents)
            self.assertEqual(list(infos), env.agents)
            steps = 0
            while env.agents:
                for agent in env.agents:
                    self.assertIs(env.observation_space(agent), env.observation_space(agent))
                    self.assertIs(env.action_space(agent), env.action_space(agent))
                    self.assertEqual(observations[agent].dtype, np.float32)
                    self.assertTrue(env.observation_space(agent).contains(observations[agent]))
                before = list(env.agents)
                result = env.step({agent: env.action_space(agent).sample() for agent in env.agents})
                observations, rewards, terminations, truncations, infos = result
                for one in result:
                    self.assertEqual(list(one), before)
                self.assertTrue(all(type(reward) is float for reward in rewards.values()))
                self.assertTrue(all(type(end) is bool for end in [*terminations.values(), *truncations.values()]))
                steps += 1
            self.assertEqual(steps, 50)
            self.assertTrue(all(truncations.values()))
            self.assertFalse(any(terminations.values()))
        self.assertEqual(env.step({}), ({}, {}, {}, {}, {}))
        self.assertEqual((env.num_agents, env.max_num_agents), (0, 4))
        self.assertIs(env.unwrapped, env)

    def test_spaces_are_finite_and_their_samples_are_in_them(self):
        env = team(set={"law.message": 2, "sensors.own.position_std_m": 0.1})
        for agent in env.possible_agents:
            for space in (env.observation_space(agent), env.action_space(agent)):
                self.assertTrue(space.is_bounded())
                self.assertTrue(space.contains(space.sample()))
        np.testing.assert_array_equal(env.action_space("agent_1").high, np.float32([3, 3, 3, 1, 1]))
        velocities = team(set={"law.output": "velocity", "control.max_speed_m_per_s": 2.0})
        np.testing.assert_array_equal(velocities.action_space("agent_1").high, np.float32([2, 2, 2]))

    def test_equal_seeds_give_equal_samples_of_a_space(self):
        space = team().action_space("agent_1")
        space.seed(5)
        first = space.sample()
        space.seed(5)
        np.testing.assert_array_equal(first, space.sample())

    def test_a_lost_agent_is_terminated_once_and_does_not_come_back(self):
        env = mascot.parallel_env(self.write(LOST))
        env.reset()
        ended = []
        while env.agents:
            observations, _, terminations, truncations, _ = env.step(still(env))
            self.assertEqual("agent_2" in env.agents, not ended and not terminations["agent_2"])
            ended += [agent for agent, end in terminations.items() if end]
            if "agent_2" in observations and terminations["agent_2"]:
                self.assertAlmostEqual(env.time_s, 0.2)
                self.assertFalse(truncations["agent_2"])
        self.assertEqual(ended, ["agent_2"])
        self.assertEqual(sorted(truncations), ["agent_1", "agent_3"])

    def test_a_loss_that_ends_the_run_terminates_all_and_says_why(self):
        env = mascot.parallel_env(self.write(LOST.replace('"hold"', '"abort"')))
        env.reset()
        while env.agents:
            _, _, terminations, truncations, infos = env.step(still(env))
        self.assertEqual(list(terminations.values()), [True] * 3)
        self.assertEqual(list(truncations.values()), [False] * 3)
        self.assertIn("tick 20: agent 2", infos["agent_1"]["failure"])
        env.reset()
        self.assertEqual(env.agents, env.possible_agents)


class Observations(TestCase):
    def test_an_agent_observes_itself_and_whom_it_hears_alone(self):
        env = mascot.parallel_env(self.write("""
[run]
duration_s = 1.0
[agents]
count = 3
position_m = [[0, 0, 1], [5, 0, 2], [0, 7, 3]]
[graph]
edges = [[1, 2, 0.5], [2, 3]]
"""), dtype="float64")
        observations, _ = env.reset()
        names = env.observation_layout["names"]
        at = {name: k for k, name in enumerate(names)}
        one = observations["agent_1"]
        np.testing.assert_array_equal(one[:3], [0, 0, 1])
        first = at["neighbour[0].p.x"]
        np.testing.assert_array_equal(one[first:first + 3], [5, 0, 1])
        self.assertEqual((one[at["neighbour[0].weight"]], one[at["neighbour[0].heard"]]), (0.5, 1))
        np.testing.assert_array_equal(observations["agent_3"][10:], np.zeros(9))  # it hears nobody
        self.assertEqual(len(one), len(names))

    def test_a_message_is_heard_at_the_next_tick(self):
        env = team(set={"law.message": 1}, dtype="float64")
        env.reset()
        at = env.observation_layout["names"].index("neighbour[0].message[0]")
        heard = []
        for said in (0.25, 0.5, 0.75):
            observations = env.step({a: [0, 0, 0, said] for a in env.agents})[0]
            heard.append(observations["agent_1"][at])
        self.assertEqual(heard, [0.25, 0.5, 0.75])

    def test_noise_range_and_loss_are_in_what_is_observed(self):
        def first(**keys):
            env = team(set=keys, dtype="float64")
            return env.reset(seed=3)[0]["agent_1"], env.observation_layout["names"]

        exact, names = first()
        noisy, _ = first(**{"sensors.own.position_std_m": 0.1})
        deaf, _ = first(**{"link.loss": 1.0})
        heard = [k for k, name in enumerate(names) if name.endswith("heard")]
        self.assertTrue((exact[:3] != noisy[:3]).all())
        self.assertEqual(exact[heard].tolist(), [1, 1, 1])
        self.assertEqual(deaf[heard].tolist(), [0, 0, 0])

    def test_the_state_is_the_whole_true_team(self):
        env = team(set={"sensors.own.position_std_m": 0.5}, dtype="float64")
        env.reset()
        self.assertEqual(env.state().shape, (4, 13))
        self.assertTrue(env.state_space.contains(env.state()))
        np.testing.assert_allclose(np.linalg.norm(env.state()[:, 6:10], axis=1), 1, atol=1e-12)

    def test_an_observation_stays_as_it_was(self):
        env = team()
        first, _ = env.reset()
        copy = first["agent_1"].copy()
        env.step({a: np.ones(3) for a in env.agents})
        np.testing.assert_array_equal(first["agent_1"], copy)

    def test_agents_with_laws_of_their_own_fly_by_them(self):
        env = mascot.parallel_env(self.write(second_with('name = "waypoint", waypoints_m = [[9, 0, 2]]')))
        env.reset()
        self.assertEqual(env.possible_agents, ["agent_1"])
        while env.agents:
            env.step(still(env))
        self.assertGreater(env.state()[1, 0], 5.1)
        self.assertLess(abs(env.state()[0, 0]), 1e-6)

    def test_the_safety_filter_of_the_law_stays(self):
        def nearest(safety):
            env = mascot.parallel_env(self.write(f"""
[run]
duration_s = 4.0
[agents]
count = 2
position_m = [[0, 0, 1], [2, 0, 1]]
[graph]
topology = "complete"
[law]
name = "consensus"
axes = "xyz"
{safety}
"""))
            env.reset()
            distances = []
            while env.agents:
                env.step({"agent_1": [1, 0, 0], "agent_2": [-1, 0, 0]})
                distances.append(np.linalg.norm(np.diff(env.state()[:, :3], axis=0)))
            return min(distances)

        self.assertGreater(nearest("safety = { distance_m = 1.2 }"), 1.1)
        self.assertLess(nearest(""), 1)


class Rewards(TestCase):
    def test_the_default_is_minus_the_disagreement(self):
        env = team(dtype="float64")
        env.reset()
        _, rewards, *_ = env.step(still(env))
        away = env.state()[:, :2] - env.state()[:, :2].mean(axis=0)
        self.assertAlmostEqual(rewards["agent_3"], -np.linalg.norm(away, axis=1).max(), places=12)
        self.assertEqual(len(set(rewards.values())), 1)

    def test_a_function_gets_the_state_and_the_actions(self):
        env = team(reward=lambda p, v, action: p[:, 2] + 10 * action[:, 1], dtype="float64")
        env.reset()
        _, rewards, *_ = env.step({a: [0, k, 0] for k, a in enumerate(env.agents)})
        np.testing.assert_allclose(list(rewards.values()), env.state()[:, 2] + 10 * np.arange(4))

    def test_one_that_fails_in_the_last_step_does_not_hide_that_it_was_the_last(self):
        def fails_late(p, v, actions):
            if env.time_s > 0.45:
                raise KeyError("mine")
            return 0.0

        env = team(reward=fails_late)
        env.reset()
        failed = 0
        while env.agents:
            try:
                env.step(still(env))
            except KeyError:
                failed += 1
        self.assertEqual(failed, 5)
        self.assertEqual(env.time_s, 0.5)

    def test_a_reward_of_another_shape_is_refused(self):
        env = team(reward=lambda p, v, action: p)
        env.reset()
        with self.assertRaisesRegex(ValueError, r"reward: expected a number, or an array of the shape \(4,\), got an array of"):
            env.step(still(env))


class Seeds(TestCase):
    def paths(self, env, *seeds):
        places = []
        for seed in seeds:
            observations, _ = env.reset(seed=seed)
            places.append(observations["agent_1"].tolist())
        return places

    def test_a_seed_is_that_of_the_run_and_the_next_follow_from_it(self):
        env = team()
        one, two, three = self.paths(env, 7, None, None)
        self.assertEqual(self.paths(team(), 7, None, None), [one, two, three])
        self.assertEqual(self.paths(team(seed=7), None, None, None), [one, two, three])
        self.assertEqual(len({str(place) for place in (one, two, three)}), 3)
        self.assertEqual(self.paths(team(set={"run.seed": 7}), None), [one])

    def test_the_first_episode_has_the_seed_of_the_file(self):
        env = team()
        env.reset()
        self.assertEqual(env.episode_seed, 1)

    def test_options_set_keys_of_this_and_the_next_episodes(self):
        env = team()
        env.reset(options={"set": {"run.duration_s": 0.1}, "another": 1})
        for _ in range(2):
            steps = 0
            while env.agents:
                env.step(still(env))
                steps += 1
            self.assertEqual(steps, 10)
            env.reset()


    def test_what_is_refused_does_not_stay(self):
        env = team(seed=5)
        for wrong in ({"link.lost": 3}, {"agents.count": 3}):
            with self.assertRaises(mascot.ConfigError):
                env.reset(options={"set": wrong})
            self.assertEqual(env.agents, [])
        env.reset()
        self.assertEqual(env.episode_seed, 5)
        env.step(still(env))


class Events(TestCase):
    def test_an_event_by_hand_takes_effect_at_the_next_tick(self):
        env = team(dtype="float64")
        env.reset()
        heard = env.observation_layout["names"].index("neighbour[0].heard")
        env.event(cut=[[1, 2]])
        observations = env.step(still(env))[0]
        self.assertEqual(observations["agent_1"][heard], 0)
        self.assertEqual(observations["agent_2"][heard], 1)

    def test_it_may_have_several_keys(self):
        env = team(dtype="float64")
        env.reset()
        env.event(set={"control.max_acceleration_m_per_s2": 0.1}, agents=[1])
        for _ in range(40):
            env.step({agent: [1, 0, 0] for agent in env.agents})
        speeds = env.state()[:2, 3]
        self.assertLess(speeds[0], 0.5 * speeds[1])

    def test_one_that_is_not_legal_is_refused_and_changes_nothing(self):
        env = team()
        env.reset()
        with self.assertRaisesRegex(ValueError, "event by hand: .*max_acceleration"):
            env.event(set={"control.max_accelerations_m_per_s2": 1.0})
        with self.assertRaisesRegex(ValueError, "expected keys of"):
            env.event(law={"name": "consensus"})
        env.step(still(env))


class Snapshots(TestCase):
    def test_a_restored_episode_is_the_same_to_the_last_bit(self):
        env = team(set={"link.loss": 0.3, "sensors.own.position_std_m": 0.1, "law.message": 1}, dtype="float64")
        env.reset(seed=9)
        actions = np.random.default_rng(1).normal(size=(40, 4, 4))

        def fly(steps):
            observed = []
            for step in steps:
                if step == 5:
                    env.event(set={"control.max_acceleration_m_per_s2": 1.0})
                observed.append(list(env.step(dict(zip(env.agents, actions[step])))[0].values()))
            return np.array(observed)

        fly(range(20))
        snapshot = pickle.loads(pickle.dumps(env.snapshot()))
        rest = fly(range(20, 40))
        for _ in range(2):
            env.restore(snapshot)
            self.assertEqual(snapshot.tick, 20)
            np.testing.assert_array_equal(fly(range(20, 40)), rest)
        other = team(set={"link.loss": 0.3, "sensors.own.position_std_m": 0.1, "law.message": 1}, dtype="float64")
        env = other
        env.restore(snapshot)
        np.testing.assert_array_equal(fly(range(20, 40)), rest)

    def test_one_of_another_experiment_is_refused(self):
        env = team()
        env.reset()
        env.step(still(env))
        for other in (team(set={"law.message": 1}), mascot.parallel_env(self.write(LOST))):
            other.reset()
            with self.assertRaisesRegex(ValueError, "expected a snapshot of the same file, with the same keys set, got one of another"):
                other.restore(env.snapshot())
            other.step(still(other))

    def test_who_was_lost_stays_lost(self):
        env = mascot.parallel_env(self.write(LOST))
        env.reset()
        for _ in range(60):
            env.step(still(env))
        snapshot = env.snapshot()
        env.reset()
        env.restore(snapshot)
        self.assertEqual(env.agents, ["agent_1", "agent_3"])


class Mistakes(TestCase):
    def expect(self, words, call, error=ValueError):
        with self.assertRaises(error) as caught:
            call()
        self.assertIn(words, str(caught.exception))

    def test_they_are_told_in_words(self):
        env = team()
        env.reset()
        actions = still(env)
        self.expect("actions: expected one for each of env.agents, got none for 'agent_4'",
                    lambda: env.step({a: actions[a] for a in env.agents[:3]}))
        self.expect("actions: expected one for each of env.agents, got one for 'agent_9'",
                    lambda: env.step({**actions, "agent_9": actions["agent_1"]}))
        self.expect("actions['agent_2']: expected the shape (3,), got (2,)",
                    lambda: env.step({**actions, "agent_2": [1, 2]}))
        self.expect("actions['agent_2']: expected finite numbers",
                    lambda: env.step({**actions, "agent_2": [1, float("nan"), 0]}))
        env.step(actions)  # none of these has done harm
        self.expect("seed: expected an integer in [0, 9223372036854775807], got -1", lambda: env.reset(seed=-1))
        self.expect("seed: expected an integer, got 'one'", lambda: env.reset(seed="one"), TypeError)
        self.expect("dtype: expected float32 or float64, got int32", lambda: team(dtype="int32"))
        self.expect("expected a str, bool, int, float, list or dict for an experiment file, got object",
                    lambda: team(set={"law.message": object()}), TypeError)
        env.close()
        self.expect("event by hand: the episode is over", lambda: env.event(cut=[[1, 2]]))
        self.expect("actions: expected none, because no agent is left", lambda: env.step(actions))

    def test_other_types_are_told_in_words(self):
        env = team()
        env.reset()
        for words, call in [
            ("actions: expected a dict, got list", lambda: env.step([1, 2])),
            ("set: expected a dict, got 'x'", lambda: mascot.parallel_env(LEADERLESS, set="x")),
            ('at: expected a str such as "127.0.0.1:8765", got 8765', lambda: env.view(8765)),
            ("snapshot: expected a mascot.Snapshot, got NoneType", lambda: env.restore(None)),
            ("seed: expected an integer, got 1.7", lambda: mascot.fly(LEADERLESS, seed=1.7)),
        ]:
            with self.assertRaises(TypeError, msg=words) as caught:
                call()
            self.assertEqual(str(caught.exception), words)

    def test_those_of_the_file_have_their_place(self):
        self.expect("set run.duration_s = -1: run.duration_s: expected", lambda: team(set={"run.duration_s": -1}),
                    mascot.ConfigError)
        self.expect("nowhere.toml", lambda: mascot.parallel_env("nowhere.toml"), mascot.ConfigError)
        self.expect('team.toml:3:1: run.duration: unknown key (did you mean "duration_s"?)',
                    lambda: mascot.parallel_env(self.write("\n[run]\nduration = 1\n")), mascot.ConfigError)
        self.expect('expected run.mode = "lockstep", got "realtime"', lambda: team(set={"run.mode": "realtime"}),
                    mascot.ConfigError)
        self.expect("expected agents that take actions, got none: the laws of the file, and what is set, decide for all",
                    lambda: team(set={"law": {"name": "consensus"}}), mascot.ConfigError)
        self.expect("expected an episode with the agents, actions and layout of the first, got others",
                    lambda: team().reset(options={"set": {"graph.topology": "ring"}}), mascot.ConfigError)

    def test_any_text_may_be_set(self):
        for text in ("\U0001f681 \u00e9", 'a "b" \\ c', "tab\tline\nbell\x07del\x7f"):
            with self.assertRaises(mascot.ConfigError) as caught:
                team(set={"law.name": text})
            self.assertNotIn("expected a TOML value", str(caught.exception))

    def test_a_law_in_python_is_not_flown_inside_of_python(self):
        text = second_with('name = "custom", python = "def control(t, me, neighbours): return [0, 0]"')
        self.expect("a law in Python does not fly inside of another program in Python",
                    lambda: mascot.parallel_env(self.write(text)), RuntimeError)


def await_a_step():
    """Returns when the main thread is in the C++ part of step()."""
    lines, first = inspect.getsourcelines(mascot.ParallelEnv.step)
    line = first + next(k for k, text in enumerate(lines) if "self._team.step(" in text)
    deadline = time.monotonic() + 30
    while time.monotonic() < deadline:
        frame = sys._current_frames()[threading.main_thread().ident]
        if (frame.f_code, frame.f_lineno) == (mascot.ParallelEnv.step.__code__, line):
            return
    raise AssertionError("no step within 30 s")


class Pages(TestCase):
    def test_an_episode_is_on_a_page_until_the_environment_is_closed(self):
        env = team()
        address = env.view(":0", pace=0, browser=False)
        self.assertRegex(address, r"^http://127\.0\.0\.1:\d+$")
        self.assertIn("<title>", self.read(address))
        env.reset(seed=3)
        env.step(still(env))
        self.assertIn("<title>", self.read(address))
        env.close()
        with self.assertRaises(OSError):
            self.read(address)

    def test_viewed_and_recorded_it_flies_as_otherwise(self):
        paths = []
        for is_seen in (False, True):
            env = team(dtype="float64")
            if is_seen:
                env.view(":0", pace=0, browser=False)
                env.record("seen")
            env.reset(seed=3)
            path = [env.state()]
            while env.agents:
                env.step({a: [1, 0.5, 0] for a in env.agents})
                path.append(env.state())
            env.close()
            paths.append(path)
        np.testing.assert_array_equal(*paths)
        np.testing.assert_array_equal(mascot.load("seen")["position"], np.array(paths[0])[:, :, :3])
        self.assertIn("the same, bit for bit: 51 ticks", orchestrator("verify", "seen"))

    def test_ctrl_c_ends_the_wait_for_viewers(self):
        env = team()
        env.view(":0", pace=1e-6, browser=False)  # 10000 s a tick
        env.reset()
        def interrupt():
            await_a_step()
            signal.raise_signal(signal.SIGINT)

        interrupts = threading.Thread(target=interrupt)
        interrupts.start()
        with self.assertRaises(KeyboardInterrupt):
            env.step(still(env))
        interrupts.join(60)
        self.assertEqual(env.time_s, 0.01)  # the step is made
        env.close()

    def test_while_a_step_waits_others_may_not_use_the_environment(self):
        env = team()
        env.view(":0", pace=1e-6, browser=False)
        env.reset()
        refused = []

        def disturb():
            await_a_step()
            for use in (env.state, env.reset, env.snapshot, lambda: env.step(still(env)), env.close):
                try:
                    use()
                except RuntimeError as error:
                    refused.append(str(error))
            signal.raise_signal(signal.SIGINT)

        disturbs = threading.Thread(target=disturb)
        disturbs.start()
        with self.assertRaises(KeyboardInterrupt):
            env.step(still(env))
        disturbs.join(60)
        self.assertEqual(refused, ["expected one thread at a time in an environment, got two"] * 5)
        env.state()
        env.close()

    def test_the_browser_is_that_of_the_user(self):
        self.write("#!/bin/sh\necho \"$1\" > opened\n", "browser")
        os.chmod("browser", 0o755)
        code = ("import mascot\n"
                f"env = mascot.parallel_env({LEADERLESS!r})\n"
                "print(env.view(':0', browser={browser}))")
        env = {**os.environ, "BROWSER": os.path.abspath("browser") + " %s", "PYTHONPATH": str(BINARIES / "python")}
        env.pop("WAYLAND_DISPLAY", None)
        for browser, display, opens in (("True", None, True), ("None", ":7", True), ("None", None, False),
                                        ("False", ":7", False)):
            env.pop("DISPLAY", None)
            if display:
                env["DISPLAY"] = display
            done = subprocess.run([sys.executable, "-c", code.format(browser=browser)], env=env, check=True, timeout=60,
                                  stdout=subprocess.PIPE, text=True)
            self.assertEqual(os.path.exists("opened"), opens)
            if opens:
                with open("opened", encoding="utf8") as opened:
                    self.assertEqual(opened.read(), done.stdout)
                os.remove("opened")

    def test_what_cannot_be_is_refused(self):
        env = team()
        expect = self.assertRaisesRegex
        with expect(mascot.ConfigError, "^at: expected .*port"):
            env.view("127.0.0.1:port", browser=False)
        with expect(ValueError, "^pace: expected a number in .*, got -1.0$"):
            env.view(":0", pace=-1, browser=False)
        address = env.view(":0", browser=False)
        with expect(mascot.ConfigError, f"^expected one page at a time, got another one beside {address}$"):
            env.view(":0", browser=False)
        env.close()
        env.view(":0", browser=False)

    @staticmethod
    def read(address):
        # No proxy of the environment is asked for an address of this machine.
        with urllib.request.build_opener(urllib.request.ProxyHandler({})).open(address, timeout=20) as answer:
            return answer.read().decode()


class Processes(TestCase):
    """Forks, and the end of the interpreter."""

    def run_script(self, lines, code=0):
        env = {**os.environ, "PYTHONPATH": str(BINARIES / "python")}
        text = "import mascot, numpy as np, os, sys, threading, time\n" + lines.format(file=repr(LEADERLESS))
        done = subprocess.run([sys.executable, "-c", text], env=env, timeout=60, stdout=subprocess.PIPE, check=False,
                              stderr=subprocess.STDOUT, text=True)
        self.assertEqual(done.returncode, code, done.stdout)
        return done.stdout

    def test_the_interpreter_ends_while_a_thread_is_in_a_step(self):
        for make in ("envs = mascot.vector_env({file}, 64, 1); step = lambda: envs.step(np.zeros((64, 4, 3)))",
                     "envs = mascot.parallel_env({file}, set={{'run.duration_s': 1000.0}}); "
                     "step = lambda: envs.step({{a: np.zeros(3) for a in envs.agents}})",
                     "envs = mascot.parallel_env({file}); envs.view(':0', pace=1e-6, browser=False); "
                     "step = lambda: envs.step({{a: np.zeros(3) for a in envs.agents}})"):
            self.run_script(make + """
envs.reset()
begun = threading.Event()
def fly():
    while True:
        begun.set()
        step()
threading.Thread(target=fly, daemon=True).start()
begun.wait()
sys.exit(7)
""", code=7)

    def test_a_fork_leaves_environments_to_its_parent(self):
        for make in ("env = mascot.parallel_env({file}); env.view(':0', browser=False)",
                     "env = mascot.vector_env({file}, 4, 2)"):
            said = self.run_script(make + """
env.reset()
child = os.fork()
if child == 0:
    try:
        env.reset()
    except RuntimeError as error:
        print(error, flush=True)
    other = mascot.parallel_env({file})
    other.reset()
    sys.exit(3)
assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 3
env.reset()
env.close()
""")
            self.assertEqual(said, "expected an environment that this process has made, got one of its parent\n")

    def test_a_fork_ends_although_a_thread_of_its_parent_was_in_a_step(self):
        self.run_script("""
envs = mascot.vector_env({file}, 1, 1)
envs.reset()
over, begun = threading.Event(), threading.Event()
def fly():
    while not over.is_set():
        envs.step(np.zeros((1, 4, 3)))
        begun.set()
flying = threading.Thread(target=fly)
flying.start()
begun.wait()
for _ in range(20):
    child = os.fork()
    if child == 0:
        sys.exit(3)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 3
over.set()
flying.join()
""")


class TwoAtOnce(TestCase):
    def test_environments_do_not_know_of_each_other(self):
        alone = [self.path(team(dtype="float64"), seed) for seed in (1, 2)]
        envs = [team(dtype="float64") for _ in range(2)]
        paths = [None, None]

        def fly(k):
            paths[k] = self.path(envs[k], k + 1)

        threads = [threading.Thread(target=fly, args=(k,)) for k in range(2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join(60)
        np.testing.assert_array_equal(paths, alone)

    def path(self, env, seed):
        env.reset(seed=seed)
        places = []
        while env.agents:
            env.step({a: [1, 0.5, 0] for a in env.agents})
            places.append(env.state())
        return places

    def test_ctrl_c_in_a_step_ends_the_step_and_the_environment_stays(self):
        env = team()
        env.reset()
        with self.assertRaises(KeyboardInterrupt):
            for _ in range(50):
                signal.raise_signal(signal.SIGINT)
                env.step(still(env))
        self.assertIn("agent_1", env.reset()[0])


if __name__ == "__main__":
    unittest.main()

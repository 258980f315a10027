#!/usr/bin/python3
"""vector_env(): Gymnasium's rules, autoreset modes, seeds, threads, words of errors."""

import os
import threading
import unittest

import numpy as np
import onnx
import support  # noqa: F401: the path of the module
from support import LEADERLESS, SOURCES, TestCase, mascot

SHORT = {"run.duration_s": 0.2, "link.loss": 0.2}
HALF = """
[run]
duration_s = 0.3
on_agent_loss = "abort"
[agents]
count = 2
position_m = [[0, 0, 1], [5, 0, 2]]
[graph]
topology = "complete"
"""
LOSS = '\n[[events]]\nat_s = 0.1\nfault = { agent = 2, kind = "kill" }\n'


def teams(count=3, **keys):
    return mascot.vector_env(LEADERLESS, count, keys.pop("threads", 2), set={**SHORT, **keys.pop("set", {})}, **keys)


class Rules(TestCase):
    def test_shapes_types_and_spaces(self):
        envs = teams(set={"law.message": 2})
        self.assertEqual(envs.single_observation_space.shape, (4, 43))
        self.assertEqual(envs.single_action_space.shape, (4, 5))
        self.assertEqual(envs.observation_space.shape, (3, 4, 43))
        self.assertEqual(envs.action_space.shape, (3, 4, 5))
        self.assertIs(envs.metadata["autoreset_mode"], mascot.AutoresetMode.NEXT_STEP)
        observations, infos = envs.reset(seed=1)
        self.assertEqual(infos, {})
        for _ in range(50):
            self.assertEqual((observations.shape, observations.dtype), ((3, 4, 43), np.float32))
            self.assertTrue(envs.observation_space.contains(observations))
            observations, rewards, terminations, truncations, infos = envs.step(envs.action_space.sample())
            self.assertEqual((rewards.shape, rewards.dtype), ((3,), np.float64))
            self.assertEqual((terminations.dtype, truncations.dtype), (bool, bool))
        envs.close()
        self.assertTrue(envs.closed)

    def test_each_is_the_environment_of_its_seed(self):
        envs = teams(set={"law.message": 1}, dtype="float64")
        alone = [mascot.parallel_env(LEADERLESS, set={**SHORT, "law.message": 1}, dtype="float64") for _ in range(3)]
        together, _ = envs.reset(seed=4)
        for k, env in enumerate(alone):
            np.testing.assert_array_equal(list(env.reset(seed=4 + k)[0].values()), together[k])
        actions = np.random.default_rng(0).normal(size=envs.action_space.shape)
        for _ in range(20):
            together, rewards, *_ = envs.step(actions)
            for k, env in enumerate(alone):
                observations, reward, *_ = env.step(dict(zip(env.agents, actions[k])))
                np.testing.assert_array_equal(list(observations.values()), together[k])
                self.assertEqual(reward["agent_1"], rewards[k])
        np.testing.assert_array_equal(envs.state(), [env.state() for env in alone])

    def test_what_is_computed_does_not_depend_on_threads(self):
        def fly(threads):
            envs = teams(5, threads=threads)
            observed = [envs.reset(seed=2)[0]]
            actions = np.random.default_rng(0).normal(size=(60, *envs.action_space.shape))
            return observed + [envs.step(action)[0] for action in actions]

        one = fly(1)
        np.testing.assert_array_equal(one, fly(2))
        np.testing.assert_array_equal(one, fly(7))

    def test_other_threads_run_meanwhile(self):
        envs = teams(32, set={"run.duration_s": 5.0})
        envs.reset()
        counted, over = [0], threading.Event()

        def count():
            while not over.is_set():
                counted[0] += 1

        thread = threading.Thread(target=count)
        thread.start()
        for _ in range(50):
            envs.step(np.zeros(envs.action_space.shape))
        over.set()
        thread.join()
        self.assertGreater(counted[0], 0)

    def test_what_a_law_throws_in_a_thread_arrives_with_its_words(self):
        model = onnx.load(str(SOURCES / "configs/policy.onnx"))
        answer = model.graph.output[0].name
        for node in model.graph.node:
            node.output[:] = ["before" if name == answer else name for name in node.output]
        model.graph.node.append(onnx.helper.make_node("Sub", ["before", "before"], ["zero"]))
        model.graph.node.append(onnx.helper.make_node("Div", ["zero", "zero"], [answer]))
        onnx.save(model, "bad.onnx")
        law = {"name": "policy", "file": os.path.abspath("bad.onnx")}
        envs = teams(8, set={"agents.override": [{"id": 2, "law": law}]})
        envs.reset()
        for _ in range(2):
            with self.assertRaisesRegex(RuntimeError, "^tick 0: agent 2: .*acceleration is not finite"):
                envs.step(np.zeros(envs.action_space.shape))
            envs.reset()

    def test_each_keeps_its_first_seed_until_it_is_reset(self):
        envs = teams(seed=100)
        for mask in ([True, False, True], [False, True, False]):
            envs.reset(options={"reset_mask": np.array(mask)})
        self.assertEqual(envs.episode_seeds(), [100, 101, 102])
        envs.reset()
        self.assertNotIn(101, envs.episode_seeds())

    def test_seeds_by_number_by_list_and_from_those_before(self):
        envs = teams()
        envs.reset(seed=[5, 9, None])
        self.assertEqual(envs.episode_seeds(), [5, 9, 3])  # the file has 1 for the first
        envs.reset(seed=3)
        self.assertEqual(envs.episode_seeds(), [3, 4, 5])
        envs.reset()
        later = envs.episode_seeds()
        self.assertEqual(len(set(later)), 3)
        without = teams()
        without.reset()
        self.assertEqual(without.episode_seeds(), [1, 2, 3])
        other = teams(seed=3)
        other.reset()
        other.reset()
        self.assertEqual(other.episode_seeds(), later)

    def test_a_reward_is_a_function_of_the_batch(self):
        envs = teams(reward=lambda p, v, action: p[:, :, 2].sum(axis=1) + action[:, 0, 0])
        envs.reset()
        actions = np.zeros(envs.action_space.shape)
        actions[:, 0, 0] = [1, 2, 3]
        rewards = envs.step(actions)[1]
        np.testing.assert_allclose(rewards, envs.state()[:, :, 2].sum(axis=1) + [1, 2, 3], atol=1e-5)


class Autoreset(TestCase):
    def fly(self, mode, steps):
        envs = teams(2, autoreset_mode=mode, dtype="float64")
        envs.reset(seed=1)
        actions = np.zeros(envs.action_space.shape)
        return envs, [envs.step(actions) for _ in range(steps)]

    def test_next_step(self):
        envs, steps = self.fly("NextStep", 22)
        self.assertEqual([bool(step[3].all()) for step in steps[18:]], [False, True, False, False])
        first = teams(2, dtype="float64")
        first.reset(seed=1)
        np.testing.assert_array_equal(steps[20][0], first.reset()[0])  # the step after the end resets,
        np.testing.assert_array_equal(steps[20][1], [0, 0])            # and its action counts for nothing
        self.assertEqual(steps[19][4], {})

    def test_same_step(self):
        envs, steps = self.fly(mascot.AutoresetMode.SAME_STEP, 21)
        _, next_steps = self.fly("NextStep", 21)
        infos = steps[19][4]
        self.assertTrue(steps[19][3].all())
        np.testing.assert_array_equal(infos["_final_obs"], [True, True])
        np.testing.assert_array_equal(np.stack(infos["final_obs"]), next_steps[19][0])
        np.testing.assert_array_equal(steps[19][1], next_steps[19][1])  # the reward is that of the last tick
        np.testing.assert_array_equal(steps[19][0], next_steps[20][0])
        self.assertFalse(steps[20][3].any())

    def test_disabled(self):
        envs, steps = self.fly("Disabled", 20)
        self.assertTrue(steps[19][3].all())
        actions = np.zeros(envs.action_space.shape)
        with self.assertRaisesRegex(ValueError, r"expected a reset\(\) of environment 0 before this step"):
            envs.step(actions)
        before = steps[19][0][1]
        observations, _ = envs.reset(options={"reset_mask": np.array([True, False])})
        np.testing.assert_array_equal(observations[1], before)
        with self.assertRaisesRegex(ValueError, "environment 1"):
            envs.step(actions)
        envs.reset(options={"reset_mask": np.array([False, True])})
        envs.step(actions)

    def test_a_loss_that_ends_the_run_terminates(self):
        envs = mascot.vector_env(self.write(HALF + LOSS), 2, 1, autoreset_mode="SameStep")
        envs.reset()
        for _ in range(10):
            _, _, terminations, truncations, infos = envs.step(np.zeros(envs.action_space.shape))
        self.assertTrue(terminations.all())
        self.assertFalse(truncations.any())
        self.assertIn("tick 10: agent 2", infos["final_info"]["failure"][1])

    def test_agents_that_are_lost_are_told(self):
        envs = mascot.vector_env(self.write((HALF + LOSS).replace("abort", "hold")), 2, 1)
        envs.reset()
        for _ in range(12):
            _, _, terminations, _, infos = envs.step(np.zeros(envs.action_space.shape))
        self.assertFalse(terminations.any())
        np.testing.assert_array_equal(infos["lost"], [[False, True]] * 2)


class Mistakes(TestCase):
    def test_they_are_told_in_words(self):
        envs = teams()
        zeros = np.zeros(envs.action_space.shape)
        for words, call in [
            ("num_envs: expected at least 1, got 0", lambda: teams(0)),
            ("threads: expected at least 1, got 0", lambda: teams(threads=0)),
            ("autoreset_mode: expected 'NextStep', 'SameStep', 'Disabled', got 'never'", lambda: teams(autoreset_mode="never")),
            ("expected a reset() of environment 0 before this step", lambda: envs.step(zeros)),
            ("seed: expected 3 seeds, got 2", lambda: envs.reset(seed=[1, 2])),
            ("seed: expected an integer in [0, 9223372036854775807], got -1", lambda: envs.reset(seed=[1, 2, -1])),
            ("reset_mask: expected 3 bools", lambda: envs.reset(options={"reset_mask": np.zeros(3, bool)})),
            ("actions: expected the shape (3, 4, 3), got (4, 3)", lambda: envs.step(zeros[0])),
            ("actions: expected finite numbers", lambda: (envs.reset(), envs.step(zeros * np.nan))),
        ]:
            with self.assertRaises(ValueError, msg=words) as caught:
                call()
            self.assertIn(words, str(caught.exception))

    def test_other_types_are_told_in_words(self):
        for error, words, call in [
            (TypeError, "num_envs: expected an integer, got 2.5", lambda: teams(2.5)),
            (TypeError, "threads: expected an integer, got 1.0", lambda: teams(threads=1.0)),
            (TypeError, "seed: expected an integer, got 1.5", lambda: teams(seed=1.5)),
            (ValueError, "seed: expected an integer in [0, 9223372036854775807], got -1", lambda: teams(seed=-1)),
            (ValueError, "seed: expected an integer in [0, 9223372036854775807], got 9223372036854775808",
             lambda: teams().reset(seed=2**63 - 1)),
            (TypeError, "env: expected an integer, got 1.0", lambda: teams().record(1.0, "run")),
            (IndexError, "env: expected one from 0 to 2, got -1", lambda: teams().record(-1, "run")),
            (IndexError, "env: expected one from 0 to 2, got 3", lambda: teams().record(3, "run")),
        ]:
            with self.assertRaises(error, msg=words) as caught:
                call()
            self.assertEqual(str(caught.exception), words)

    def test_one_reward_for_each_environment(self):
        envs = teams(reward=lambda p, v, action: 1.0)
        envs.reset()
        with self.assertRaisesRegex(ValueError, r"reward: expected an array of the shape \(3,\), got one of \(\)"):
            envs.step(np.zeros(envs.action_space.shape))

    def test_what_a_law_throws_in_a_thread_arrives_in_its_words(self):
        def text(does):
            return HALF + f"""
[[agents.override]]
id = 2
law = {{ name = "plugin", library = "{support.BINARIES}/tests/plugins/libmirror.so", params = {{ does = "{does}", from_s = 0.1 }} }}
"""

        with self.assertRaisesRegex(mascot.ConfigError, "team.toml:13:.*no map for agent"):
            mascot.vector_env(self.write(text("break")), 4, 2)
        envs = mascot.vector_env(self.write(text("throw")), 4, 2)
        envs.reset()
        with self.assertRaisesRegex(RuntimeError, "agent 2.*the map ends here"):
            for _ in range(20):
                envs.step(np.zeros(envs.action_space.shape))
        envs.reset()
        envs.step(np.zeros(envs.action_space.shape))


if __name__ == "__main__":
    unittest.main()

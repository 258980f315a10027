#!/usr/bin/python3
"""docs/examples/python/learn_consensus.py: its short form learns, and what it writes flies to the same bits everywhere."""

import importlib.util
import os
import re
import subprocess
import sys
import unittest

import numpy as np
from support import BINARIES, SOURCES, TestCase, mascot, orchestrator

EXAMPLE = SOURCES / "docs/examples/python"
LAW = 'law={name="policy", file="policy.onnx"}'


class Learn(TestCase):
    def setUp(self):
        if importlib.util.find_spec("torch") is None:
            self.skipTest("torch is not installed")
        super().setUp()

    def learn(self, generations):
        """Runs the example; returns what it printed: (generation, mean settling time in s)."""
        environment = {**os.environ, "PYTHONPATH": str(BINARIES / "python"), "OMP_NUM_THREADS": "1",
                       "PYTHONDONTWRITEBYTECODE": "1"}
        done = subprocess.run([sys.executable, EXAMPLE / "learn_consensus.py", "policy.onnx", str(generations)], env=environment,
                              text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=240, check=False)
        self.assertEqual(done.returncode, 0, done.stdout)
        found = re.findall(r"^generation (\d+): settles in (\d+\.\d+) s$", done.stdout, re.MULTILINE)
        self.assertEqual(len(done.stdout.splitlines()), len(found), done.stdout)  # no warnings
        return [(int(generation), float(settled_s)) for generation, settled_s in found]

    def test_the_short_form_learns_and_its_policy_flies(self):
        progress = self.learn(20)
        self.assertEqual([generation for generation, _ in progress], [0, 10, 20])
        self.assertEqual(progress[0][1], 6.0)  # untrained teams do not settle while they are watched
        self.assertLess(min(settled_s for _, settled_s in progress), 5.5)

        self.assertIn("hash 4344a9088ad108fe, of agents 1-6",
                      orchestrator("check", EXAMPLE / "six.toml", "--set", LAW))
        orchestrator("up", EXAMPLE / "six.toml", "--set", LAW, "--engine", "inprocess", "--quiet", "--out", "up",
                     "--set", "output.save_plot=false", "--assert", "consensus.final_disagreement_m < 0.1")
        policy = mascot.Policy("policy.onnx")
        env = mascot.parallel_env(EXAMPLE / "six.toml", dtype="float64")
        self.assertEqual(policy.metadata["mascot_observation"], env.observation_layout["hash"])
        observations, _ = env.reset()
        positions = [env.state()[:, :3]]
        while env.agents:
            observations = env.step({agent: policy(row) for agent, row in observations.items()})[0]
            positions.append(env.state()[:, :3])
        np.testing.assert_array_equal(positions, mascot.load("up")["position"])


if __name__ == "__main__":
    unittest.main()

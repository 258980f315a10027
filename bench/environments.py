#!/usr/bin/python3
"""How fast environments in Python are.

  environments.py BUILD CONFIG parallel|vector SECONDS      agent-steps per second, as JSON
  environments.py BUILD CONFIG resets SECONDS               time of a reset, and how far memory grows over 10 000 of them
"""

import json
import os
import pathlib
import sys
import time

import numpy as np

RESETS, SETTLED = 10_000, 1000
ENVIRONMENTS = 16  # for each core


def rate(seconds, agents, step):
    """Agent-steps per second of calls of step()."""
    start, count = time.perf_counter(), 0
    while time.perf_counter() < start + seconds:
        step()
        count += 1
    return count * agents / (time.perf_counter() - start)


def parallel(mascot, config, seconds):
    env = mascot.parallel_env(config)
    env.reset()
    actions = {agent: np.array([0.1, 0.0, 0.0], np.float32) for agent in env.agents}

    def step():
        if not env.agents:
            env.reset()
        env.step(actions)

    return {"agent_steps_per_s": rate(seconds, len(actions), step)}


def vector(mascot, config, seconds):
    envs = mascot.vector_env(config, ENVIRONMENTS * len(os.sched_getaffinity(0)))
    envs.reset(seed=1)
    actions = np.full(envs.action_space.shape, 0.1, np.float32)
    return {"agent_steps_per_s": rate(seconds, actions.shape[0] * actions.shape[1], lambda: envs.step(actions))}


def resets(mascot, config, _seconds):
    env = mascot.parallel_env(config)
    kib = lambda: int(pathlib.Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGESIZE") // 1024
    for count in range(RESETS):
        if count == SETTLED:
            before, start = kib(), time.perf_counter()
        env.reset()
    took = time.perf_counter() - start
    return {"resets": RESETS, "settled": SETTLED, "us_per_reset": 1e6 * took / (RESETS - SETTLED), "grown_kib": kib() - before}


def main():
    build, config, what, seconds = sys.argv[1:]
    sys.path.insert(0, str(pathlib.Path(build) / "python"))
    import mascot

    print(json.dumps({"parallel": parallel, "vector": vector, "resets": resets}[what](mascot, config, float(seconds))))


if __name__ == "__main__":
    main()

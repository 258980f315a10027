"""MASCOT from Python: teams of agents as environments for learning, laws as functions, runs as arrays.

    import mascot

    env = mascot.parallel_env("leaderless.toml", seed=1)     # an environment of PettingZoo
    observations, infos = env.reset()
    while env.agents:
        actions = {agent: env.action_space(agent).sample() for agent in env.agents}
        observations, rewards, terminations, truncations, infos = env.step(actions)

    envs = mascot.vector_env("leaderless.toml", num_envs=16)  # a vector environment of Gymnasium
    run = mascot.fly("leaderless.toml", law=control)          # a function as the law of each agent
    run = mascot.load("runs/leaderless")                      # arrays, events, summary, figures of a run
    policy = mascot.Policy("policy.onnx")                     # a network, computed as agents compute it

All vectors are in the world frame W (x east, y north, z up), in SI units. An episode is a flight in lockstep, to the same bits
as `orchestrator up`. docs/python.md is the guide.
"""
from mascot._core import ConfigError, Snapshot
from mascot._fly import Agent, fly
from mascot._parallel_env import ParallelEnv, parallel_env
from mascot._policy import Policy
from mascot._run import Run, load
from mascot._vector_env import AutoresetMode, VectorEnv, vector_env

__all__ = ["Agent", "AutoresetMode", "ConfigError", "ParallelEnv", "Policy", "Run", "Snapshot", "VectorEnv", "fly", "load",
           "parallel_env", "vector_env"]

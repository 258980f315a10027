"""Many copies of a team as a VectorEnv of Gymnasium."""
from __future__ import annotations

import os
from collections.abc import Sequence
from typing import Any, Mapping

import numpy as np

from mascot import _core
from mascot._parallel_env import Reward
from mascot._spaces import Box, box

try:
    from gymnasium.vector import AutoresetMode
    from gymnasium.vector import VectorEnv as _Base
except ImportError:
    from enum import Enum

    class AutoresetMode(Enum):  # type: ignore[no-redef]
        """When an environment whose episode is over is reset: as Gymnasium names it."""

        NEXT_STEP = "NextStep"
        SAME_STEP = "SameStep"
        DISABLED = "Disabled"

    class _Base:  # type: ignore[no-redef]
        """What Gymnasium's VectorEnv brings, where Gymnasium is not installed."""

        metadata: dict[str, Any] = {}
        spec = None
        render_mode = None
        closed = False
        num_envs: int

        @property
        def unwrapped(self) -> "_Base":
            return self

        def close(self, **options: Any) -> None:
            if not self.closed:
                self.close_extras(**options)
                self.closed = True

        def close_extras(self, **options: Any) -> None:
            pass

        def __repr__(self) -> str:
            return f"{type(self).__name__}(num_envs={self.num_envs})"


class VectorEnv(_Base):
    """Many copies of a team of agents that learn, as Gymnasium's VectorEnv; `mascot.vector_env()` makes one.

    One environment is the whole team: an observation has the shape (A, size), with a row for each of the A agents that learn,
    by increasing number, and so has an action; both are those of `mascot.parallel_env()`. Batches have a further dimension in
    front, of length num_envs. C++ threads compute the environments, while other threads of Python run. What they compute does
    not depend on the number of threads.
    """

    def __init__(self, file: str | os.PathLike[str], num_envs: int = 1, threads: int | None = None, *,
                 seed: int | None = None, set: Mapping[str, Any] | None = None, reward: Reward | None = None,
                 dtype: Any = "float32", autoreset_mode: Any = AutoresetMode.NEXT_STEP) -> None:
        num_envs = _core.count_of("num_envs", num_envs)
        threads = _core.count_of("threads", len(os.sched_getaffinity(0)) if threads is None else threads)
        self._dtype = _core.float_type(dtype)
        self._in_floats = self._dtype == np.float32
        self.autoreset_mode = _mode(autoreset_mode)
        self._teams = _core.core.TeamVector(_core.path_of(file), _core.sets(set), num_envs, threads,
                                            getattr(_core.core.Autoreset, self.autoreset_mode.name),
                                            reward is not None)
        self._about = about = self._teams.about()
        self._reward = reward
        self.num_envs = num_envs
        self._first_seeds: list[int | None] = self._seeds(about["seed"] if seed is None else seed)
        self.render_mode = None
        self.spec = None
        self.closed = False
        self.metadata = {"name": about["name"], "render_modes": [], "render_fps": about["rate_hz"],
                         "autoreset_mode": self.autoreset_mode}
        self.agents = [f"agent_{i}" for i in about["ids"]]
        sizes = [len(high) for high in about["action_high"]]
        if len(dict.fromkeys(sizes)) > 1:
            raise _core.ConfigError(f"{_core.path_of(file)}: expected actions of one length, got {sizes}")
        self.single_observation_space = box(np.tile(about["observation_high"], (len(self.agents), 1)), self._dtype)
        self.single_action_space = box(np.stack(about["action_high"]), self._dtype)
        self.observation_space = _batch(self.single_observation_space, num_envs)
        self.action_space = _batch(self.single_action_space, num_envs)
        self._needs_reset, self._some_need_reset = np.ones(num_envs, bool), True
        self._shape = self.action_space.shape

    @property
    def observation_layout(self) -> dict[str, Any]:
        """What the numbers of an agent's observation are: `text`, `hash` and `names`."""
        return {key: self._about["observation_" + key] for key in ("text", "hash", "names")}

    def reset(self, *, seed: int | Sequence[int | None] | None = None, options: Mapping[str, Any] | None = None
              ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begins episodes. Returns observations (num_envs, A, size) and infos.

        seed: that of the first environment; the others have the following numbers. Or a seed for each. None: the seeds follow
        from those before; at first from the constructor's, or from the file's.
        options: {"set": {key: value}} changes keys of the file, in this and the next episodes; {"reset_mask": array of
        num_envs bools} resets these environments alone. Others are passed over."""
        options = options or {}
        mask = np.asarray(options.get("reset_mask", np.ones(self.num_envs, bool)))
        changes = _core.sets(options["set"]) if "set" in options else None
        if mask.dtype != bool or mask.shape != (self.num_envs,) or not mask.any():
            raise ValueError(f"reset_mask: expected {self.num_envs} bools, one of them true, got {mask}")
        seeds = [first if new is None else new for new, first in zip(self._seeds(seed), self._first_seeds)]
        observations = self._teams.reset(seeds, changes, mask, self._in_floats)
        self._first_seeds = [None if is_reset else first for is_reset, first in zip(mask, self._first_seeds)]
        self._needs_reset &= ~mask
        self._some_need_reset = bool(self._needs_reset.any())
        return observations, {}

    def step(self, actions: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, dict[str, Any]]:
        """Goes on by a tick. Returns observations (num_envs, A, size), rewards (num_envs,), terminations (num_envs,), truncations
        (num_envs,) and infos.

        actions: an array of the shape (num_envs, A, size), finite. What it has for agents that are lost is not looked at.
        infos: "lost" (num_envs, A), which agents are lost; "failure", why a run could not go on; if an episode has ended and
        autoreset_mode is SAME_STEP, "final_obs" and "final_info" of it."""
        actions = np.asarray(actions, dtype=float)
        if actions.shape != self._shape:
            raise ValueError(f"actions: expected the shape {self._shape}, got {actions.shape}")
        if self._some_need_reset:
            raise ValueError(f"expected a reset() of environment {int(self._needs_reset.argmax())} before this step")
        (observations, disagreement, terminations, truncations, was_reset, any_is_over, any_was_reset,
         any_is_lost) = self._teams.step(actions, self._in_floats)
        rewards = -disagreement if self._reward is None else self._rewards(actions)
        if any_was_reset and self.autoreset_mode is AutoresetMode.NEXT_STEP:
            rewards[was_reset] = 0
        if not any_is_over and not any_is_lost:
            return observations, rewards, terminations, truncations, {}
        is_over = terminations | truncations
        if any_is_over and self.autoreset_mode is AutoresetMode.DISABLED:
            self._needs_reset, self._some_need_reset = is_over, True
        return observations, rewards, terminations, truncations, self._infos(terminations, is_over)

    def record(self, env: int, folder: str | os.PathLike[str], force: bool = False) -> None:
        """Records the next episode of environment `env` (from 0), as record() of `mascot.parallel_env()`."""
        if not 0 <= _core.integer("env", env) < self.num_envs:
            raise IndexError(f"env: expected one from 0 to {self.num_envs - 1}, got {env}")
        self._teams.record(env, "folder", _core.path_of(folder), force)

    def state(self) -> np.ndarray:
        """The true state of the teams now, of shape (num_envs, agents of the file, 13), as state() of `mascot.parallel_env()`."""
        return np.stack([self._teams.state(k) for k in range(self.num_envs)]).astype(self._dtype)

    def episode_seeds(self) -> list[int]:
        """run.seed of the episode of each environment."""
        return [self._teams.seed(k) for k in range(self.num_envs)]

    def render(self) -> None:
        """Nothing: record() and `orchestrator view` show an episode."""

    def close_extras(self, **options: Any) -> None:
        """Ends the episodes, and completes their recordings."""
        self._teams.finish()

    def _seeds(self, seed: int | Sequence[int | None] | None) -> list[int | None]:
        if seed is None:
            return [None] * self.num_envs
        if not isinstance(seed, Sequence | np.ndarray):
            return [_core.seed_of(_core.seed_of(seed) + k) for k in range(self.num_envs)]
        seeds = [_core.seed_of(one) for one in seed]
        if len(seeds) != self.num_envs:
            raise ValueError(f"seed: expected {self.num_envs} seeds, got {len(seeds)}")
        return seeds

    def _rewards(self, actions: np.ndarray) -> np.ndarray:
        state = self._teams.reached_states()
        rewards = np.array(self._reward(state[..., :3], state[..., 3:6], actions.copy()), dtype=float)
        if rewards.shape != (self.num_envs,):
            raise ValueError(f"reward: expected an array of the shape ({self.num_envs},), got one of {rewards.shape}")
        return rewards

    def _infos(self, terminations: np.ndarray, is_over: np.ndarray) -> dict[str, Any]:
        infos: dict[str, Any] = {}
        lost = self._teams.reached_losses()
        if lost.any():
            infos["lost"], infos["_lost"] = lost, lost.any(axis=1)
        failures = np.array([self._teams.failure(k) if terminations[k] else "" for k in range(self.num_envs)], dtype=object)
        if failures.any():
            infos["failure"], infos["_failure"] = failures, failures != ""
        if self.autoreset_mode is AutoresetMode.SAME_STEP and is_over.any():
            final = np.full(self.num_envs, None, dtype=object)
            for k in np.flatnonzero(is_over):
                final[k] = self._teams.final_observations(k).astype(self._dtype)
            infos = {"final_obs": final, "_final_obs": is_over, "final_info": infos, "_final_info": is_over.copy()}
        return infos


def _mode(mode: Any) -> AutoresetMode:
    for known in AutoresetMode:
        if mode is known or mode == known.value:
            return known
    raise ValueError(f"autoreset_mode: expected {', '.join(repr(m.value) for m in AutoresetMode)}, got {mode!r}")


def _batch(space: Box, count: int) -> Box:
    return Box(np.repeat(space.low[None], count, axis=0), np.repeat(space.high[None], count, axis=0),
               dtype=space.dtype.type)


def vector_env(file: str | os.PathLike[str], num_envs: int = 1, threads: int | None = None, *, seed: int | None = None,
               set: Mapping[str, Any] | None = None, reward: Reward | None = None, dtype: Any = "float32",
               autoreset_mode: Any = AutoresetMode.NEXT_STEP) -> VectorEnv:
    """Many copies of the team of an experiment file, as a vector environment of Gymnasium.

    file, set, dtype: as for `mascot.parallel_env()`.
    num_envs: how many copies.
    threads: how many threads compute them; None: one for each core that this process may use.
    seed: run.seed of the first episode of the first copy; the others have the following numbers. None: the file's.
    reward: a function of p (num_envs, N, 3), v (num_envs, N, 3) and the actions (num_envs, A, size) that returns num_envs numbers.
        None: minus the disagreement.
    autoreset_mode: "NextStep", "SameStep" or "Disabled", or Gymnasium's AutoresetMode.

    Raises ConfigError for a mistake in the file or in `set`."""
    return VectorEnv(file, num_envs, threads, seed=seed, set=set, reward=reward, dtype=dtype,
                     autoreset_mode=autoreset_mode)

"""Flies an experiment from its start to its end."""
from __future__ import annotations

import os
from typing import Any, Callable, Mapping, Sequence

import numpy as np

from mascot import _core
from mascot._run import Run, load


class Agent:
    """What a law knows of an agent: of its own, as that measures itself, or of a neighbour, as it was heard.

    id: number, from 1. position, velocity, acceleration: x, y, z in the world frame (m, m/s, m/s^2). orientation: quaternion w, x,
    y, z, which takes components in the body frame to the world frame. angular_velocity: in the body frame (rad/s). weight: a_ij
    with which the agent hears this one; 0 for its own. message: what this one sent last, an array, or None. age_s: age of what
    was heard (s). The object of the own agent is the same at each call: a law may keep what it remembers in it."""

    id: int
    position: np.ndarray
    velocity: np.ndarray
    acceleration: np.ndarray
    orientation: np.ndarray
    angular_velocity: np.ndarray
    weight: float
    message: np.ndarray | None
    age_s: float

    def _know(self, known: tuple) -> "Agent":
        (self.id, self.position, self.velocity, self.acceleration, self.orientation, self.angular_velocity, self.weight,
         self.message, self.age_s) = known
        return self


Law = Callable[[float, Agent, Sequence[Agent]], Any]


def fly(file: str | os.PathLike[str], law: Law | None = None, *, seed: int | None = None,
        set: Mapping[str, Any] | None = None, out: str | os.PathLike[str] | None = None, force: bool = False) -> Run:
    """Flies an experiment in this process, records it, and returns the run.

    file: path of the experiment, as for `orchestrator up`.
    law: control(t, me, neighbours), as a law in Python in a file: called at each tick for each agent that takes actions, or else
        for all that have no law of their own. It returns the acceleration (m/s^2) that the agent wants: 3 numbers, or 2 for x and
        y, in the world frame; with set={"law.message": n}, n more numbers behind three, which the agent sends. None: agents fly
        by the file's laws.
    seed, set: run.seed and other keys of the file, and their values.
    out: folder of the run; None: runs/NAME/TIME. force: replace the files of an earlier run there.

    Raises ConfigError for a mistake in the file or in `set`, RuntimeError if the run fails, and what `law` raises."""
    changes = dict(set or {})
    if seed is not None:
        changes["run.seed"] = _core.seed_of(seed)
    if law is None:
        return load(_core.core.fly(_core.path_of(file), _core.sets(changes), out and _core.path_of(out), force))
    team = _core.core.TeamEnv(_core.path_of(file), _core.sets(changes))
    folder = team.record("out", out and _core.path_of(out), force)
    about = team.about()
    agents = {i: (Agent(), len(high)) for i, high in zip(about["ids"], about["action_high"])}
    try:
        while not team.is_over:
            lost = dict(zip(about["ids"], team.lost()))
            for i, (me, size) in agents.items():
                if not lost[i]:
                    team.act(i, _action(law, team, i, me, size))
            team.go_on()
    finally:
        team.finish()
    if team.failure:
        raise RuntimeError(team.failure)
    return load(folder)


def _action(law: Law, team: Any, i: int, me: Agent, size: int) -> np.ndarray:
    own, heard = team.perceived(i)
    wanted = np.asarray(law(team.time_s, me._know(own), [Agent()._know(known) for known in heard]), dtype=float)
    if size == 3 and wanted.shape == (2,):
        wanted = np.append(wanted, 0.0)
    if wanted.shape != (size,) or not np.isfinite(wanted).all():
        raise ValueError(f"agent {i} at {team.time_s} s: expected the law to return {size} finite numbers, got {wanted}")
    return wanted

"""A team as a ParallelEnv of PettingZoo."""
from __future__ import annotations

import os
import webbrowser
from typing import Any, Callable, Mapping

import numpy as np

from mascot import _core
from mascot._spaces import Box, box

try:
    from pettingzoo import ParallelEnv as _Base
except ImportError:

    class _Base:  # type: ignore[no-redef]
        """What PettingZoo's ParallelEnv brings, where PettingZoo is not installed."""

        metadata: dict[str, Any] = {}

        @property
        def num_agents(self) -> int:
            return len(self.agents)

        @property
        def max_num_agents(self) -> int:
            return len(self.possible_agents)

        @property
        def unwrapped(self) -> "_Base":
            return self

        def __str__(self) -> str:
            return self.metadata.get("name", type(self).__name__)


Reward = Callable[[np.ndarray, np.ndarray, np.ndarray], Any]
Dicts = tuple[dict[str, np.ndarray], dict[str, float], dict[str, bool], dict[str, bool], dict[str, dict[str, Any]]]


class ParallelEnv(_Base):
    """A team of agents that learn, as PettingZoo's ParallelEnv; `mascot.parallel_env()` makes one.

    Agents are called "agent_1", "agent_2", ...: those of the file whose law takes actions, or else all that have no law of
    their own. An observation is what the agent measures and hears: its own position (3, m), velocity (3, m/s) and attitude
    (4: x, y, z, w), then for each agent that it may hear position (3) and velocity (3) relative to its own, weight, heard (1
    or 0), age (s) and message. An action is the acceleration (3, m/s^2) or velocity (3, m/s) that the agent wants, and its
    message. All vectors are in the world frame: x east, y north, z up.

    A step is a tick of the control loop (1 / control.rate_hz). An agent that is lost is terminated, and does not come back;
    all are truncated at run.duration_s.
    """

    def __init__(self, file: str | os.PathLike[str], *, seed: int | None = None, set: Mapping[str, Any] | None = None,
                 reward: Reward | None = None, dtype: Any = "float32") -> None:
        self._dtype = _core.float_type(dtype)
        self._team = _core.core.TeamEnv(_core.path_of(file), _core.sets(set))
        self._about = about = self._team.about()
        self._reward = reward
        self._seed = _core.seed_of(seed)
        self.render_mode = None
        self.metadata = {"name": about["name"], "render_modes": [], "is_parallelizable": True,
                         "render_fps": about["rate_hz"]}
        self.possible_agents = [f"agent_{i}" for i in about["ids"]]
        self.agents: list[str] = []
        self._index = {agent: k for k, agent in enumerate(self.possible_agents)}
        self._rows = np.array(about["ids"]) - 1  # of the agents that act, in state()
        observation_space = {a: box(about["observation_high"], self._dtype) for a in self.possible_agents}
        self.observation_spaces = observation_space
        self.action_spaces = {a: box(high, self._dtype) for a, high in zip(self.possible_agents, about["action_high"])}
        self._sizes = [len(high) for high in about["action_high"]]
        self._actions = np.zeros((len(self.possible_agents), about["action_size"]))
        self._given = np.zeros(len(self.possible_agents), bool)
        self._lost = np.zeros(len(self.possible_agents), bool)
        largest = np.finfo(self._dtype).max
        self.state_space = box(np.full((about["agents"], 13), largest), self._dtype)

    def observation_space(self, agent: str) -> Box:
        """The space of an agent's observations: the same object at each call."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> Box:
        """The space of an agent's actions: the same object at each call. Actions outside of it are cut by the agent."""
        return self.action_spaces[agent]

    @property
    def observation_layout(self) -> dict[str, Any]:
        """What the numbers of an observation are: `text`, `hash` (which the metadata of a policy's file have) and `names`."""
        return {key: self._about["observation_" + key] for key in ("text", "hash", "names")}

    @property
    def episode_seed(self) -> int:
        """run.seed of this episode."""
        return self._team.seed if self._seed is None else self._seed

    @property
    def time_s(self) -> float:
        """Simulated time (s) of this tick."""
        return self._team.tick / self._about["rate_hz"]

    def reset(self, seed: int | None = None, options: Mapping[str, Any] | None = None
              ) -> tuple[dict[str, np.ndarray], dict[str, dict[str, Any]]]:
        """Begins an episode. Returns observations and infos by agent.

        seed: run.seed of the episode, from which those of the next ones follow. None: it follows from the one before; that of
        the first episode is the constructor's, or the file's.
        options: {"set": {key: value}} changes keys of the file, in this and the next episodes. Others are for other
        environments: PettingZoo wants them to be passed over."""
        changes = None if not options or "set" not in options else _core.sets(options["set"])
        seed = _core.seed_of(seed)
        try:
            self._team.reset(self._seed if seed is None else seed, changes)
        except _core.ConfigError:  # the episode before has ended
            self.agents = []
            raise
        self._seed = None
        self._actions[:] = 0
        self._begin()
        return self._observe(self.agents), {agent: {} for agent in self.agents}

    def step(self, actions: Mapping[str, Any]) -> Dicts:
        """Goes on to the next tick. Returns observations, rewards, terminations, truncations and infos by agent, of the agents
        that were there before the step.

        actions: for each agent of `agents`, an array of the shape of its action space, finite."""
        if not self.agents:
            if actions:
                raise ValueError("actions: expected none, because no agent is left: reset() begins the next episode")
            return {}, {}, {}, {}, {}
        self._take(actions)
        agents = self.agents
        try:
            self._team.step(self._actions, self._given)
        finally:
            self._leave_out()
        is_over = self._team.is_terminated
        observations = self._observe(agents)
        rewards = self._rewards(agents)
        terminations = {a: bool(is_over or self._lost[self._index[a]]) for a in agents}
        truncations = dict.fromkeys(agents, bool(self._team.is_at_end))
        infos: dict[str, dict[str, Any]] = {a: {} for a in agents}
        if is_over and self._team.failure:
            for info in infos.values():
                info["failure"] = self._team.failure
        return observations, rewards, terminations, truncations, infos

    def state(self) -> np.ndarray:
        """The true state of the whole team, of shape (agents of the file, 13): position (3, m), velocity (3, m/s), attitude (4:
        x, y, z, w) and angular velocity in the body frame (3, rad/s)."""
        return self._team.state().astype(self._dtype)

    def event(self, **keys: Any) -> None:
        """An event by hand at the next tick, with the keys of [[events]] but at_s: env.event(cut=[[1, 2]]), or
        env.event(set={"control.max_acceleration_m_per_s2": 1.0})."""
        self._team.take("\n".join(f"{key} = {_core.toml(value)}" for key, value in keys.items()))

    def snapshot(self) -> _core.Snapshot:
        """This episode so far, for restore(). It can be pickled."""
        return self._team.save()

    def restore(self, snapshot: _core.Snapshot) -> dict[str, np.ndarray]:
        """Flies the episode of a snapshot again, up to its tick and to the same bits. Returns the observations there."""
        if not isinstance(snapshot, _core.Snapshot):
            raise TypeError(f"snapshot: expected a mascot.Snapshot, got {type(snapshot).__name__}")
        self._team.restore(snapshot)
        self._actions[:] = 0
        self._begin()
        if self._team.is_terminated or self._team.is_at_end:
            self.agents = []
            self._mark()
        return self._observe(self.agents)

    def record(self, folder: str | os.PathLike[str], force: bool = False) -> None:
        """Records the next episode that begins to move, this one if it is at its start, into `folder`: a folder as that of
        `orchestrator up`, for verify, view, plot, compare and mascot.load(). It is complete when the episode is over: at the
        last tick, or with reset() or close().

        force: replace the files of an earlier run in this folder."""
        self._team.record("folder", _core.path_of(folder), force)

    def view(self, at: str = "127.0.0.1:8765", *, pace: float = 1.0, browser: bool | None = None) -> str:
        """Shows the next episode that begins to move, this one if it is at its start, and those after it on a page, until
        close(). Returns its address. Viewers may pause the episode, slow it down, give events and stop it: step() waits for
        them. An episode that they stop is truncated.

        at: where the page is, as for `orchestrator up --view`: "ADDRESS:PORT", "ADDRESS" or ":PORT". Whoever reaches the
            address may watch and steer. If the port is taken, the page takes the next one that is free.
        pace: simulated seconds a second, unless the file has run.pace; 0: as fast as it goes. Viewers may change it.
        browser: whether to open the page in a browser; None: where there is a display."""
        if not isinstance(at, str):
            raise TypeError(f'at: expected a str such as "127.0.0.1:8765", got {at!r}')
        address = self._team.view(at, float(pace))
        if browser or (browser is None and ("DISPLAY" in os.environ or "WAYLAND_DISPLAY" in os.environ)):
            webbrowser.open(address)
        return address

    def render(self) -> None:
        """Nothing: view() shows episodes."""

    def close(self) -> None:
        """Ends the episode, completes its recording, and ends the page."""
        self._team.close()
        self.agents = []

    def _leave_out(self) -> None:
        """Those who are lost, or all, if the episode is over."""
        self._lost = lost = self._team.lost()
        if self._team.is_over:
            self.agents = []
        elif lost.any():
            self.agents = [a for a in self.agents if not lost[self._index[a]]]
            self._mark()

    def _begin(self) -> None:
        lost = self._team.lost()
        self.agents = [a for a in self.possible_agents if not lost[self._index[a]]]
        self._mark()

    def _mark(self) -> None:
        self._given[:] = False
        self._given[[self._index[a] for a in self.agents]] = True

    def _observe(self, agents: list[str]) -> dict[str, np.ndarray]:
        rows = self._team.observations().astype(self._dtype)
        if len(agents) == len(self.possible_agents):
            return dict(zip(agents, rows))
        return {a: rows[self._index[a]] for a in agents}

    def _take(self, actions: Mapping[str, Any]) -> None:
        if not isinstance(actions, Mapping):
            raise TypeError(f"actions: expected a dict, got {type(actions).__name__}")
        if actions.keys() != set(self.agents):
            wrong = sorted(actions.keys() - set(self.agents), key=str)
            missing = [a for a in self.agents if a not in actions]
            raise ValueError("actions: expected one for each of env.agents, got "
                             + (f"one for {wrong[0]!r}" if wrong else f"none for {missing[0]!r}"))
        for agent in self.agents:
            k = self._index[agent]
            action = np.asarray(actions[agent], dtype=float)
            if action.shape != (self._sizes[k],):
                raise ValueError(f"actions[{agent!r}]: expected the shape ({self._sizes[k]},), got {action.shape}")
            self._actions[k, :self._sizes[k]] = action
        if not np.isfinite(self._actions).all():
            agent = next(a for a in self.agents if not np.isfinite(self._actions[self._index[a]]).all())
            raise ValueError(f"actions[{agent!r}]: expected finite numbers, got {actions[agent]}")

    def _rewards(self, agents: list[str]) -> dict[str, float]:
        if self._reward is None:
            return dict.fromkeys(agents, -self._team.disagreement_m())
        state = self._team.state()
        reward = np.asarray(self._reward(state[:, :3], state[:, 3:6], self._actions.copy()), dtype=float)
        if reward.shape not in ((), (len(self.possible_agents),)):
            raise ValueError(f"reward: expected a number, or an array of the shape ({len(self.possible_agents)},), got an "
                             f"array of the shape {reward.shape}")
        each = np.broadcast_to(reward, len(self.possible_agents))
        return {a: float(each[self._index[a]]) for a in agents}


def parallel_env(file: str | os.PathLike[str], *, seed: int | None = None, set: Mapping[str, Any] | None = None,
                 reward: Reward | None = None, dtype: Any = "float32") -> ParallelEnv:
    """The team of an experiment file, as an environment of PettingZoo.

    file: path of the experiment, as for `orchestrator up`.
    seed: run.seed of the first episode; None: the file's.
    set: keys of the file and their values: {"run.duration_s": 5, "link.loss": 0.2}.
    reward: a function of p (N, 3; m), v (N, 3; m/s) of all N agents of the file, and the actions (A, size) of the A agents that
        learn, by increasing number. It returns a number for all, or A numbers. None: minus the disagreement, the largest
        distance of an agent from the mean place (m).
    dtype: of observations, states and spaces, float32 or float64. Actions of any type are taken as float64.

    Raises ConfigError for a mistake in the file or in `set`."""
    return ParallelEnv(file, seed=seed, set=set, reward=reward, dtype=dtype)

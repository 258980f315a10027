"""A run that was recorded."""
from __future__ import annotations

import csv
import json
import os
import tomllib
from pathlib import Path
from typing import Any, Mapping

import numpy as np

from mascot import _core


class Run:
    """A recorded run; `mascot.load()` makes one. Its arrays are read at once, other files each time they are asked for."""

    def __init__(self, run: str | os.PathLike[str]) -> None:
        path, self.arrays, self.loss = _core.core.arrays(_core.path_of(run))
        #: The recording.
        self.recording = Path(path)
        #: The folder of the run.
        self.folder = self.recording.parent

    #: By name, as in states.npz (docs/recording.md): `t` (rows,), `id` (N,), `position`, `velocity`, `angular_velocity`,
    #: `acceleration_command` (rows, N, 3), `orientation` (rows, N, 4: w, x, y, z), `actuator` (rows, N, 4), `flags` (rows, N).
    arrays: dict[str, np.ndarray]
    #: Why the recording ends early, in words; empty: it does not.
    loss: str

    def __getitem__(self, name: str) -> np.ndarray:
        """An array: run["position"]."""
        return self.arrays[name]

    @property
    def config(self) -> dict[str, Any]:
        """The experiment with all defaults, as in config.toml."""
        return tomllib.loads((self.folder / "config.toml").read_text())

    @property
    def summary(self) -> dict[str, Any]:
        """summary.json."""
        return json.loads((self.folder / "summary.json").read_text())

    @property
    def figures(self) -> dict[str, float]:
        """The numbers of the summary by their dotted names, as `orchestrator up --assert` takes them:
        figures["consensus.settling_time_s"]."""
        return dict(_numbers(self.summary))

    @property
    def events(self) -> list[dict[str, str]]:
        """The rows of events.csv: incidents and events of the run."""
        with open(self.folder / "events.csv", newline="") as file:
            return list(csv.DictReader(file))

    def __repr__(self) -> str:
        rows, agents = self.arrays["position"].shape[:2]
        return f"Run({str(self.folder)!r}: {rows} rows, {agents} agents)"


def _numbers(value: Any, name: str = "") -> Any:
    if isinstance(value, Mapping):
        for key, item in value.items():
            yield from _numbers(item, f"{name}.{key}" if name else key)
    elif isinstance(value, (int, float)) and not isinstance(value, bool):
        yield name, float(value)


def load(run: str | os.PathLike[str] = "latest") -> Run:
    """A recorded run: its arrays, events, summary and figures.

    run: a run folder, a folder of runs, of which the newest is meant, "latest" for the newest in `runs`, or an .mcap file.

    Raises ConfigError if there is no recording."""
    return Run(run)

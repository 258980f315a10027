"""A network in a file of the format ONNX, as agents compute it."""
from __future__ import annotations

import os

import numpy as np

from mascot import _core


class Policy:
    """A network of law.name = "policy" (docs/policy.md), as agents compute it: in double, to the same bits everywhere.

    policy(observation) takes one observation, of shape (size,), or several, of shape (..., size), and returns as many answers,
    of shape (..., numbers): what the agent wants (3, m/s^2 or m/s) and its message. An environment with dtype="float64" whose
    actions are these flies as `orchestrator up` with this file does, bit for bit.

    file: path of the .onnx file. Raises ValueError, with the node, for a network that cannot be flown."""

    def __init__(self, file: str | os.PathLike[str]) -> None:
        self._policy = _core.core.Policy(_core.path_of(file))
        #: How many numbers an observation has.
        self.inputs: int = self._policy.inputs
        #: How many numbers an answer has.
        self.outputs: int = self._policy.outputs
        #: The metadata of the file: "mascot_observation" is the hash of the layout that it was trained on.
        self.metadata: dict[str, str] = self._policy.metadata

    def __call__(self, observation: np.ndarray) -> np.ndarray:
        rows = np.asarray(observation, dtype=float)
        if rows.shape[-1:] != (self.inputs,):
            raise ValueError(f"observation: expected the shape (..., {self.inputs}), got {rows.shape}")
        answers = self._policy.answer(rows.reshape(-1, self.inputs))
        return answers.reshape(*rows.shape[:-1], self.outputs)

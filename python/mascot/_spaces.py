"""Gymnasium's Box, or, where Gymnasium is not installed, a class of the same shape."""
from __future__ import annotations

from typing import Any

import numpy as np

try:
    from gymnasium.spaces import Box
except ImportError:

    class Box:  # type: ignore[no-redef]
        """The arrays of one shape and dtype whose numbers lie between `low` and `high`.

        low, high: arrays of that shape, or numbers. `sample()` draws one, uniformly; `seed(n)` begins its random numbers
        anew."""

        def __init__(self, low: Any, high: Any, shape: Any = None, dtype: Any = np.float32, seed: Any = None) -> None:
            self.dtype = np.dtype(dtype)
            self._shape = tuple(shape) if shape is not None else np.broadcast(np.asarray(low), np.asarray(high)).shape
            self.low = np.broadcast_to(np.asarray(low, self.dtype), self._shape).copy()
            self.high = np.broadcast_to(np.asarray(high, self.dtype), self._shape).copy()
            self.bounded_below = np.isfinite(self.low)
            self.bounded_above = np.isfinite(self.high)
            self._np_random: np.random.Generator | None = None
            if seed is not None:
                self.seed(seed)

        @property
        def shape(self) -> tuple[int, ...]:
            return self._shape

        @property
        def np_random(self) -> np.random.Generator:
            if self._np_random is None:
                self.seed()
            assert self._np_random is not None
            return self._np_random

        @property
        def is_np_flattenable(self) -> bool:
            return True

        def is_bounded(self, manner: str = "both") -> bool:
            below, above = bool(self.bounded_below.all()), bool(self.bounded_above.all())
            return {"both": below and above, "below": below, "above": above}[manner]

        def seed(self, seed: int | None = None) -> int:
            sequence = np.random.SeedSequence(seed)
            self._np_random = np.random.Generator(np.random.PCG64(sequence))
            return int(sequence.entropy)  # type: ignore[arg-type]

        def sample(self, mask: None = None, probability: None = None) -> np.ndarray:
            drawn = self.np_random.uniform(size=self._shape)  # of which the whole range is made without an overflow
            return (self.low * (1 - drawn) + self.high * drawn).astype(self.dtype)

        def contains(self, x: Any) -> bool:
            if not isinstance(x, np.ndarray):
                try:
                    x = np.asarray(x, dtype=self.dtype)
                except (TypeError, ValueError):
                    return False
            return bool(np.can_cast(x.dtype, self.dtype) and x.shape == self._shape
                        and np.all(x >= self.low) and np.all(x <= self.high))

        def __contains__(self, x: Any) -> bool:
            return self.contains(x)

        def __eq__(self, other: object) -> bool:
            return (isinstance(other, Box) and self._shape == other.shape and self.dtype == other.dtype
                    and np.array_equal(self.low, other.low) and np.array_equal(self.high, other.high))

        def __repr__(self) -> str:
            return f"Box({self.low.min()}, {self.high.max()}, {self._shape}, {self.dtype})"


def box(high: np.ndarray, dtype: np.dtype) -> "Box":
    """The box from -high to high; where that has no bound, the largest numbers of `dtype`."""
    high = np.minimum(high, float(np.finfo(dtype).max)).astype(dtype)
    return Box(-high, high, dtype=dtype.type)

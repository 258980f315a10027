"""Loads the compiled module, and turns Python's values into those of experiment files."""
from __future__ import annotations

import json
import math
import operator
import os
import sys
from typing import Any, Mapping

import numpy as np  # before the flags below, which are for our module alone

_flags = sys.getdlopenflags()
try:
    # Bullet, which the module brings, is to compute sines by the functions of the module, as in MASCOT's programs:
    # then an episode has the bits of `orchestrator up`.
    sys.setdlopenflags(os.RTLD_NOW | os.RTLD_LOCAL | os.RTLD_DEEPBIND)
    from mascot import _mascot as core
finally:
    sys.setdlopenflags(_flags)

ConfigError = core.ConfigError
ConfigError.__module__ = "mascot"
ConfigError.__doc__ = "A mistake in an experiment: file, line, column, key, and what was expected."
Snapshot = core.Snapshot
Snapshot.__module__ = "mascot"


def toml(value: Any) -> str:
    """`value` (str, bool, int, float, list, tuple, NumPy array or number, dict) as TOML in one line."""
    if isinstance(value, (np.ndarray, np.generic)):
        value = value.tolist()
    if isinstance(value, (bool, str)):
        return _quoted(value) if isinstance(value, str) else json.dumps(value)
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        if math.isfinite(value):
            return repr(value)
        return "nan" if math.isnan(value) else ("inf" if value > 0 else "-inf")
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(toml, value)) + "]"
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_quoted(str(key))} = {toml(item)}" for key, item in value.items()) + "}"
    raise TypeError(f"expected a str, bool, int, float, list or dict for an experiment file, got {type(value).__name__}")


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")  # TOML's strings have the same escapes


def integer(what: str, number: Any) -> int:
    try:
        return operator.index(number)
    except TypeError:
        raise TypeError(f"{what}: expected an integer, got {number!r}") from None


def seed_of(seed: Any) -> int | None:
    """A seed as run.seed takes it; None stays None."""
    if seed is None:
        return None
    number = integer("seed", seed)
    if not 0 <= number < 2**63:
        raise ValueError(f"seed: expected an integer in [0, {2**63 - 1}], got {number}")
    return number


def count_of(what: str, number: Any) -> int:
    """`number` as an integer of at least 1."""
    count = integer(what, number)
    if count < 1:
        raise ValueError(f"{what}: expected at least 1, got {count}")
    return count


def sets(values: Mapping[str, Any] | None) -> list[tuple[str, str]]:
    """What `orchestrator up --set` takes: dotted keys, and their values as TOML."""
    if values is not None and not isinstance(values, Mapping):
        raise TypeError(f"set: expected a dict, got {values!r}")
    return [(str(key), toml(value)) for key, value in (values or {}).items()]


def path_of(file: str | os.PathLike[str]) -> str:
    return os.fspath(file)


def float_type(dtype: Any) -> np.dtype:
    kind = np.dtype(dtype)
    if kind not in (np.dtype("float32"), np.dtype("float64")):
        raise ValueError(f"dtype: expected float32 or float64, got {kind}")
    return kind

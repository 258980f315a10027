"""Reads a run folder and computes the quantities that scripts/plot.py plots."""

import json
import tomllib
import zipfile
import zlib
from dataclasses import dataclass

import numpy as np

DRAWING = {"leader": "leader", "switches": False, "pictures": [], "telling": "paths", "hull": "", "cells": ""}
ARRAYS = {"position": 3, "velocity": 3, "acceleration_command": 3}  # name -> numbers per agent and row


class RunError(Exception):
    """An error with a message of one line and an exit code."""

    def __init__(self, message, code=1):
        super().__init__(message)
        self.code = code


@dataclass
class Run:
    t: np.ndarray
    id: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    acceleration_command: np.ndarray
    config: dict
    summary: dict

    @property
    def size(self):
        return len(self.id)

    @property
    def name(self):
        return self.config.get("run", {}).get("name", "")

    @property
    def phases(self):
        """What summary.json says of the phases of [[law.schedule]] that have begun; empty: the law never changed."""
        return self.summary.get("phases", [])

    @property
    def law(self):
        """The table of the law, of the phase in which the run ended."""
        law = self.config.get("law", {})
        begun = [phase for phase in law.get("schedule", []) if phase["at_s"] <= self.t[-1]]
        return begun[-1] if begun else law

    @property
    def drawing(self):
        """How to plot the law, from its row in the table of laws."""
        return DRAWING | self.summary.get("drawing", {})

    @property
    def leader(self):
        """Index of the leader (or root), or None."""
        number = self.law.get("leader", 0)
        return number - 1 if 1 <= number <= self.size else None

    @property
    def leads(self):
        """Indices of all agents that lead: the leader, and those whom the law's key of leaders lists."""
        numbers = self.law.get(self.drawing["hull"], []) if self.drawing["hull"] else []
        return [int(number) - 1 for number in numbers] or [self.leader] * (self.leader is not None)

    @property
    def liars(self):
        """Indices of the agents of which others hear what is false."""
        overrides = self.config.get("agents", {}).get("override", [])
        return [agent["id"] - 1 for agent in overrides if "lie" in agent]

    @property
    def honest(self):
        """Indices of all other agents, or of all if all lie."""
        return [k for k in range(self.size) if k not in self.liars] or list(range(self.size))

    @property
    def axes(self):
        """Indices of the axes that the law controls."""
        return [0, 1, 2] if self.law.get("axes", "xy") == "xyz" else [0, 1]

    @property
    def edges(self):
        """Pairs (i, j) of indices: agent i hears agent j."""
        return [(int(e[0]) - 1, int(e[1]) - 1) for e in self.summary.get("graph", {}).get("edges", [])]

    @property
    def places(self):
        """(T, N, 3): the agents' places in their formation in each row; zero for other laws."""
        places = np.zeros((self.t.size, self.size, 3))
        for phase in self.phases or [{"at_s": self.t[0], **self.summary}]:
            offsets = phase.get("formation", {}).get("offsets_m")
            of_agents = 0 if offsets is None else np.asarray(offsets, dtype=float).reshape(self.size, 3)
            places[self.t >= phase["at_s"]] = of_agents
        return places

    @property
    def obstacles(self):
        return self.config.get("physics", {}).get("obstacles", [])

    def output(self, key):
        return self.config.get("output", {}).get(key, key != "show_plot")


FORMAT = 1  # of config.toml and summary.json: the newest that is understood here


def check_format(path, contents):
    """What says no format is of version 1."""
    if contents.get("format", 1) > FORMAT:
        raise RunError(f"{path}: it is of format {contents['format']}, newer than the {FORMAT} that this version reads",
                       code=2)
    return contents


def read_text(path, parse):
    try:
        return check_format(path, parse(path.read_text(encoding="utf-8")))
    except (ValueError, RecursionError) as error:  # tomllib's and json's errors are ValueErrors
        raise RunError(f"{path}: {error}") from None
    except OSError as error:
        raise RunError(f"{path}: {error.strerror}") from None


def read_states(path):
    try:
        with path.open("rb") as file, np.load(file, allow_pickle=False) as states:
            arrays = {name: states[name] for name in ["t", "id", *ARRAYS]}
    except KeyError as error:
        raise RunError(f"{path}: {str(error.args[0]).split(' is not')[0]}: no such array") from None
    except FileNotFoundError:
        raise RunError(f"{path}: no such file (output.save_data = false writes none)") from None
    except OSError as error:
        raise RunError(f"{path}: {error.strerror or 'cannot be read'}") from None
    except (ValueError, TypeError, EOFError, RuntimeError, SyntaxError, zipfile.BadZipFile, zlib.error):
        raise RunError(f"{path}: damaged, or not an .npz file of numbers") from None
    rows, agents = arrays["t"].size, arrays["id"].size
    arrays["t"], arrays["id"] = arrays["t"].ravel(), arrays["id"].ravel()
    for name, width in ARRAYS.items():
        if arrays[name].shape != (rows, agents, width):
            raise RunError(f"{path}: {name}: expected shape ({rows}, {agents}, {width}), got {arrays[name].shape}")
    if rows == 0 or agents == 0:
        raise RunError(f"{path}: holds no tick")
    return arrays


def read_run(folder):
    if not folder.is_dir():
        raise RunError(f"{folder}: no such folder", code=2)
    states = read_states(folder / "states.npz")
    config = read_text(folder / "config.toml", tomllib.loads)
    summary = folder / "summary.json"
    return Run(**states, config=config, summary=read_text(summary, json.loads) if summary.exists() else {})


def disagreement(run):
    """(T, N): distance of every agent to the leader, or else to the mean of those who do not lie, along the axes of the
    law (m). In a formation, the places are subtracted from the positions first."""
    p = (run.position - run.places)[:, :, run.axes]
    reference = p[:, run.honest].mean(axis=1, keepdims=True) if run.leader is None else p[:, [run.leader]]
    return np.linalg.norm(p - reference, axis=2)


def spanning_tree(run):
    """Edges (child, parent) of the breadth-first tree from the root. The parent is the lowest-numbered agent one
    level up from which the child receives messages."""
    parent = {run.leader: None}
    level = [run.leader]
    while level:
        found = {}
        for i, j in sorted(run.edges, key=lambda edge: edge[1]):
            if j in level and i not in parent:
                found.setdefault(i, j)
        parent.update(found)
        level = list(found)
    return sorted((child, up) for child, up in parent.items() if up is not None)


def target_by_time(times_s, run, agent, waypoints):
    begun = np.searchsorted(times_s, run.t, side="right")
    return np.vstack([run.position[:1, agent], waypoints])[begun]


def waypoint_targets(run, agent):
    """(T, 3): target of this agent in each row, by the rule of the waypoint law (arrival and dwell, or times)."""
    waypoints = np.asarray(run.law["waypoints_m"], dtype=float)
    if run.law.get("times_s"):
        return target_by_time(run.law["times_s"], run, agent, waypoints)
    radius_m, dwell_s = run.law.get("arrival_radius_m", 0.2), run.law.get("dwell_s", 1.0)
    chosen = np.empty(run.t.size, dtype=int)
    at, arrived_s = 0, None
    for k, t_s in enumerate(run.t):
        while at + 1 < len(waypoints):
            if np.linalg.norm((waypoints[at] - run.position[k, agent])[run.axes]) > radius_m:
                arrived_s = None
                break
            arrived_s = t_s if arrived_s is None else arrived_s
            if t_s - arrived_s < dwell_s - 1e-9:
                break
            at, arrived_s = at + 1, None
        chosen[k] = at
    return waypoints[chosen]


def hull(points):
    """Corners of the convex hull of points (N, 2), counterclockwise (Andrew's monotone chain)."""
    ordered = sorted(set(map(tuple, points)))
    if len(ordered) < 3:
        return np.array(ordered).reshape(-1, 2)

    def turns_left(a, b, c):
        return (b[0] - a[0]) * (c[1] - a[1]) > (b[1] - a[1]) * (c[0] - a[0])

    def half(corners):
        kept = []
        for corner in corners:
            while len(kept) > 1 and not turns_left(kept[-2], kept[-1], corner):
                kept.pop()
            kept.append(corner)
        return kept[:-1]

    return np.array(half(ordered) + half(ordered[::-1]))


def nearer(polygon, p, q):
    """The part of a convex polygon (N, 2) that is nearer to p than to q."""
    off = (polygon - (p + q) / 2) @ (q - p)
    kept = []
    for k, corner in enumerate(polygon):
        if (off[k - 1] > 0) != (off[k] > 0):
            kept.append(polygon[k - 1] + (corner - polygon[k - 1]) * off[k - 1] / (off[k - 1] - off[k]))
        if off[k] <= 0:
            kept.append(corner)
    return np.array(kept).reshape(-1, 2)


def cells(region, points):
    """For each of the points (N, 2), the part of a convex region that is nearest to it."""
    parts = []
    for k, p in enumerate(points):
        part = np.asarray(region, dtype=float)
        for q in np.delete(points, k, axis=0):
            part = nearer(part, p, q)
        parts.append(part)
    return parts

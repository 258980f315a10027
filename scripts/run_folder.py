"""Reads a run folder and computes the quantities that its pictures show."""

import csv
import json
import tomllib
import zipfile
import zlib
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from regular_file import open_regular

DRAWING = {"leader": "leader", "switches": False, "pictures": [], "telling": "paths", "hull": "", "cells": "",
           "curve": None}
ARRAYS = {"position": 3, "velocity": 3, "acceleration_command": 3}  # name -> numbers per agent and row
UNPACKED_FREE, UNPACKED_TIMES = 256 << 20, 300  # bytes that a file may unpack to, and then so many times its own
NUMBERS_AT_ONCE = 1 << 14  # in one array of a computation over rows, so that it stays in the cache
LOSSES = ("kill", "hang")  # faults
WORDS_MAX = 2  # changes that the name of a phase says
FILTERED, INFEASIBLE = 16, 32  # bits of flags: law.safety changed the command; it found no safe one


class RunError(Exception):
    """An error with a message of one line and an exit code."""

    def __init__(self, message, code=1):
        super().__init__(message)
        self.code = code


@dataclass
class Span:
    """A phase of the law."""

    at_s: float
    rows: np.ndarray  # (T): which rows of the run are its own
    law: dict  # its table in config.toml
    drawing: dict
    summary: dict  # what summary.json says of it


@dataclass(frozen=True)
class Incident:
    """A line of events.csv."""

    t_s: float
    until_s: float
    what: str
    indices: tuple  # of the agents that it happened to


@dataclass
class Run:
    t: np.ndarray
    id: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    acceleration_command: np.ndarray
    flags: np.ndarray  # (T, N); of a run of an earlier version: 0
    config: dict
    summary: dict
    incidents: list = field(default_factory=list)  # in order, without events; empty also if there is no events.csv
    law_curve: tuple = ()  # times and values of the curve of the law; empty: it has none
    only: tuple = None  # indices of the agents to be drawn, in order; None: all
    from_s: float = -np.inf  # the window of time to be drawn
    to_s: float = np.inf

    @property
    def size(self):
        return len(self.id)

    @property
    def name(self):
        return self.config.get("run", {}).get("name", "")

    @property
    def shown(self):
        """Indices of the agents to be drawn."""
        return range(self.size) if self.only is None else self.only

    @cached_property
    def rows(self):
        """The rows to be drawn."""
        return slice(*np.searchsorted(self.t, [self.from_s - 1e-9, self.to_s + 1e-9]))

    @property
    def begin_s(self):
        """The first time to be drawn."""
        return self.t[self.rows][0]

    @property
    def end_s(self):
        """The last time to be drawn."""
        return self.t[self.rows][-1]

    def shows(self, t_s):
        return self.begin_s - 1e-9 <= t_s <= self.end_s + 1e-9

    @property
    def phases(self):
        """What summary.json says of the phases of [[law.schedule]] that have begun; empty: the law never changed."""
        return self.summary.get("phases", [])

    @cached_property
    def spans(self):
        """The phases of the law that have begun, one if there is no schedule."""
        law = self.config.get("law", {})
        tables = [{**law, "at_s": self.t[0]}, *law.get("schedule", [])]
        tables = [table for table in tables if table["at_s"] <= self.t[-1]]
        ends = [*(table["at_s"] for table in tables[1:]), np.inf]
        told = self.phases if len(self.phases) == len(tables) else [self.summary] * len(tables)
        return [Span(table["at_s"], (self.t >= table["at_s"]) & (self.t < end), table,
                     DRAWING | phase.get("drawing", self.summary.get("drawing", {})), phase)
                for table, end, phase in zip(tables, ends, told)]

    @property
    def names_of_spans(self):
        """What to call each phase of the law: the first by its law, each other one by what it changed."""
        laws = [span.law for span in self.spans]
        changes = [words_of_change(before, now) or "the same again" for before, now in zip(laws, laws[1:])]
        return [laws[0].get("name", ""), *changes]

    @property
    def law(self):
        """The table of the law, of the phase in which the run ended."""
        return self.spans[-1].law

    @property
    def drawing(self):
        """How to plot the law, from its row in the table of laws."""
        return DRAWING | self.summary.get("drawing", {})

    def leader_of(self, law):
        """Index of the leader (or root) that a table of a law names, or None."""
        number = law.get("leader", 0)
        return number - 1 if 1 <= number <= self.size else None

    @property
    def leader(self):
        """Index of the leader (or root) at the end, or None."""
        return self.leader_of(self.law)

    @cached_property
    def leads(self):
        """Indices of all agents that lead: the leader, and those whom the law's key of leaders lists."""
        numbers = self.law.get(self.drawing["hull"], []) if self.drawing["hull"] else []
        return [int(number) - 1 for number in numbers] or [self.leader] * (self.leader is not None)

    @cached_property
    def liars(self):
        """Indices of the agents of which others hear what is false."""
        overrides = self.config.get("agents", {}).get("override", [])
        return [agent["id"] - 1 for agent in overrides if "lie" in agent]

    @cached_property
    def counts(self):
        """(T, N): whether an agent counts in a row, because it neither lies nor is lost; all do where none is left."""
        lies, is_lost = (np.zeros((self.t.size, self.size), dtype=bool) for _ in range(2))
        lies[:, self.liars] = True
        for at_s, k, kind in self.faults_of_agents():
            rows = self.t >= at_s - 1e-9
            if kind in LOSSES:
                is_lost[rows, k] = True
            else:
                lies[rows, k] = kind == "lie"
                is_lost[rows, k] &= kind != "restart"
        counts = ~(lies | is_lost)
        return counts | ~counts.any(axis=1, keepdims=True)

    def faults_of_agents(self):
        """(time, index, kind) in order, of the faults that say whether an agent counts: kill, hang, lie, ok, restart."""
        run, found, due = self.config.get("run", {}), [], {}  # due: time of the fresh start of an agent that is lost
        after_s = run.get("restart_after_s", 0) if run.get("on_agent_loss") == "restart" else np.inf
        events = [event for event in self.config.get("events", []) if {"fault", "restart"} & event.keys()]
        for event in sorted(events, key=lambda event: event["at_s"]):
            fault, at_s = event.get("fault", {}), event["at_s"]
            k = event.get("restart", fault.get("agent")) - 1
            if due.get(k, np.inf) <= at_s:
                found.append((due.pop(k), k, "restart"))
            if "restart" in event:
                due.pop(k, None)
                found.append((at_s, k, "restart"))
            elif fault.get("of", "agent") == "agent" and fault["kind"] in (*LOSSES, "lie", "ok"):
                found.append((at_s, k, fault["kind"]))
                if fault["kind"] in LOSSES:
                    due.setdefault(k, at_s + after_s)
        return sorted(found + [(at_s, k, "restart") for k, at_s in due.items()], key=lambda fault: fault[0])

    @property
    def axes(self):
        """Indices of the axes that the law controls."""
        return [0, 1, 2] if self.law.get("axes", "xy") == "xyz" else [0, 1]

    @property
    def edges(self):
        """Pairs (i, j) of indices: agent i hears agent j."""
        return [(int(e[0]) - 1, int(e[1]) - 1) for e in self.summary.get("graph", {}).get("edges", [])]

    @property
    def graphs(self):
        """(begin, end, edges) in order of time: who hears whom from begin to end (s), by the schedule of the graph and
        by events. Whether the agents are near enough (graph.range_m) is not asked."""
        found, has, cut = [], frozenset(), frozenset()
        for at_s, change in self.changes_of_graph():
            if isinstance(change, dict):
                cut = cut_by(change, cut, self.edges)
            else:
                has = change
            if found and at_s - found[-1][0] < 1e-9:
                found.pop()
            if not found or found[-1][1] != has - cut:
                found.append((at_s, has - cut))
        ends = [*(at_s for at_s, _ in found[1:]), self.t[-1]]
        return [(at_s, until_s, working) for (at_s, working), until_s in zip(found, ends)]

    def changes_of_graph(self):
        """(time, edges of the schedule from then on, or event) in order; at one time the schedule comes first."""
        told, end_s = self.summary.get("graph", {"edges": []}), self.t[-1]
        phases = told.get("schedule") or [{"at_s": 0, "edges": told["edges"]}]
        repeat_s = self.config.get("graph", {}).get("repeat_s")
        cycles = range(int(np.ceil((end_s - 1e-9) / repeat_s)) or 1) if repeat_s else [0]
        changes = [((n * repeat_s if n else 0) + phase["at_s"], pairs(phase["edges"])) for n in cycles for phase in phases]
        changes += [(event["at_s"], event) for event in self.config.get("events", [])
                    if {"cut", "mend", "graph"} & event.keys()]
        return sorted((change for change in changes if change[0] <= end_s), key=lambda change: change[0])

    @property
    def events(self):
        """(time, words) of what changed the run, in order, without the phases of the law."""
        told = [(event["at_s"], words_of(event)) for event in self.config.get("events", [])]
        told += [(at_s, f"restart {k + 1}") for at_s, k, kind in self.faults_of_agents() if kind == "restart"]
        return sorted(((at_s, words) for at_s, words in told if words and at_s <= self.t[-1]), key=lambda of: of[0])

    @property
    def graph_phases(self):
        """(time, words) of the phases of [[graph.schedule]] that have begun, without the first; none of a schedule that
        repeats, which has too many to be told."""
        first = self.config.get("graph", {})
        tables = [] if first.get("repeat_s") else [table for table in first.get("schedule", [])
                                                   if table["at_s"] <= self.t[-1]]
        return [(now["at_s"], f"topology = {now['topology']}" if "topology" in now else "another graph")
                for now in tables]

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


def pairs(edges):
    return frozenset((int(edge[0]) - 1, int(edge[1]) - 1) for edge in edges)


def cut_by(event, cut, declared):
    """The edges that work no more after an event, of those declared."""
    if "graph" in event:
        return frozenset(declared) - pairs(event["graph"]["edges"])
    return (cut | pairs(event.get("cut", []))) - pairs(event.get("mend", []))


def number(value):
    return f"{value:g}" if isinstance(value, (int, float)) and not isinstance(value, bool) else str(value)


def words_of_change(before, now):
    """What a phase of [[law.schedule]] or of [[graph.schedule]] changes, in few words: its new values of what both phases
    have, or else what one of them lacks. A phase with another law is called by this law."""
    if now.get("name") != before.get("name"):
        return now["name"]
    both = [key for key in now if key in before and key not in ("at_s", "schedule") and now[key] != before[key]]
    keys = both or [key for key in now if key not in before and key != "at_s"]
    words = [key if isinstance(now[key], (list, dict)) else f"{key} = {number(now[key])}" for key in keys]
    words = words or [f"no {key}" for key in before if key not in now and key not in ("at_s", "schedule")]
    return ", ".join(words[:WORDS_MAX]) + (f" and {len(words) - WORDS_MAX} more" if len(words) > WORDS_MAX else "")


def words_of(event):
    """What an event of config.toml does, in few words."""
    words = [f"{key.split('.')[-1]} = {number(value)}" for key, value in event.get("set", {}).items()]
    if words and "agents" in event:
        words.append("of " + ", ".join(map(str, event["agents"])))
    if "goto" in event:
        words.append(f"goto {event['goto']['agent']}")
    for key in ("cut", "mend"):
        if edges := event.get(key):
            words.append(f"{key} {edges[0][0]},{edges[0][1]}" + (f" and {len(edges) - 1} more" if edges[1:] else ""))
    if "graph" in event:
        words.append("another graph")
    if fault := event.get("fault"):
        of = "" if fault.get("of", "agent") == "agent" else f"{fault['of']} "
        words.append(f"{of}{fault['kind']} {fault['agent']}")
    return ", ".join(words)


csv.field_size_limit(2**31 - 1)  # an event may hold a large graph, or a whole law

FORMAT = 1  # of config.toml and summary.json: the newest that is understood here


def check_format(path, contents):
    """What says no format is of version 1."""
    if contents.get("format", 1) > FORMAT:
        raise RunError(f"{path}: it is of format {contents['format']}, newer than the {FORMAT} that this version reads",
                       code=2)
    return contents


def read_text(path, parse):
    """The table in a file of TOML or JSON."""
    try:
        with open_regular(path, encoding="utf-8") as file:
            table = parse(file.read())
        if not isinstance(table, dict):
            raise RunError(f"{path}: expected a table, got a {type(table).__name__}")
        return check_format(path, table)
    except (ValueError, RecursionError) as error:  # tomllib's and json's errors are ValueErrors
        raise RunError(f"{path}: {error}") from None
    except OSError as error:
        raise RunError(f"{path}: {error.strerror}") from None


def why_no_states(folder):
    """Why a folder has no states.npz, and how to get one."""
    if not (folder / "config.toml").exists():
        return "this is not the folder of a run"
    if not read_text(folder / "config.toml", tomllib.loads).get("output", {}).get("save_data", True):
        why = "output.save_data is off"
    elif (folder / "summary.json").exists():
        why = "it was removed"
    else:
        why = "the run was killed, or has not ended"
    return f"{why}; orchestrator export {folder} --format npz writes it"


def check_unpacked(path, file):
    """Refuses a small file that unpacks to very much."""
    with zipfile.ZipFile(file) as archive:
        unpacked = sum(entry.file_size for entry in archive.infolist())
    packed = path.stat().st_size
    if unpacked > UNPACKED_FREE + UNPACKED_TIMES * packed:
        raise RunError(f"{path}: unpacks to {unpacked} bytes, above the limit of {UNPACKED_FREE} and "
                       f"{UNPACKED_TIMES} times the {packed} that it takes")
    file.seek(0)


def check_states(path, arrays):
    """Refuses what no run has: agents without numbers of their own, times that do not increase, what is no number."""
    t, ids = arrays["t"], arrays["id"]
    for name, array in arrays.items():
        if array.dtype.kind not in "iuf":
            raise RunError(f"{path}: {name}: expected numbers, got {array.dtype}")
    if not np.isfinite(t).all() or (np.diff(t) <= 0).any():
        raise RunError(f"{path}: t: expected times that increase, got others")
    if (ids != np.round(ids)).any() or (ids < 1).any() or len(set(ids.tolist())) < len(ids):
        raise RunError(f"{path}: id: expected each agent's number once, from 1 on, got others")
    if (arrays["flags"] != np.round(arrays["flags"])).any() or (arrays["flags"] < 0).any():
        raise RunError(f"{path}: flags: expected integers from 0 on, got others")
    for name in ("position", "velocity"):
        if not np.isfinite(arrays[name]).all():
            row, agent = np.argwhere(~np.isfinite(arrays[name]))[0][:2]
            raise RunError(f"{path}: {name}: expected finite numbers, got others at {t[row]:g} s of agent {ids[agent]}")


def read_states(path):
    try:
        with open_regular(path, "rb") as file:
            check_unpacked(path, file)
        with open_regular(path, "rb") as file, np.load(file, allow_pickle=False) as states:
            arrays = {name: states[name] for name in ["t", "id", *ARRAYS]}
            arrays["flags"] = states["flags"] if "flags" in states else None
    except KeyError as error:
        raise RunError(f"{path}: {str(error.args[0]).split(' is not')[0]}: no such array") from None
    except FileNotFoundError:
        raise RunError(f"{path}: no such file: {why_no_states(path.parent)}") from None
    except OSError as error:
        raise RunError(f"{path}: {error.strerror or 'cannot be read'}") from None
    except (ValueError, TypeError, EOFError, RuntimeError, SyntaxError, zipfile.BadZipFile, zlib.error):
        raise RunError(f"{path}: damaged, or not an .npz file of numbers") from None
    rows, agents = arrays["t"].size, arrays["id"].size
    arrays["t"], arrays["id"] = arrays["t"].ravel(), arrays["id"].ravel()
    for name, width in ARRAYS.items():
        if arrays[name].shape != (rows, agents, width):
            raise RunError(f"{path}: {name}: expected shape ({rows}, {agents}, {width}), got {arrays[name].shape}")
    if arrays["flags"] is None:
        arrays["flags"] = np.zeros((rows, agents), dtype=int)
    if arrays["flags"].shape != (rows, agents):
        raise RunError(f"{path}: flags: expected shape ({rows}, {agents}), got {arrays['flags'].shape}")
    if rows == 0 or agents == 0:
        raise RunError(f"{path}: holds no tick")
    check_states(path, arrays)
    arrays["flags"] = arrays["flags"].astype(int)
    return arrays


def read_incidents(path, ids):
    """The lines of events.csv about agents, in order; none if there is no such file. Events are no incidents."""
    index = {number: k for k, number in enumerate(ids)}

    def indices(row):
        other = row["with"].removeprefix("agent ") if row["what"] == "contact" else ""
        return tuple(index[int(agent)] for agent in (row["agent"], other) if agent.isdigit() and int(agent) in index)

    try:
        with open_regular(path, encoding="utf-8", newline="") as file:
            rows, found = csv.DictReader(file), []
            for row in rows:
                if not row["agent"]:
                    continue
                from_s, until_s = float(row["t_s"]), float(row["until_s"])
                if not (np.isfinite(from_s) and np.isfinite(until_s)) or None in row or None in row.values():
                    raise RunError(f"{path}:{rows.line_num}: expected an incident with its times, got {row['t_s']} and "
                                   f"{row['until_s']}")
                found.append(Incident(from_s, until_s, row["what"], indices(row)))
            return found
    except FileNotFoundError:
        return []
    except OSError as error:
        raise RunError(f"{path}: {error.strerror}") from None
    except (ValueError, TypeError, AttributeError, KeyError, csv.Error):
        raise RunError(f"{path}: damaged, or not a table of events") from None


def read_curve(path):
    """Times and values of law_curve.csv; nothing if there is no such file."""
    try:
        with open_regular(path, encoding="utf-8", newline="") as file:
            rows = csv.DictReader(file)
            found = np.array([(float(row["t_s"]), float(row["value"])) for row in rows]).reshape(-1, 2).T
    except FileNotFoundError:
        return ()
    except OSError as error:
        raise RunError(f"{path}: {error.strerror}") from None
    except (ValueError, TypeError, KeyError, csv.Error):
        raise RunError(f"{path}: damaged, or not a table of times and values") from None
    if not np.isfinite(found).all() or (np.diff(found[0]) <= 0).any():
        raise RunError(f"{path}: expected times that increase and numbers, got others")
    return tuple(found) if found.size else ()


def read_run(folder):
    if not folder.is_dir():
        raise RunError(f"{folder}: no such folder", code=2)
    states = read_states(folder / "states.npz")
    config = read_text(folder / "config.toml", tomllib.loads)
    summary = folder / "summary.json"
    return Run(**states, config=config, summary=read_text(summary, json.loads) if summary.exists() else {},
               incidents=read_incidents(folder / "events.csv", states["id"]),
               law_curve=read_curve(folder / "law_curve.csv"))


def disagreement(run):
    """(T, N): distance of every agent to the leader, or else to the mean of those who count, along the axes of the law
    (m); the leader is that of the phase. In a formation, the places are subtracted from the positions first. NaN in
    phases whose law does not make agents agree."""
    p = (run.position - run.places)[:, :, run.axes]
    distance = np.full(p.shape[:2], np.nan)
    for span in run.spans:
        if "disagreement" in span.drawing["pictures"]:
            of, leader = p[span.rows], run.leader_of(span.law)
            counts = run.counts[span.rows][:, :, None]
            reference = of.mean(axis=1, keepdims=True, where=counts) if leader is None else of[:, [leader]]
            distance[span.rows] = np.linalg.norm(of - reference, axis=2)
    return distance


def largest(run, distance):
    """(T): the largest distance of those who count."""
    return np.where(run.counts, distance, -np.inf).max(axis=1)


def curve_of_last_law(run):
    """What the curve of the law is called, as the row of the law says, and its (times, values), of the phases that have
    it: those of the last phase with a curve. None: there is none."""
    told = [span.drawing["curve"] for span in run.spans]
    of_last = next((curve for curve in reversed(told) if curve), None)
    if not of_last or not run.law_curve:
        return None
    t, values = run.law_curve
    ends = [*(span.at_s for span in run.spans[1:]), np.inf]
    is_its = np.zeros(t.size, dtype=bool)
    for span, end, curve in zip(run.spans, ends, told):
        if curve == of_last:
            is_its |= (t >= span.at_s) & (t < end)
    return of_last, t, np.where(is_its, values, np.nan)


def predicted_of_curve(run, span):
    """(number, bound) that theory predicts of the values of the curve in a phase, or None."""
    law = span.summary.get("laws", {}).get(span.law.get("name"), {})
    figure = (span.drawing["curve"] or {}).get("figure")
    value = law.get("predicted", {}).get(figure)
    return (value, law.get("bounds", {}).get(figure)) if isinstance(value, (int, float)) else None


def is_on_a_line(run):
    """Whether all agents keep to one straight line, seen from above."""
    p = run.position[:, :, :2].reshape(-1, 2)
    along, across = np.linalg.svd((p - p.mean(axis=0)).T @ (p - p.mean(axis=0)), compute_uv=False)
    return across <= 1e-4 * along  # of squares: one part in 100


def separation(run):
    """(T): smallest distance between two agents along the axes of the law (m)."""
    rows = max(1, NUMBERS_AT_ONCE // run.size)
    return np.concatenate([np.sqrt(least_square(run.position[begin:begin + rows, :, run.axes]))
                           for begin in range(0, run.t.size, rows)])


def least_square(p):
    """(T): smallest square of a distance between two of the points (T, N, axes) of a row."""
    along = [np.ascontiguousarray(p[:, :, axis]) for axis in range(p.shape[2])]
    least = np.full(p.shape[0], np.inf)
    for k in range(1, p.shape[1]):
        squares = 0
        for x in along:
            apart = x[:, k:] - x[:, :-k]
            apart *= apart
            squares = np.add(squares, apart, out=apart)
        np.minimum(least, squares.min(axis=1), out=least)
    return least


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

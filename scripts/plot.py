#!/usr/bin/python3
"""Draws the pictures of one run, from its states.npz, config.toml and (where there is one) summary.json.

The figures are those of the MASCOT paper: paths in the x-y plane, position, velocity, error and acceleration over
time. The same run always gives the same bytes. Exit codes: 0 done, 1 the run cannot be read, 2 wrong use.
"""

import argparse
import os
import pathlib
import sys
from dataclasses import dataclass

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.patches import Circle, Polygon, Rectangle

sys.dont_write_bytecode = True  # the folder of the scripts may be read-only
from figure_style import OKABE_ITO, STYLE
from run_folder import RunError, cells, disagreement, hull, read_run, spanning_tree, waypoint_targets

# Colours for more agents than OKABE_ITO has: viridis without its palest end.
MANY = matplotlib.colors.ListedColormap(plt.get_cmap("viridis")(np.linspace(0, 0.95, 256)), "many")
LEGEND_MAX = 10  # more agents than this share a colour bar
DRAWN_MAX = 200  # more lines than this are unreadable: only every n-th agent is drawn
LEAST_RANGE = 0.02  # m, m/s or m/s²: least range of a y axis, so that a held height is a flat line
FLOOR_M = 1e-6  # bottom of log axes
SMOOTHING_S = 0.5  # window for the mean of a switching acceleration
AXIS_NAMES = "xyz"
LINES = {"lines.linewidth": 1.2}


# --- drawing --------------------------------------------------------------------------------------------


def colours(run):
    if run.size <= len(OKABE_ITO):
        return OKABE_ITO[: run.size]
    return [MANY(k / (run.size - 1)) for k in range(run.size)]


def drawn(run):
    return np.unique(np.linspace(0, run.size - 1, min(run.size, DRAWN_MAX)).astype(int))


def agent_label(run, index):
    roles = [run.drawing["leader"]] * (index in run.leads) + ["lies"] * (index in run.liars)
    return f"agent {run.id[index]}" + (f" ({', '.join(roles)})" if roles else "")


def titled(figure, run, what):
    some = f" ({len(drawn(run))} of {run.size} agents drawn)" if run.size > DRAWN_MAX else ""
    figure.suptitle(f"{run.name}: {what}{some}" if run.name else f"{what}{some}", x=0.01, ha="left", fontsize=11)


def name_agents(figure, axes, run):
    """Adds a legend beside the first panel, or for many agents a colour bar beside all panels."""
    first = axes[0]
    handles, labels = first.get_legend_handles_labels()
    if run.size > LEGEND_MAX:
        scale = matplotlib.cm.ScalarMappable(matplotlib.colors.Normalize(run.id[0], run.id[-1]), MANY)
        figure.colorbar(scale, ax=list(axes), label="agent", pad=0.02, aspect=40)
        kept = [k for k, label in enumerate(labels) if not label.startswith("agent ") or label.endswith(")")]
        handles, labels = [handles[k] for k in kept], [labels[k] for k in kept]
        if handles:
            first.legend(handles, labels, loc="upper right", ncols=len(handles), frameon=True, framealpha=0.8)
    elif handles:
        first.legend(handles, labels, loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0)


def plot_agents(axis, run, x, y, indices=None):
    """Plots one line per agent; y is (T, N). Lines of leaders are thicker and on top, those of liars dashed."""
    palette, leaders, liars = colours(run), run.leads, run.liars
    for k in drawn(run) if indices is None else indices:
        leads = k in leaders
        axis.plot(
            x if x.ndim == 1 else x[:, k], y[:, k], color=palette[k], label=agent_label(run, k),
            linewidth=2.2 if leads else 1.2 if run.size <= LEGEND_MAX else 0.8, zorder=3 if leads else 2,
            linestyle="--" if k in liars else "-",
        )


def widen(axis, least):
    """Makes the y range at least `least`, around its middle."""
    low, high = axis.get_ylim()
    if high - low < least:
        axis.set_ylim((low + high - least) / 2, (low + high + least) / 2)


def time_axis(axis, run):
    axis.set_xlabel("time (s)")
    axis.set_xlim(run.t[0], run.t[-1] if run.t.size > 1 else run.t[0] + 1)


def mark_phases(axes, run):
    """Draws a line where each phase of [[law.schedule]] begins, and names its law above the first panel."""
    for axis in axes:
        for phase in run.phases[1:]:
            axis.axvline(phase["at_s"], color="0.5", linewidth=0.8, zorder=1)
    for phase in run.phases:
        axes[0].annotate(phase["law"], (phase["at_s"], 1), xycoords=("data", "axes fraction"), xytext=(2, 2),
                         textcoords="offset points", fontsize=7, color="0.3", annotation_clip=False)


def panels(run, values, symbol, unit, what, axes):
    """Plots `values` (T, N, 3) over time, in a panel per axis."""
    figure, grid = plt.subplots(len(axes), 1, sharex=True, figsize=(8, 1.2 + 1.9 * len(axes)), squeeze=False)
    for panel, k in zip(grid[:, 0], axes):
        plot_agents(panel, run, run.t, values[:, :, k])
        panel.set_ylabel(f"{symbol.format(AXIS_NAMES[k])} ({unit})")
        widen(panel, LEAST_RANGE)
    time_axis(grid[-1, 0], run)
    mark_phases(grid[:, 0], run)
    figure.align_ylabels()
    titled(figure, run, what)
    return figure, grid[:, 0]


def draw_graph(axis, run, p):
    """Draws the edges of the graph in grey: between initial positions if the agents end close together, else between
    final positions."""
    spread = [np.ptp(p[row], axis=0).max() for row in (0, -1)]
    at = p[-1] if spread[1] > 0.3 * spread[0] else p[0]
    pairs = sorted({(min(e), max(e)) for e in run.edges})
    axis.add_collection(LineCollection([at[list(e)] for e in pairs], colors="0.6", linewidths=0.8,
                                       alpha=max(0.1, min(0.8, 40 / max(1, len(pairs)))), zorder=1,
                                       label="hears" if pairs else None))


def draw_obstacles(axis, run):
    """Draws the obstacles as seen from above."""
    look = {"facecolor": "0.85", "edgecolor": "0.6", "zorder": 0.5}
    for obstacle in run.obstacles:
        (x, y), (width, depth) = obstacle["position_m"][:2], obstacle["size_m"][:2]
        if obstacle["shape"] == "box":
            axis.add_patch(Rectangle((x - width / 2, y - depth / 2), width, depth, rotation_point="center",
                                     angle=np.degrees(obstacle.get("heading_rad", 0)), **look))
        else:
            axis.add_patch(Circle((x, y), width / 2, **look))


def draw_areas(axis, run, p):
    """Draws the areas of the law at the end: the hull of its leaders, the cells into which agents divide a region."""
    look = {"facecolor": "none", "edgecolor": "0.55", "zorder": 1.2}
    if run.drawing["hull"]:
        axis.add_patch(Polygon(hull(p[-1, run.leads]), linestyle="--", label="hull of leaders", **look))
    if run.drawing["cells"]:
        for part in cells(run.law[run.drawing["cells"]], p[-1]):
            axis.add_patch(Polygon(part, **look))
        axis.plot([], [], color=look["edgecolor"], label="cells")


def draw_places(axis, run):
    """Draws the waypoints and the predicted meeting point."""
    points = np.asarray(run.law.get("waypoints_m", run.law.get("leader_waypoints_m", [])), dtype=float).reshape(-1, 3)
    if len(points):
        axis.plot(points[:, 0], points[:, 1], "D", color="0.35", ms=5, mfc="none", zorder=1.5, label="waypoints")
    for n, point in enumerate(points, start=1):
        axis.annotate(str(n), point[:2], xytext=(6, 6), textcoords="offset points", color="0.35")
    value_m = ((run.summary.get("consensus") or {}).get("predicted") or {}).get("value_m")
    if value_m:
        axis.plot(*value_m[:2], "*", color="0.2", ms=13, mfc="none", mew=1.2, zorder=5, label="predicted")


def paths(run):
    figure, axis = plt.subplots(figsize=(7.5, 6))
    p = run.position[:, :, :2]
    draw_graph(axis, run, p)
    draw_obstacles(axis, run)
    draw_areas(axis, run, p)
    plot_agents(axis, run, p[:, :, 0], p[:, :, 1])
    shown, palette = drawn(run), colours(run)
    marks = {"s": 45 if run.size <= LEGEND_MAX else 22, "zorder": 4}
    edges = [palette[k] for k in shown]
    axis.scatter(*p[0, shown].T, marker="o", facecolors="white", edgecolors=edges, **marks)
    axis.scatter(*p[-1, shown].T, marker="x", c=edges, **marks)
    draw_places(axis, run)
    axis.plot([], [], "o", color="0.3", mfc="white", label="start")
    axis.plot([], [], "x", color="0.3", label="end")
    axis.set(xlabel="x, east (m)", ylabel="y, north (m)")
    axis.margins(0.06)
    axis.set_aspect("equal", adjustable="datalim")
    widen(axis, 1.0)
    titled(figure, run, "paths seen from above")
    name_agents(figure, [axis], run)
    return figure


def position(run, axes=(0, 1, 2)):
    figure, grid = panels(run, run.position, "{}", "m", "position", axes)
    name_agents(figure, grid, run)
    return figure


def velocity(run, axes=(0, 1, 2)):
    figure, grid = panels(run, run.velocity, "$v_{}$", "m/s", "velocity", axes)
    name_agents(figure, grid, run)
    return figure


def moving_mean(t, values, span_s):
    """Mean over the `span_s` up to each row (less at the start)."""
    total = np.concatenate([np.zeros_like(values[:1]), np.cumsum(values, axis=0)])
    begin = np.searchsorted(t, t - span_s, side="right")
    end = np.arange(1, t.size + 1)
    return (total[end] - total[begin]) / (end - begin)[:, None, None]


def acceleration(run):
    """Acceleration commanded by the law, after the limits: the force of the paper per mass."""
    values, what = run.acceleration_command, "commanded acceleration"
    switches = run.drawing["switches"]  # bang-bang: single lines would be unreadable
    if switches:
        values, what = moving_mean(run.t, values, SMOOTHING_S), f"{what} (bold: mean over {SMOOTHING_S:g} s)"
    figure, grid = panels(run, values, "$a_{}$", "m/s²", what, run.axes)
    for k, panel in zip(run.axes, grid) if switches else ():
        colors = [colours(run)[n] for n in drawn(run)]
        lines = [np.stack([run.t, run.acceleration_command[:, n, k]], axis=1) for n in drawn(run)]
        panel.add_collection(LineCollection(lines, colors=colors, linewidths=0.5, alpha=0.2, zorder=1))
        panel.autoscale_view()
    limit = run.config.get("control", {}).get("max_acceleration_m_per_s2", 3.0)
    label = f"limit ±{limit:g} m/s²"
    for k, panel in zip(run.axes, grid):
        peak = np.abs(run.acceleration_command[:, :, k]).max()
        if not run.acceleration_command.any():
            panel.set_title("none is commanded", fontsize=8, color="0.3", loc="right")
        elif peak > limit * (1 + 1e-9):
            panel.set_title("some agents have other limits", fontsize=8, color="0.3", loc="right")
        elif peak >= 0.25 * limit:
            for side in (-limit, limit):
                panel.axhline(side, color="0.3", linestyle="--", linewidth=1, label=label if side > 0 else None)
        else:
            panel.set_title(f"{label}, out of view", fontsize=8, color="0.3", loc="right")
    name_agents(figure, grid, run)
    return figure


def log_panel(run, distance_m, what, ylabel):
    """Plots distances (T, N) over time on a log axis."""
    figure, axis = plt.subplots(figsize=(8, 4.2))
    visible = [k for k in drawn(run) if distance_m[:, k].max() > FLOOR_M] or [0]
    plot_agents(axis, run, run.t, np.maximum(distance_m, FLOOR_M), visible)
    axis.set_yscale("log")
    axis.set_ylabel(ylabel)
    time_axis(axis, run)
    mark_phases([axis], run)
    titled(figure, run, what)
    return figure, axis


def mark_time(axis, t_s, label):
    if t_s is not None:
        axis.axvline(t_s, color="0.3", linestyle=":", linewidth=1.2, label=f"{label} {t_s:.2f} s")


def disagreement_figure(run):
    distance_m = disagreement(run)
    to = "the mean" if run.leader is None else f"agent {run.id[run.leader]}"
    what = f"distance from its place, seen from {to}" if np.any(run.places) else f"distance to {to}"
    figure, axis = log_panel(run, distance_m, f"disagreement ({what})", f"{what} (m)")
    largest_m = np.maximum(distance_m[:, run.honest].max(axis=1), FLOOR_M)
    axis.plot(run.t, largest_m, color="0.1", linewidth=3, alpha=0.25, zorder=1, label="largest")
    begins = [phase["at_s"] for phase in run.phases] or [run.t[0]]
    for k, (begin, end) in enumerate(zip(begins, [*begins[1:], run.t[-1]])):
        axis.hlines(0.02 * largest_m[np.searchsorted(run.t, begin)], begin, end, color="0.3", linestyle="--",
                    linewidth=1, label="2 % of the start" if k == 0 else None)
    settled_s = (run.summary.get("consensus") or {}).get("settling_time_s")
    mark_time(axis, None if settled_s is None else begins[-1] + settled_s, "settled at")
    name_agents(figure, [axis], run)
    return figure


def error(run):
    targets = np.stack([waypoint_targets(run, agent) for agent in range(run.size)], axis=1)
    distance_m = np.linalg.norm((targets - run.position)[:, :, run.axes], axis=2)
    figure, axis = log_panel(run, distance_m, "error (distance to the current waypoint)", "distance (m)")
    if not run.law.get("times_s"):
        radius_m = run.law.get("arrival_radius_m", 0.2)
        axis.axhline(radius_m, color="0.3", linestyle="--", linewidth=1, label=f"arrival radius {radius_m:g} m")
    name_agents(figure, [axis], run)
    return figure


def tracking(run):
    """Position and speed of every agent relative to its parent in the tree: z and w of the min-max law."""
    tree = dict(spanning_tree(run))
    parent = np.array([tree.get(k, k) for k in range(run.size)])
    figure, grid = plt.subplots(2, len(run.axes), sharex=True, figsize=(5 * len(run.axes), 5.4), squeeze=False)
    rows = [(run.position, "{} relative to parent (m)"), (run.velocity, "$v_{}$ relative to parent (m/s)")]
    bound_s = ((run.summary.get("consensus") or {}).get("predicted") or {}).get("minmax_time_s")
    for row, (values, label) in zip(grid, rows):
        relative = values - values[:, parent]
        for panel, k in zip(row, run.axes):
            plot_agents(panel, run, run.t, relative[:, :, k], [c for c in drawn(run) if c in tree])
            panel.set_ylabel(label.format(AXIS_NAMES[k]))
            mark_time(panel, bound_s, "predicted")
    for panel in grid[-1]:
        time_axis(panel, run)
    figure.align_ylabels()
    titled(figure, run, "tracking of the parent in the spanning tree")
    name_agents(figure, [grid[0, -1], *[p for p in grid.flat if p is not grid[0, -1]]], run)
    return figure


# --- which figures a run gets ---------------------------------------------------------------------------


@dataclass(frozen=True)
class Picture:
    draw: object
    switch: str  # the key of [output] that turns it off
    applies: object  # run -> None, or why the picture does not apply to it


def only_if(condition, reason):
    return lambda run: None if condition(run) else reason


ALWAYS = only_if(lambda run: True, "")
PICTURES = {
    "paths": Picture(paths, "position_plot", ALWAYS),
    "position": Picture(position, "position_plot", ALWAYS),
    "velocity": Picture(velocity, "velocity_plot", ALWAYS),
    "disagreement": Picture(disagreement_figure, "position_plot", only_if(
        lambda run: run.size > 1 and "disagreement" in run.drawing["pictures"],
        "it needs several agents and a law of agreement")),
    "acceleration": Picture(acceleration, "velocity_plot", ALWAYS),
    "tracking": Picture(tracking, "position_plot", only_if(
        lambda run: "tracking" in run.drawing["pictures"] and run.edges and not run.phases,
        "it needs a law of pursuit, from start to end, and the graph in summary.json")),
    "error": Picture(error, "position_plot", only_if(
        lambda run: "error" in run.drawing["pictures"] and not run.phases,
        "it needs a law that flies to waypoints, from start to end")),
}


def choose(run, only):
    """Names of the pictures to draw."""
    if only and PICTURES[only].applies(run):
        raise RunError(f"--only {only}: {PICTURES[only].applies(run)}", code=2)
    names = [only] if only else [name for name, picture in PICTURES.items() if not picture.applies(run)]
    return [name for name in names if run.output(PICTURES[name].switch)]


def can_open_windows():
    if not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        return False
    for backend in ("TkAgg", "QtAgg", "GTK3Agg"):
        try:
            plt.switch_backend(backend)
            plt.close(plt.figure())
            return True
        except Exception:  # each toolkit has its own exceptions for "not installed" and "no display"
            plt.switch_backend("Agg")
    return False


def draw_all(folder, run, only, show):
    if show and not can_open_windows():
        print("no display: no window is opened", file=sys.stderr)
        show = False
    matplotlib.rcParams.update(matplotlib.rcParamsDefault | STYLE | LINES | {"backend": plt.get_backend()})
    if not run.summary.get("drawing"):
        print(f"{folder}: summary.json does not say how the law is drawn: only what all laws have is", file=sys.stderr)
    names = choose(run, only) if show or run.output("save_plot") else []
    if not names:
        print(f"{folder}: no picture drawn: config.toml's [output] switches them off", file=sys.stderr)
    for name in names:
        figure = PICTURES[name].draw(run)
        if run.output("save_plot"):
            figure.savefig(folder / f"{name}.png", metadata={"Software": None})
        if not show:
            plt.close(figure)
    if show:
        plt.show()


class Parser(argparse.ArgumentParser):
    def error(self, message):
        raise RunError(message, code=2)


def main(arguments):
    parser = Parser(description="Draws the pictures of a run into its folder.")
    parser.add_argument("run", metavar="RUN_FOLDER", type=pathlib.Path)
    parser.add_argument("--show", action="store_true", help="open windows, too")
    parser.add_argument("--only", metavar="NAME", choices=PICTURES, help="one of " + ", ".join(PICTURES))
    try:
        options = parser.parse_args(arguments)
        run = read_run(options.run)
        draw_all(options.run, run, options.only, options.show or run.output("show_plot"))
    except RunError as error_:
        print(f"error: {error_}", file=sys.stderr)
        return error_.code
    except OSError as error_:
        print(f"error: {error_.filename}: {error_.strerror}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))

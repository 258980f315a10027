"""Several runs in one picture: the agents of a run share its colour and its kind of line, which both tell runs apart."""

import figure_style as style
import matplotlib.pyplot as plt
import numpy as np
from pictures import (
    AXIS_NAMES, LEAST_RANGE, PICTURES, above, curve_floor, curve_label, draw_obstacles, drawn, floor_of, in_a_word,
    map_axis, name_floor, panel_grid, seen_from, square_figure, time_axis, widen,
)
from run_folder import RunError, curve_of_last_law, disagreement, largest


def names_of(folders, runs):
    """What tells the runs apart: their names, those of their folders, or the ways to them."""
    for names in ([run.name for run in runs], [folder.resolve().name for folder in folders]):
        if len(set(names)) == len(names) and all(names):
            return names
    return [str(folder) for folder in folders]


def each(names, runs):
    """The runs, each with how to draw its lines; the label is for the first of them."""
    for name, run, (colour, line) in zip(names, runs, style.looks_of_runs(len(runs))):
        yield run, {"color": colour, "linestyle": line}, name


def plot_lines(axis, x, y, name, look, agents=None):
    """One line per column of y, all alike. `agents`: the numbers of theirs, if each has one."""
    lines = axis.plot(x, y, **look, alpha=0.5 + 0.5 / y.shape[1])
    for line, number in zip(lines, () if agents is None else agents):
        line.told = f"{style.word(name)}, agent {number}"
    lines[0].set_label(name)


def finished(figure, axis, what):
    handles, labels = axis.get_legend_handles_labels()
    style.title(figure, what)
    style.add_legend(figure, handles, labels)
    style.wrap_labels(figure)
    return figure


def all_time(axis, runs):
    time_axis(axis, min(run.begin_s for run in runs), max(run.end_s for run in runs))


def paths(names, runs):
    figure, axis = square_figure()
    draw_obstacles(axis, runs[0])
    start, end = ("first", "last") if any(np.isfinite([run.from_s, run.to_s]).any() for run in runs) else ("start", "end")
    for run, look, name in each(names, runs):
        p = run.position[run.rows, :, :2][:, drawn(run)]
        plot_lines(axis, p[:, :, 0], p[:, :, 1], name, look, run.id[drawn(run)])
        axis.plot(*p[0].T, "o", markersize=4, color=look["color"], markerfacecolor=style.grey(1), zorder=4)
        axis.plot(*p[-1].T, "x", markersize=4, color=look["color"], zorder=4)
    axis.plot([], [], "o", color=style.grey(0.3), markersize=4, markerfacecolor=style.grey(1), label=start)
    axis.plot([], [], "x", color=style.grey(0.3), markersize=4, label=end)
    map_axis(axis)
    return finished(figure, axis, "paths seen from above")


def over_time(what, symbol, unit, values_of, axes_of):
    def draw(names, runs):
        axes = sorted(set().union(*map(axes_of, runs)))
        figure, grid = panel_grid(len(axes))
        for panel, k in zip(grid, axes):
            for run, look, name in each(names, runs):
                plot_lines(panel, run.t[run.rows], values_of(run)[run.rows, :, k][:, drawn(run)], name, look,
                           run.id[drawn(run)])
            panel.set_ylabel(f"{symbol.format(AXIS_NAMES[k])} ({unit})")
            widen(panel, LEAST_RANGE)
        all_time(grid[-1], runs)
        figure.align_ylabels()
        return finished(figure, grid[0], what)
    return draw


def disagreements(names, runs):
    figure, axis = plt.subplots(figsize=(style.size().width, style.size().single))
    floor, curves = max(map(floor_of, runs)), []
    for run, look, name in each(names, runs):
        curves.append(largest(run, disagreement(run))[run.rows])
        plot_lines(axis, run.t[run.rows], above(floor, curves[-1])[:, None], name, look)
    style.log_axis(axis)
    name_floor(axis, floor, *curves)
    axis.set_ylabel(f"largest distance to {in_a_word([name for run in runs for name in seen_from(run)])} (m)")
    all_time(axis, runs)
    return finished(figure, axis, "disagreement")


def curves(names, runs):
    """The curves of the laws, if all are of one name."""
    figure, axis = plt.subplots(figsize=(style.size().width, style.size().single))
    found = [curve_of_last_law(run) for run in runs]
    told = found[0][0]
    floor = curve_floor(told, runs, np.concatenate([values for _, _, values in found]))
    for (run, look, name), (_, t, values) in zip(each(names, runs), found):
        seen = (t >= run.begin_s - 1e-9) & (t <= run.end_s + 1e-9)
        plot_lines(axis, t[seen], above(floor, values)[seen][:, None], name, look)
    if floor > 0:
        style.log_axis(axis)
        name_floor(axis, floor, *(values for _, _, values in found), unit=told["unit"].replace("^2", "²"))
    axis.set_ylabel(curve_label(told))
    all_time(axis, runs)
    return finished(figure, axis, f"{told['name']} ({told['meaning']})")


def differs(runs):
    """Why the curves of runs do not belong into one picture, or None."""
    labels = dict.fromkeys(curve_label(curve_of_last_law(run)[0]) for run in runs)
    return None if len(labels) == 1 else f"expected laws with the same curve, got {', '.join(labels)}"


OVERLAYS = {
    "paths": paths,
    "curve": curves,
    "position": over_time("position", "{}", "m", lambda run: run.position, lambda run: (0, 1, 2)),
    "velocity": over_time("velocity", "$v_{}$", "m/s", lambda run: run.velocity, lambda run: (0, 1, 2)),
    "acceleration": over_time("commanded acceleration", "$a_{}$", "m/s²", lambda run: run.acceleration_command,
                              lambda run: run.axes),
    "disagreement": disagreements,
}


def draw_overlay(folders, runs, only):
    """Yields name and figure of each picture that applies to all runs, or of those in `only`."""
    names = names_of(folders, runs)
    for name in only or OVERLAYS:
        against = [(folder, PICTURES[name].applies(run)) for folder, run in zip(folders, runs)]
        against = [(folder, reason) for folder, reason in against if reason]
        if not against and name == "curve" and (reason := differs(runs)):
            against = [(folders[0], reason)]
        if not against:
            style.Chosen.wording.begin(name)
            yield name, OVERLAYS[name](names, runs)
        elif only:
            raise RunError(f"--only {name}: {against[0][0]}: {against[0][1]}", code=2)

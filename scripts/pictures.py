"""The pictures of one run, from its states.npz, config.toml and (where there is one) summary.json.

They are those of the MASCOT paper (paths in the x-y plane, position, velocity, error and acceleration over time), and
more that help to judge a run. PICTURES lists them.
"""

import re
from dataclasses import dataclass

import figure_style as style
import matplotlib
import matplotlib.pyplot as plt
import numpy as np
from figure_style import DASHED, MANY, OKABE_ITO, grey, small
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.patches import Circle, Polygon, Rectangle
from run_folder import (
    FILTERED, INFEASIBLE, cells, curve_of_last_law, disagreement, hull, is_on_a_line, largest, predicted_of_curve,
    separation, spanning_tree, waypoint_targets,
)

CROWD = 10  # more agents than this have smaller marks and thinner lines
DRAWN_MAX = 200  # more lines than this are unreadable: only every n-th agent is drawn
ROWS_MAX = 6  # of names of events; what does not fit is marked, and not named
GRAPHS_MAX = 12  # more graphs than this do not fit into a picture
LEAST_RANGE = 0.02  # m, m/s or m/s²: least range of a y axis, so that a held height is a flat line
FLOOR = 1e-6  # m, or another SI unit: bottom of log axes, below which nothing is drawn
ROUNDING = 64 * np.finfo(float).eps  # of the largest coordinate: what is below may be rounding and nothing else
DEPARTURE = 0.5  # of the disagreement at the start: a leader that moves farther leaves
SMOOTHING_S = 0.5  # window for the mean of a switching acceleration
AXIS_NAMES = "xyz"
EDGES = 0.6  # grey of edges
TOUCHES = "#D00000"  # no agent has this colour


# --- drawing --------------------------------------------------------------------------------------------


def colours(run):
    return [colour for colour, _ in style.looks(run.size)]


def drawn(run):
    """Indices of the agents whose lines are drawn."""
    shown = np.array(run.shown)
    return shown[np.unique(np.linspace(0, shown.size - 1, min(shown.size, DRAWN_MAX)).astype(int))]


def agent_label(run, index):
    roles = [run.drawing["leader"]] * (index in run.leads) + ["lies"] * (index in run.liars)
    return f"agent {run.id[index]}" + (f" ({', '.join(roles)})" if roles else "")


def titled(figure, run, what):
    shown = len(run.shown)
    some = f" ({len(drawn(run))} of {shown} agents drawn)" if len(drawn(run)) < shown else ""
    style.title(figure, f"{run.name}: {what}{some}" if run.name else f"{what}{some}")


def name_agents(figure, axes, run, most=None):
    """Adds a legend or, for more agents than `most` (than have looks of their own, by default), a colour bar beside all
    panels. To be called last: it keeps free the place that it needs."""
    is_many = len(drawn(run)) > (most or style.looks_max())
    found = {}
    for axis in axes:
        for handle, label in zip(*axis.get_legend_handles_labels()):
            found.setdefault(label, handle)
    if is_many:
        scale = matplotlib.cm.ScalarMappable(matplotlib.colors.Normalize(run.id[0], run.id[-1]), MANY)
        figure.colorbar(scale, ax=list(axes), label="agent", pad=0.02, aspect=40)
        found = {label: handle for label, handle in found.items()
                 if not label.startswith("agent ") or label.endswith(")")}
    style.add_legend(figure, list(found.values()), list(found), is_below=is_many)
    style.wrap_labels(figure)


def line_width(run, leads=False):
    return plt.rcParams["lines.linewidth"] * (1.8 if leads else 1 if run.size <= CROWD else 0.7)


def plot_agents(axis, run, x, y, indices=None):
    """Plots one line per agent; y is (T, N), of which the rows of the window are drawn. Lines of leaders are thicker and
    on top, those of liars dashed."""
    looks, leaders, liars = style.looks(run.size), run.leads, run.liars
    for k in drawn(run) if indices is None else indices:
        colour, line = looks[k]
        leads = k in leaders
        along = x if x.ndim == 1 else x[:, k]
        axis.plot(along[run.rows], y[run.rows, k], color=colour, label=agent_label(run, k),
                  linewidth=line_width(run, leads) * (1 if line == "-" else 1.3), zorder=3 if leads else 2,
                  linestyle=DASHED if k in liars else line)


def widen(axis, least):
    """Makes the y range at least `least`, around its middle."""
    low, high = axis.get_ylim()
    if high - low < least:
        axis.set_ylim((low + high - least) / 2, (low + high + least) / 2)


def time_axis(axis, begin_s, end_s):
    axis.set_xlabel("time (s)")
    axis.set_xlim(begin_s, end_s if end_s > begin_s else begin_s + 1)
    # How many ticks there are must not depend on the width of the panel, for that depends on their labels.
    most = 6 if style.size().is_narrow else 9
    axis.xaxis.set_major_locator(matplotlib.ticker.MaxNLocator(most, steps=[1, 2, 2.5, 5, 10]))


def in_rows(labels, from_s, to_s, width_pt, letter_pt):
    """Rows, from 0, in which labels (time, words) do not cover each other, and whether each ends at its time."""
    per_s = width_pt / (to_s - from_s)
    ends, rows = [], []
    for at_s, words in labels:
        left, long = (at_s - from_s) * per_s, (len(words) + 1) * letter_pt
        ends_there = left + long > width_pt and left > long
        left -= long * ends_there
        row = next((k for k, end in enumerate(ends) if end <= left), len(ends))
        ends[row:row + 1] = [left + long]
        rows.append((row, ends_there))
    return rows


def joined(changes):
    """(time, words) with the words of one time in one text."""
    found = {}
    for at_s, words in changes:
        found[at_s] = f"{found[at_s]}, {words}" if at_s in found else words
    return found


def in_window(run, changes, goes_on=False):
    """(time, words) of the changes in the window, in order. `goes_on`: also of what begins before it and goes on in it, at
    its beginning."""
    before = [words for at_s, words in sorted(changes.items()) if at_s <= run.begin_s] if goes_on else []
    inside = [(at_s, style.word(words)) for at_s, words in sorted(changes.items())
              if run.shows(at_s) and not (before and at_s <= run.begin_s)]
    return [*((run.begin_s, style.word(words)) for words in before[-1:]), *inside]


def mark_changes(axes, run, names=None):
    """Draws a line where each phase of [[law.schedule]] or [[graph.schedule]] begins and where an event changed something,
    and says above the first panel what: the phases in the lowest row. `names`: what to call the phases of the law, if not
    by what changed. Returns the height of all rows (pt), by which the figure grows."""
    of_law = list(zip((span.at_s for span in run.spans), names or run.names_of_spans))
    phases = in_window(run, joined([*(of_law if names or len(of_law) > 1 else []), *run.graph_phases]), goes_on=True)
    events = in_window(run, joined(run.events))
    axes[0].figure.told = {"change: time (s)": [at_s for at_s, _ in [*phases, *events]],
                    "change": [words for _, words in [*phases, *events]]} if phases or events else {}
    for axis in axes:
        for at_s, _ in phases:
            if at_s > run.begin_s:
                axis.axvline(at_s, color=grey(0.5), linewidth=0.8, zorder=1)
        for at_s, _ in events:
            axis.axvline(at_s, color=grey(0.5), linewidth=0.8, zorder=1, linestyle=(0, (1, 1.5)))
    size = style.size()
    begin, end = axes[0].get_xlim()
    first = 0
    for labels in (phases, events):
        rows = in_rows(labels, begin, end, 72 * (size.width - (0.6 if size.is_narrow else 2)), 0.58 * size.small_pt)
        named = [(label, place) for label, place in zip(labels, rows) if place[0] < ROWS_MAX]
        for (at_s, words), (row, ends_there) in named:
            axes[0].annotate(words, (at_s, 1), xycoords=("data", "axes fraction"), annotation_clip=False, **small(),
                             xytext=(-1 if ends_there else 1, 2 + 1.2 * size.small_pt * (first + row)),
                             textcoords="offset points", ha="right" if ends_there else "left")
        first += 1 + max((row for _, (row, _) in named), default=-1)
    figure, high_pt = axes[0].figure, 1.2 * size.small_pt * first
    figure.set_figheight(figure.get_figheight() + high_pt / 72)
    return high_pt


def panel_grid(count):
    """A figure with so many panels over time, one below the other."""
    size = style.size()
    high = 0.3 * size.panel + 0.4 + size.panel * count
    figure, grid = plt.subplots(count, 1, sharex=True, figsize=(size.width, high), squeeze=False)
    return figure, grid[:, 0]


def panels(run, values, symbol, unit, what, axes):
    """Plots `values` (T, N, 3) over time, in a panel per axis."""
    figure, grid = panel_grid(len(axes))
    for panel, k in zip(grid, axes):
        plot_agents(panel, run, run.t, values[:, :, k])
        panel.set_ylabel(f"{symbol.format(AXIS_NAMES[k])} ({unit})")
        widen(panel, LEAST_RANGE)
    time_axis(grid[-1], run.begin_s, run.end_s)
    marks_pt = mark_changes(grid, run)
    figure.align_ylabels()
    titled(figure, run, what)
    return figure, grid, marks_pt


def in_order(edges):
    """(M, 2): the edges of a set, sorted."""
    return np.array(sorted(edges), dtype=int).reshape(-1, 2)


def edge_artists(axis, at, edges, alpha=None):
    """Adds edges, as in_order() has them, between the places `at` (N, 2) in grey, paler where they are many: a line
    between two who hear each other, an arrow from j to i if i hears j and not the other way round."""
    hearer, heard = edges.T
    mutual = np.isin(heard * len(at) + hearer, hearer * len(at) + heard)
    shown = ~mutual | (hearer < heard)
    lines, arrows = edges[shown], edges[~mutual]
    alpha = alpha or max(0.15, min(0.8, 40 / max(1, len(lines))))
    artists = [axis.add_collection(LineCollection(at[lines], colors=grey(EDGES), alpha=alpha, linewidths=0.8, zorder=1))]
    if len(arrows):
        hearer, heard = arrows.T
        artists.append(arrow_heads(axis, at[heard], at[hearer], min(1, 1.5 * alpha)))
    return artists


def arrow_heads(axis, begin, end, alpha):
    """Adds heads of arrows beyond the middle of lines from `begin` to `end` (M, 2), where agents do not cover them."""
    way = end - begin
    long = np.linalg.norm(way, axis=1)[:, None]
    along = np.divide(way, long, out=np.zeros_like(way), where=long > 0)
    return axis.quiver(*(begin + 0.62 * way).T, *along.T, angles="xy", scale_units="inches", scale=12, units="inches",
                       width=1 / 84, headlength=7, headaxislength=7, headwidth=5.5, minlength=0, pivot="mid",
                       color=grey(EDGES), alpha=alpha, zorder=1.1)


def name_edges(axis, edges):
    """Adds the kinds of edges to the legend."""
    if any(edge[::-1] in edges for edge in edges):
        axis.plot([], [], color=grey(EDGES), linewidth=0.8, label="hear each other")
    if any(edge[::-1] not in edges for edge in edges):
        axis.plot([], [], color=grey(EDGES), linewidth=0.8, marker=">", markersize=4, label="arrow to who hears")


def draw_graph(axis, run, p):
    """Draws all edges that the graph ever has between agents that are drawn: between initial positions if the agents end
    close together, else between final positions."""
    spread = [np.ptp(p[row], axis=0).max() for row in (0, -1)]
    edges = {edge for edge in run.edges if run.only is None or set(edge) <= set(run.only)}
    lines = edge_artists(axis, p[-1] if spread[1] > 0.3 * spread[0] else p[0], in_order(edges))[0]
    tell_edges(lines, run, edges)
    name_edges(axis, edges)


def tell_edges(lines, run, edges, when=""):
    """Says of the lines of edges, for the table of the picture, which agents hear which."""
    hearer, heard = in_order(edges).T
    lines.told = {f"edge{when}: agent": run.id[hearer], f"edge{when}: hears agent": run.id[heard]} if edges else {}


def draw_obstacles(axis, run):
    """Draws the obstacles as seen from above."""
    look = {"facecolor": grey(0.85), "edgecolor": grey(0.6), "zorder": 0.5}
    for number, obstacle in enumerate(run.obstacles, 1):
        (x, y), (width, depth) = obstacle["position_m"][:2], obstacle["size_m"][:2]
        if obstacle["shape"] == "box":
            shape = axis.add_patch(Rectangle((x - width / 2, y - depth / 2), width, depth, rotation_point="center",
                                             angle=np.degrees(obstacle.get("heading_rad", 0)), **look))
        else:
            shape = axis.add_patch(Circle((x, y), width / 2, **look))
        shape.told = f"obstacle {number}"
    if run.obstacles:
        shape.set_label("obstacles")


def area_artists(axis, run, p):
    """Adds the areas of the law while agents are at p (N, 2): the hull of its leaders, the cells into which agents
    divide a region."""
    look = {"facecolor": "none", "edgecolor": grey(0.55), "zorder": 1.2}
    areas = []
    if run.drawing["hull"]:
        areas.append(Polygon(hull(p[run.leads]), linestyle="--", label="hull of leaders", **look))
    if run.drawing["cells"]:
        areas += [Polygon(part, **look) for part in cells(run.law[run.drawing["cells"]], p)]
        for number, area in zip(run.id, areas[-run.size:]):
            area.told = f"cell of agent {number}"
        areas[-1].set_label("cells")
    return [axis.add_patch(area) for area in areas]


def draw_places(axis, run):
    """Draws the waypoints and the predicted meeting point."""
    points = np.asarray(run.law.get("waypoints_m", run.law.get("leader_waypoints_m", [])), dtype=float).reshape(-1, 3)
    if len(points):
        axis.plot(points[:, 0], points[:, 1], "D", color=grey(0.35), ms=5, mfc="none", zorder=1.5, label="waypoints")
    for n, point in enumerate(points, start=1):
        axis.annotate(str(n), point[:2], xytext=(6, 6), textcoords="offset points", color=grey(0.35))
    value_m = ((run.summary.get("consensus") or {}).get("predicted") or {}).get("value_m")
    if value_m:
        axis.plot(*value_m[:2], "*", color=grey(0.2), ms=13, mfc="none", mew=1.2, zorder=5, label="predicted")


def square_figure():
    return plt.subplots(figsize=(style.size().width, style.size().square))


def mark_area(run):
    """Of the mark of an agent (pt²)."""
    return (45 if run.size <= CROWD else 22) * (0.5 if style.size().is_narrow else 1)


def map_axis(axis):
    axis.set(xlabel="x, east (m)", ylabel="y, north (m)")
    axis.margins(0.06)
    axis.set_aspect("equal", adjustable="datalim")
    widen(axis, 1.0)


def paths(run):
    figure, axis = square_figure()
    whole = run.position[:, :, :2]
    p = whole[run.rows]
    draw_graph(axis, run, p)
    draw_obstacles(axis, run)
    area_artists(axis, run, p[-1])
    plot_agents(axis, run, whole[:, :, 0], whole[:, :, 1])
    shown, palette = drawn(run), colours(run)
    marks = {"s": mark_area(run), "zorder": 4}
    edges = [palette[k] for k in shown]
    axis.scatter(*p[0, shown].T, marker="o", facecolors=grey(1), edgecolors=edges, **marks)
    axis.scatter(*p[-1, shown].T, marker="x", c=edges, **marks)
    draw_places(axis, run)
    if touched := [whole[np.searchsorted(run.t, one.t_s), k] for one in run.incidents if one.what == "contact"
                   and run.shows(one.t_s) for k in one.indices if k in run.shown]:
        axis.scatter(*np.transpose(touched), marker="*", s=3 * marks["s"], c=TOUCHES, edgecolors=grey(1), linewidths=0.5,
                     zorder=5, label="contact")
    begins, ends = np.isclose(run.t[[0, -1]], [run.begin_s, run.end_s], atol=1e-9)
    axis.plot([], [], "o", color=grey(0.3), mfc=grey(1), label="start" if begins else f"at {run.begin_s:g} s")
    axis.plot([], [], "x", color=grey(0.3), label="end" if ends else f"at {run.end_s:g} s")
    map_axis(axis)
    titled(figure, run, "paths seen from above")
    name_agents(figure, [axis], run)
    return figure


def position(run, axes=(0, 1, 2)):
    figure, grid = panels(run, run.position, "{}", "m", "position", axes)[:2]
    name_agents(figure, grid, run)
    return figure


def velocity(run, axes=(0, 1, 2)):
    figure, grid = panels(run, run.velocity, "$v_{}$", "m/s", "velocity", axes)[:2]
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
    figure, grid, marks_pt = panels(run, values, "$a_{}$", "m/s²", what, run.axes)
    for k, panel in zip(run.axes, grid) if switches else ():
        colors = [colours(run)[n] for n in drawn(run)]
        lines = [np.stack([run.t, run.acceleration_command[:, n, k]], axis=1)[run.rows] for n in drawn(run)]
        panel.add_collection(LineCollection(lines, colors=colors, linewidths=0.5, alpha=0.2, zorder=1)).told = {
            f"{style.word(agent_label(run, n))}, no mean: a_{AXIS_NAMES[k]} (m/s²)": line[:, 1]
            for n, line in zip(drawn(run), lines)}
        panel.autoscale_view()
    limit = run.config.get("control", {}).get("max_acceleration_m_per_s2", 3.0)
    label = f"limit ±{limit:g} m/s²"
    for k, panel in zip(run.axes, grid):
        note = {"loc": "right", "pad": 2 + (marks_pt if panel is grid[0] else 0), **small()}
        peak = np.abs(run.acceleration_command[run.rows, :, k]).max()
        if not run.acceleration_command.any():
            panel.set_title("none is commanded", **note)
        elif peak > limit * (1 + 1e-9):
            panel.set_title("some agents have other limits", **note)
        elif peak >= 0.25 * limit:
            for side in (-limit, limit):
                panel.axhline(side, color=grey(0.3), linestyle="--", linewidth=1, label=label if side > 0 else None)
        else:
            panel.set_title(f"{label}, out of view", **note)
    name_agents(figure, grid, run)
    return figure


def floor_of(run):
    """What is not drawn on a log axis, because it is less: a bound that is far below what bodies can keep, or, of agents
    far from the origin, what rounding makes of their positions."""
    return max(FLOOR, ROUNDING * np.abs(run.position).max())


def above(floor, values):
    """The values, and no number in place of those that are not above the floor: a curve ends there."""
    return np.where(values > floor, values, np.nan)


def floor_name(floor, unit):
    words = "floor" if floor <= FLOOR else "floor of rounding"
    return f"{words}: {floor:.0e} {unit}".replace("e-0", "e-")


def name_floor(axis, floor, *curves, unit="m"):
    """Draws the floor of a log axis, with its name, if one of the curves goes down to it."""
    if any(np.any(curve <= floor) for curve in curves):
        axis.axhline(floor, color=grey(0.3), linewidth=0.8, linestyle=(0, (1, 1)), label=floor_name(floor, unit))
        axis.set_ylim(bottom=0.6 * floor)


def log_panel(run, distance_m, what, ylabel):
    """Plots distances (T, N) over time on a log axis."""
    figure, axis = plt.subplots(figsize=(style.size().width, style.size().single))
    floor = floor_of(run)
    visible = [k for k in drawn(run) if np.any(distance_m[run.rows, k] > floor)]
    plot_agents(axis, run, run.t, above(floor, distance_m), visible)
    style.log_axis(axis)
    name_floor(axis, floor, distance_m[run.rows][:, drawn(run)])
    axis.set_ylabel(ylabel)
    time_axis(axis, run.begin_s, run.end_s)
    titled(figure, run, what)
    return figure, axis


def mark_time(axis, run, t_s, label):
    """Marks a time that was measured or predicted: unlike an event, by a bold line from a triangle, dash-dotted."""
    if t_s is not None and run.shows(t_s):
        axis.axvline(t_s, color=grey(0.2), linestyle="-.", linewidth=1.2, marker="^", markersize=6, markevery=[0],
                     clip_on=False, label=f"{label} {t_s:.2f} s")


def seen_from(run):
    """What the disagreement of each phase of a run is measured against."""
    leaders = [run.leader_of(span.law) for span in run.spans]
    return ["the mean" if leader is None else f"agent {run.id[leader]}" for leader in leaders]


def in_a_word(names):
    """What all disagreement of one picture is measured against."""
    return names[0] if len(set(names)) == 1 else "the mean or the leader"


def departs(run, span, leader, start_m):
    """Whether the leader of a phase leaves its place by much of the disagreement at the start, `start_m`: that is then no
    measure of how far the agents have come."""
    p = run.position[span.rows, leader][:, run.axes]
    return np.linalg.norm(p - p[0], axis=1).max() > DEPARTURE * start_m


def disagreement_figure(run):
    distance_m = disagreement(run)
    leaders = [run.leader_of(span.law) for span in run.spans]
    names = seen_from(run)
    to = in_a_word(names)
    what = f"distance from its place, seen from {to}" if np.any(run.places) else f"distance to {to}"
    shown_m = distance_m.copy()
    for span, leader in zip(run.spans, leaders):
        if leader is not None:
            shown_m[span.rows, leader] = np.nan
    figure, axis = log_panel(run, shown_m, f"disagreement ({what})", f"{what} (m)")
    mark_changes([axis], run, [f"{change}, to {name}" for change, name in zip(run.names_of_spans, names)]
                 if len(set(names)) > 1 else None)
    largest_m = largest(run, distance_m)
    axis.plot(run.t[run.rows], above(floor_of(run), largest_m)[run.rows], color=grey(0.1), linewidth=3, alpha=0.25, zorder=1,
              label="largest")
    label = "2 % of the start"
    for span, leader in zip(run.spans, leaders):
        t, start_m = run.t[span.rows], largest_m[span.rows][0]
        t = t[(t >= run.begin_s) & (t <= run.end_s)]
        if not t.size or leader is not None and departs(run, span, leader, start_m):
            continue
        axis.hlines(0.02 * start_m, t[0], t[-1], color=grey(0.3), linestyle="--", linewidth=1, label=label).told = \
            style.word("2 % of the start")
        label = None
        settled_s = (span.summary.get("consensus") or {}).get("settling_time_s")
        if settled_s is not None and "disagreement" in span.drawing["pictures"]:
            mark_time(axis, run, span.at_s + settled_s, "settled at")
    name_agents(figure, [axis], run)
    return figure


PREDICTED = {"equal": "predicted", "within": "predicted", "at_most": "predicted: at most", "at_least": "predicted: at least"}
UNIT_AT_END = re.compile(r"_(m2?|s|deg|rad|(m|rad)_per_s)$")


def without_unit(figure):
    """The name of a figure in words: "least gap" of least_gap_m."""
    return UNIT_AT_END.sub("", figure).replace("_", " ")


def curve_floor(told, runs, values):
    """The floor of a curve on a log axis; -inf if its axis is linear, because it does not decay or is not above the floor."""
    floor = max(map(floor_of, runs)) if told["unit"] == "m" else FLOOR
    return floor if told["decays"] and np.any(values > floor) else -np.inf


def curve_label(told):
    unit = told["unit"].replace("^2", "²")
    return f"{told['name']} ({unit})" if unit else told["name"]


def curve(run):
    """The law's own curve: what tells, tick by tick, how it fares."""
    told, t, values = curve_of_last_law(run)
    figure, axis = plt.subplots(figsize=(style.size().width, style.size().single))
    seen = (t >= run.begin_s - 1e-9) & (t <= run.end_s + 1e-9)
    unit = told["unit"].replace("^2", "²")
    floor = curve_floor(told, [run], values[seen])
    axis.plot(t[seen], above(floor, values)[seen], color=style.fills(1)[0], zorder=2.5, label=told["name"])
    if floor > 0:
        style.log_axis(axis)
        name_floor(axis, floor, values[seen], unit=unit)
    for begin, end, value, bound in predictions_in_window(run, told):
        axis.hlines(value, begin, end, color=grey(0.3), linestyle=DASHED, linewidth=1,
                    label=f"{without_unit(told['figure'])}, {PREDICTED[bound]} {value:.4g} {unit}".rstrip())
    axis.set_ylabel(curve_label(told))
    time_axis(axis, run.begin_s, run.end_s)
    mark_changes([axis], run)
    titled(figure, run, f"{told['name']} ({told['meaning']})")
    name_agents(figure, [axis], run, most=np.inf)
    return figure


def predictions_in_window(run, told):
    """(begin, end, value, bound) of what theory predicts of the curve, phase by phase."""
    ends = [*(span.at_s for span in run.spans[1:]), run.t[-1]]
    for span, end in zip(run.spans, ends):
        begin, end = max(span.at_s, run.begin_s), min(end, run.end_s)
        if span.drawing["curve"] == told and begin < end and (predicted := predicted_of_curve(run, span)):
            yield begin, end, *predicted


def error(run):
    targets = np.stack([waypoint_targets(run, agent) for agent in range(run.size)], axis=1)
    distance_m = np.linalg.norm((targets - run.position)[:, :, run.axes], axis=2)
    figure, axis = log_panel(run, distance_m, "error (distance to the current waypoint)", "distance (m)")
    mark_changes([axis], run)
    if not run.law.get("times_s"):
        radius_m = run.law.get("arrival_radius_m", 0.2)
        axis.axhline(radius_m, color=grey(0.3), linestyle="--", linewidth=1, label=f"arrival radius {radius_m:g} m")
    name_agents(figure, [axis], run)
    return figure


def tracking(run):
    """Position and speed of every agent relative to its parent in the tree: z and w of the min-max law."""
    tree = dict(spanning_tree(run))
    parent = np.array([tree.get(k, k) for k in range(run.size)])
    size, across = style.size(), 1 if style.size().is_narrow else len(run.axes)
    down = 2 * len(run.axes) // across
    wide = size.width * (1 if size.is_paper else across / 1.6)
    high = 0.6 + (size.panel + 0.4) * down
    figure, grid = plt.subplots(down, across, sharex=True, figsize=(wide, high), squeeze=False)
    grid = grid.reshape(2, -1) if across > 1 else grid.reshape(-1, 2).T
    rows = [(run.position, "{} relative to parent (m)"), (run.velocity, "$v_{}$ relative to parent (m/s)")]
    bound_s = ((run.summary.get("consensus") or {}).get("predicted") or {}).get("minmax_time_s")
    for row, (values, label) in zip(grid, rows):
        relative = values - values[:, parent]
        for panel, k in zip(row, run.axes):
            plot_agents(panel, run, run.t, relative[:, :, k], [c for c in drawn(run) if c in tree])
            panel.set_ylabel(label.format(AXIS_NAMES[k]))
            mark_time(panel, run, bound_s, "predicted")
            time_axis(panel, run.begin_s, run.end_s)
            if across > 1 and panel not in grid[-1] or across == 1 and panel is not grid[-1, -1]:
                panel.set_xlabel("")
    mark_changes(list(grid.flat), run)
    figure.align_ylabels()
    titled(figure, run, "tracking of the parent in the spanning tree")
    name_agents(figure, list(grid.flat), run)
    return figure


def span_text(spans, run, repeats):
    """Words for the times at which a graph works; `spans` are pairs (begin, end)."""
    if len(spans) == 1 and spans[0] == (run.begin_s, run.end_s):
        return "at any time"
    if repeats:
        repeat_s = run.config["graph"]["repeat_s"]
        first = [(begin, min(end, begin + repeat_s)) for begin, end in spans if begin < repeat_s - 1e-9]
        return ", ".join(f"{begin:g} to {end:g} s" for begin, end in first) + f"\nof each {repeat_s:g} s"
    text = ", ".join(f"{begin:g} to {end:g} s" for begin, end in spans[:3])
    return text + (f"\nand {len(spans) - 3} times more" if len(spans) > 3 else "")


def graph(run):
    """Who hears whom: a panel for each distinct graph, with the times at which it works."""
    spans = {}
    for begin, end, edges in run.graphs:
        if end >= run.begin_s and begin <= run.end_s and (end > run.begin_s or len(run.graphs) == 1):
            spans.setdefault(edges, []).append((max(begin, run.begin_s), min(end, run.end_s)))
    by_event = any({"cut", "mend", "graph"} & event.keys() for event in run.config.get("events", []))
    is_whole = run.begin_s == run.t[0] and run.end_s == run.t[-1]
    can_repeat = bool(run.config.get("graph", {}).get("repeat_s")) and is_whole and not by_event
    repeats = can_repeat and len(run.graphs) > len(spans)
    shown = list(spans)[:GRAPHS_MAX]
    range_m = run.config.get("graph", {}).get("range_m")
    letter = plt.rcParams["legend.fontsize"]
    near = f"\nwithin {range_m:g} m" if range_m else ""
    size = style.size()
    across = min(len(shown), 2 if size.is_narrow else 3 if len(shown) < 4 else 4)
    down = -(-len(shown) // across)
    side = min(0.7 * size.square, size.width / across)
    figure, grid = plt.subplots(down, across, figsize=(size.width, 0.2 + down * side), squeeze=False)
    angle = np.pi / 2 - 2 * np.pi * np.arange(run.size) / run.size
    at = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    for axis in grid.flat:
        axis.set_axis_off()
    for axis, edges in zip(grid.flat, shown):
        tell_edges(edge_artists(axis, at, in_order(edges))[0], run, edges, f" {span_text(spans[edges], run, repeats)}")
        name_edges(axis, edges)
        draw_nodes(axis, run, at, side)
        axis.set_title(span_text(spans[edges], run, repeats) + near, loc="center", fontsize=letter)
        axis.set(xlim=(-1.25, 1.25), ylim=(-1.25, 1.25))
        axis.update_datalim([(-1.25, -1.25), (1.25, 1.25)])  # what must stay in sight, circles included
        axis.set_aspect("equal", adjustable="datalim")
    some = f" ({len(shown)} of {len(spans)} graphs)" if len(shown) < len(spans) else ""
    titled(figure, run, f"who hears whom{some}")
    found = dict(pair[::-1] for axis in grid.flat for pair in zip(*axis.get_legend_handles_labels()))
    style.add_legend(figure, list(found.values()), list(found), is_below=True)
    return figure


def draw_nodes(axis, run, at, side):
    """Draws agents as circles with their numbers, or as dots if they are too many for numbers."""
    letter = style.size().small_pt
    room_pt = 72 * side * 0.8 / 2.5 * (2 * np.sin(np.pi / max(run.size, 3)))  # from one circle to the next
    numbered = room_pt > 1.9 * letter
    mark = min(2.4 * letter, 0.85 * room_pt) if numbered else max(2, min(letter, 0.6 * room_pt))
    for k, colour in enumerate(colours(run)):
        axis.plot(*at[k], "o", markersize=mark, markerfacecolor=grey(1) if numbered else colour, markeredgecolor=colour,
                  markeredgewidth=2 if k in run.leads else 1, zorder=3)
        if numbered:
            axis.annotate(str(run.id[k]), at[k], ha="center", va="center_baseline", fontsize=letter, zorder=4)


def stretches(is_so):
    """(begin, end) indices of each stretch of True in (T)."""
    edge = np.flatnonzero(np.diff(np.concatenate([[False], is_so, [False]]).astype(int)))
    return list(zip(edge[::2], edge[1::2]))


def safety(run):
    """The smallest distance between agents, and when law.safety changed commands, agent by agent."""
    size = style.size()
    figure, (near, when) = plt.subplots(2, 1, sharex=True, figsize=(size.width, 0.5 + 2.2 * size.panel))
    near.plot(run.t[run.rows], separation(run)[run.rows], color=style.Chosen.colours[0], label="smallest distance")
    for at_m in sorted({span.law["safety"]["distance_m"] for span in run.spans if "safety" in span.law}):
        near.axhline(at_m, color=grey(0.3), linestyle="--", linewidth=1, label=f"to be kept: {at_m:g} m")
    near.set_ylabel("distance (m)")
    near.set_ylim(bottom=0)
    tick_s = run.t[1] - run.t[0] if run.t.size > 1 else 1
    for bit, colour, label, order in ((FILTERED, OKABE_ITO[5], "changed by law.safety", 2),
                                      (INFEASIBLE, OKABE_ITO[1], "no safe command", 3)):
        flags, t = run.flags[run.rows] & bit, run.t[run.rows]
        if not np.any(flags):
            continue
        for k in run.shown:
            bars = [(t[begin], t[end - 1] - t[begin] + tick_s) for begin, end in stretches(flags[:, k] != 0)]
            boxes = when.broken_barh(bars, (run.id[k] - 0.4, 0.8), facecolor=colour, edgecolor=colour, linewidth=0.4,
                                     zorder=order)
            name = f"{style.word(agent_label(run, k))}, {style.word(label)}"
            begins, ends = [at for at, _ in bars], [sum(bar) for bar in bars]
            boxes.told = {f"{name}: from (s)": begins, f"{name}: until (s)": ends} if bars else {}
        when.bar(0, 0, color=colour, label=label)
    when.set(ylabel="agent", ylim=(run.size + 0.6, 0.4))
    when.yaxis.set_major_locator(matplotlib.ticker.MaxNLocator(8 if size.is_paper else 12, integer=True, min_n_ticks=1))
    time_axis(when, run.begin_s, run.end_s)
    mark_changes([near, when], run)
    figure.align_ylabels()
    titled(figure, run, "distance kept, and commands that law.safety changed")
    handles, labels = map(sum, zip(near.get_legend_handles_labels(), when.get_legend_handles_labels()), ([], []))
    style.add_legend(figure, handles, labels, is_below=True)
    return figure


def incidents(run):
    """When which agent came up against what: a row for each kind, in it a lane for each agent."""
    size = style.size()
    kinds = list(dict.fromkeys(incident.what for incident in run.incidents))
    figure, axis = plt.subplots(figsize=(size.width, 0.6 + 0.5 * len(kinds)))
    tick_s = run.t[1] - run.t[0] if run.t.size > 1 else 1
    lane = 0.8 / run.size
    palette, boxes, moments, rows = style.fills(run.size), [], [], []
    for incident in (one for one in run.incidents if one.until_s >= run.begin_s and one.t_s <= run.end_s):
        begin, end = incident.t_s, incident.until_s + tick_s
        for k in (k for k in incident.indices if k in run.shown):
            rows.append((incident.what, int(run.id[k]), begin, end))
            low = kinds.index(incident.what) - 0.4 + lane * k
            boxes.append((k, [(begin, low), (end, low), (end, low + lane), (begin, low + lane)]))
            if end - begin < 0.01 * run.t[-1]:  # a box would hardly be seen
                moments.append((k, [(begin, low), (begin, low + lane)]))
    lanes = axis.add_collection(PolyCollection([box for _, box in boxes], facecolors=[palette[k] for k, _ in boxes]))
    lanes.told = dict(zip(("what", "agent", "from (s)", "until (s)"), zip(*rows)))
    axis.add_collection(LineCollection([line for _, line in moments], colors=[palette[k] for k, _ in moments]))
    for k in sorted({k for k, _ in boxes}):
        axis.plot([], [], "s", color=palette[k], label=agent_label(run, k))
    axis.set_yticks(range(len(kinds)), [style.word(kind.replace("_", " ")) for kind in kinds])
    axis.set_ylim(len(kinds) - 0.4, -0.6)
    time_axis(axis, run.begin_s, run.end_s)
    mark_changes([axis], run)
    titled(figure, run, "what the run came up against")
    name_agents(figure, [axis], run, most=len(style.Chosen.colours))
    return figure


# --- which figures a run gets ---------------------------------------------------------------------------


@dataclass(frozen=True)
class Picture:
    draw: object
    switch: str  # the key of [output] that turns it off
    applies: object  # run -> None, or why the picture does not apply to it


def only_if(condition, reason):
    return lambda run: None if condition(run) else reason


def usual(run):
    """Names of the pictures that a run gets, what tells most of its law first: of those that apply, all but paths along one
    line where the law has a curve of its own and nothing but agents is to be seen from above."""
    names = [name for name, picture in PICTURES.items() if not picture.applies(run)]
    telling = run.drawing["telling"]
    if telling != "paths" and "curve" in names and is_on_a_line(run) and not run.obstacles:
        names.remove("paths")
    return sorted(names, key=lambda name: name != telling)


ALWAYS = only_if(lambda run: True, "")
PICTURES = {
    "paths": Picture(paths, "position_plot", ALWAYS),
    "curve": Picture(curve, "position_plot", only_if(
        lambda run: curve_of_last_law(run) is not None,
        "it needs a law with a curve of its own, and the run's law_curve.csv")),
    "position": Picture(position, "position_plot", ALWAYS),
    "velocity": Picture(velocity, "velocity_plot", ALWAYS),
    "disagreement": Picture(disagreement_figure, "position_plot", only_if(
        lambda run: run.size > 1 and any("disagreement" in span.drawing["pictures"] for span in run.spans),
        "it needs several agents and a law of agreement")),
    "acceleration": Picture(acceleration, "velocity_plot", ALWAYS),
    "tracking": Picture(tracking, "position_plot", only_if(
        lambda run: "tracking" in run.drawing["pictures"] and run.edges and not run.phases,
        "it needs a law of pursuit, from start to end, and the graph in summary.json")),
    "error": Picture(error, "position_plot", only_if(
        lambda run: "error" in run.drawing["pictures"] and not run.phases,
        "it needs a law that flies to waypoints, from start to end")),
    "graph": Picture(graph, "position_plot", only_if(
        lambda run: run.size > 1 and run.edges, "it needs several agents, and the graph in summary.json")),
    "safety": Picture(safety, "position_plot", only_if(
        lambda run: run.size > 1 and np.any(run.flags & (FILTERED | INFEASIBLE)),
        "it needs a law.safety that changed some command")),
    "incidents": Picture(incidents, "position_plot", only_if(
        lambda run: any(incident.until_s > 1 for incident in run.incidents),
        "it needs an events.csv in which something happened after the first second")),
}

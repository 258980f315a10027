#!/usr/bin/python3 -Es
"""Draws a search: plot_tuning.py TABLE.csv PICTURE.png COLUMN KEY... [OPTION...]

The first panel has COLUMN of each candidate in the order in which they were proposed, and the best so far; further panels
have COLUMN over each of the first keys, later candidates darker. A candidate without a value, because a run failed or has
none, is marked at the edge. Exit codes: 0 done, 1 nothing to draw, 2 wrong use.
"""

import argparse
import sys

sys.dont_write_bytecode = True  # the folder of the scripts may be read-only
import own_matplotlib  # noqa: F401: the first of all that draw
import figure_style
import matplotlib
import matplotlib.pyplot as plt
import matplotlib.ticker
import numpy as np
import plain
from figure_style import OKABE_ITO, size
from plot_sweep import FAILED, draw_files, is_wide, number, rows_of

KEYS_MAX = 5  # panels of keys
EDGE = 0.02  # where candidates without a value are marked, as a part of the panel's height


class Search:
    """The candidates of a table, each with its values and the one number by which it is judged, NaN for none."""

    def __init__(self, options):
        self.column, self.keys = options.column, options.keys
        self.log_keys, self.maximize = options.log, options.maximize
        self.labels = dict(text.split("=", 1) for text in options.label)
        runs = list(rows_of(options.table, {*self.keys, self.column, "error"}))
        groups = {}
        for run in runs:
            value = None if run["error"] else number(run[self.column])
            groups.setdefault(tuple(run[key] for key in self.keys), []).append(np.nan if value is None else value)
        self.candidates = list(groups)
        self.values = np.array([self.judged(group, options.over_seeds) for group in groups.values()])
        self.runs = len(runs)

    def judged(self, values, how):
        worst = -np.inf if self.maximize else np.inf
        values = np.where(np.isnan(values), worst, values)
        if how == "worst":
            value = min(values) if self.maximize else max(values)
        else:
            with np.errstate(invalid="ignore"):
                value = np.median(values) if how == "median" else np.mean(values)
        return value if np.isfinite(value) else np.nan

    def best_so_far(self):
        worst = -np.inf if self.maximize else np.inf
        filled = np.where(np.isnan(self.values), worst, self.values)
        best = (np.maximum if self.maximize else np.minimum).accumulate(filled)
        return np.where(np.isfinite(best), best, np.nan)

    def label(self, name):
        return self.labels.get(name, name)

    def places_of(self, k):
        """Where the candidates stand on the axis of a key, and names of the places if they are words."""
        cells = [candidate[k] for candidate in self.candidates]
        numbers = [number(cell) for cell in cells]
        if all(value is not None for value in numbers):
            return np.array(numbers), None
        words = list(dict.fromkeys(cells))
        return np.array([words.index(cell) for cell in cells]), words

    def missing(self):
        return np.isnan(self.values)


def mark_missing(axis, places):
    if places.size:
        axis.plot(places, np.full(places.shape, EDGE), FAILED, color=figure_style.grey(0.3), markersize=4,
                  transform=axis.get_xaxis_transform(), clip_on=False)


def draw_course(search, axis):
    order = np.arange(search.values.size)
    axis.plot(order, search.values, "o", color=OKABE_ITO[0], markersize=3, label="candidate")
    axis.step(order, search.best_so_far(), where="post", color=OKABE_ITO[1], label="best so far")
    mark_missing(axis, order[search.missing()])
    axis.set_xlabel("candidate")
    axis.xaxis.set_major_locator(matplotlib.ticker.MaxNLocator(integer=True))
    axis.legend()


def draw_key(search, k, axis):
    places, words = search.places_of(k)
    axis.scatter(places, search.values, c=np.arange(places.size), cmap="Blues", vmin=-places.size / 2, s=12,
                 edgecolors=figure_style.grey(0.3), linewidths=0.3)
    mark_missing(axis, places[search.missing()])
    best = np.nanargmax(search.values) if search.maximize else np.nanargmin(search.values)
    axis.plot(places[best], search.values[best], "o", markersize=7, color=OKABE_ITO[1], markerfacecolor="none")
    axis.set_xlabel(search.label(search.keys[k]))
    if words is not None:
        axis.set_xticks(range(len(words)), [word.strip("\"'") for word in words])
    elif search.keys[k] in search.log_keys:
        axis.set_xscale("log")
        axis.xaxis.set_minor_formatter(figure_style.few_decades())


def draw(search):
    shown = min(len(search.keys), KEYS_MAX)
    columns = 1 if size().is_narrow else min(3, 1 + shown)
    rows = -(-(1 + shown) // columns)
    figure, axes = plt.subplots(rows, columns, squeeze=False, sharey=True, layout="constrained",
                                figsize=(size().width, rows * max(2.3, size().single * 0.7)))
    panels = axes.flat
    draw_course(search, panels[0])
    for k in range(shown):
        draw_key(search, k, panels[1 + k])
    for axis in panels[1 + shown:]:
        axis.remove()
    for row in axes:
        row[0].set_ylabel(search.label(search.column))
    if is_wide(search.values):
        figure_style.log_axis(panels[0])
    missing = np.count_nonzero(search.missing())
    figure_style.title(figure, f"{search.values.size} candidates, {search.runs} runs"
                       + (f", {missing} candidates without a value ({FAILED})" if missing else ""))
    figure_style.wrap_labels(figure)
    return figure


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("table")
    parser.add_argument("picture")
    parser.add_argument("column")
    parser.add_argument("keys", nargs="+", metavar="KEY")
    parser.add_argument("--label", action="append", default=[], metavar="NAME=TEXT", help="what a column or key is called")
    parser.add_argument("--log", action="append", default=[], metavar="KEY", help="has a log axis")
    parser.add_argument("--over-seeds", choices=("mean", "median", "worst"), default="mean")
    parser.add_argument("--maximize", action="store_true")
    parser.add_argument("--size", choices=figure_style.SIZES, default="screen")
    parser.add_argument("--format", default="png", metavar="LIST", help="png, pdf, svg, with commas between")
    options = parser.parse_intermixed_args()
    return draw_files(options, Search, draw, lambda search: not search.missing().all(), "candidate")


if __name__ == "__main__":
    plain.fit_streams()
    sys.exit(main())

#!/usr/bin/python3
"""Draws the table of a sweep: plot_sweep.py TABLE.csv PICTURE.png COLUMN [KEY [KEY]].

Without a key: a histogram of COLUMN. With one key: COLUMN over it, as the median over all seeds and the band between
first and ninth decile. With two keys: a heat map of medians, or coloured points if the keys were drawn at random. Runs
that failed or have no value of COLUMN are left out, and counted in the title. Exit codes: 0 done, 1 nothing
to draw, 2 wrong use.
"""

import argparse
import csv
import os
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import matplotlib.ticker
import numpy as np

sys.dont_write_bytecode = True  # the folder of the scripts may be read-only
from figure_style import OKABE_ITO, STYLE

BLUE = OKABE_ITO[0]
TICKS_MAX = 12
BINS_MAX = 50
DECADES = 2  # values that span at least this many decades get a log scale


def number(text):
    """A cell as a number; None if it is not a number."""
    if text in ("true", "false"):
        return float(text == "true")
    try:
        return float(text)
    except ValueError:
        return None


def read(path, column, keys):
    """The cells of the keys and the number in the column, for all runs that have one; and how many runs have none."""
    with open(path, newline="", encoding="utf-8") as file:
        table = list(csv.DictReader(file))
    rows = [([row[key] for key in keys], number(row[column])) for row in table]
    good = [(cells, value) for cells, value in rows if value is not None]
    return good, len(rows) - len(good)


def is_wide(values):
    positive = [v for v in values if v > 0]
    return len(positive) == len(values) and max(positive) / min(positive) >= 10**DECADES


class Axis:
    """Positions of the values of one key: numbers at their value, words side by side in order of appearance."""

    def __init__(self, key, cells):
        self.key = key
        numbers = [number(cell) for cell in cells]
        self.is_numeric = all(n is not None for n in numbers)
        self.labels = sorted(set(cells), key=number) if self.is_numeric else list(dict.fromkeys(cells))
        self.is_grid = False  # a heat map with cells around each place, and a tick at each
        self.places = [number(label) for label in self.labels] if self.is_numeric else list(range(len(self.labels)))
        self.is_log = self.is_numeric and is_wide(self.places)

    def of(self, cell):
        return self.places[self.labels.index(cell)]

    def edges(self):
        """Edges of the cells around the places, half-way between them."""
        places = np.log(self.places) if self.is_log else np.array(self.places, float)
        between = (places[1:] + places[:-1]) / 2
        first, last = (2 * places[0] - between[0], 2 * places[-1] - between[-1]) if between.size else places[0] + [-0.5, 0.5]
        edges = np.array([first, *between, last])
        return np.exp(edges) if self.is_log else edges

    def label(self, axis):
        axis.set_label_text(self.key)
        if self.is_log:
            getattr(axis.axes, f"set_{axis.axis_name}scale")("log")
            if self.is_grid:
                axis.set_minor_locator(matplotlib.ticker.NullLocator())
        if not self.is_numeric or self.is_grid and len(self.labels) <= TICKS_MAX:
            axis.set_ticks(self.places, self.labels)


def by_cells(rows):
    groups = {}
    for cells, value in rows:
        groups.setdefault(tuple(cells), []).append(value)
    return groups


def draw_histogram(ax, rows, column):
    values = np.array([value for _, value in rows])
    bins = min(BINS_MAX, 1 + int(np.sqrt(values.size)))
    if is_wide(values):
        bins = np.geomspace(values.min(), values.max(), bins + 1)
        ax.set_xscale("log")
    ax.hist(values, bins=bins, color=BLUE, edgecolor="white", linewidth=0.5)
    ax.set_xlabel(column)
    ax.set_ylabel("runs")
    ax.yaxis.set_major_locator(matplotlib.ticker.MaxNLocator(integer=True))


def draw_curve(ax, rows, column, key):
    axis = Axis(key, [cells[0] for cells, _ in rows])
    groups = by_cells(rows)
    labels = [label for label in axis.labels if (label,) in groups]
    x = [axis.of(label) for label in labels]
    median, low, high = ([np.quantile(groups[(label,)], q) for label in labels] for q in (0.5, 0.1, 0.9))
    if any(len(values) > 1 for values in groups.values()):
        if axis.is_numeric:
            ax.fill_between(x, low, high, color=BLUE, alpha=0.2, linewidth=0, label="first to ninth decile")
        else:
            ax.vlines(x, low, high, color=BLUE, alpha=0.4, linewidth=3, label="first to ninth decile")
    ax.plot(x, median, "o-" if axis.is_numeric else "o", color=BLUE, markersize=3, label="median")
    if is_wide(median):
        ax.set_yscale("log")
    axis.label(ax.xaxis)
    ax.set_ylabel(column)
    ax.legend()


def draw_map(figure, ax, rows, column, keys):
    axes = [Axis(key, [cells[k] for cells, _ in rows]) for k, key in enumerate(keys)]
    groups = by_cells(rows)
    points = [(axes[0].of(a), axes[1].of(b), np.median(values)) for (a, b), values in groups.items()]
    x, y, z = (np.array(part) for part in zip(*points))
    norm = matplotlib.colors.LogNorm() if is_wide(list(z)) else None
    if 2 * len(groups) > len(axes[0].labels) * len(axes[1].labels):  # a grid, perhaps with gaps
        grid = np.full((len(axes[1].labels), len(axes[0].labels)), np.nan)
        for a, b, value in points:
            grid[axes[1].places.index(b), axes[0].places.index(a)] = value
        ax.grid(False)
        axes[0].is_grid = axes[1].is_grid = True
        drawn = ax.pcolormesh(axes[0].edges(), axes[1].edges(), grid, cmap="viridis", norm=norm)
    else:
        drawn = ax.scatter(x, y, c=z, cmap="viridis", s=12, norm=norm)
    axes[0].label(ax.xaxis)
    axes[1].label(ax.yaxis)
    figure.colorbar(drawn, ax=ax, label=column)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("table")
    parser.add_argument("picture")
    parser.add_argument("column")
    parser.add_argument("keys", nargs="*", metavar="KEY")
    options = parser.parse_args()
    if len(options.keys) > 2:
        parser.error("expected at most two keys")
    rows, missing = read(options.table, options.column, options.keys)
    if not rows:
        print(f"error: {options.table}: no run has a {options.column}", file=sys.stderr)
        return 1
    plt.rcParams.update(STYLE)
    figure, ax = plt.subplots(figsize=(6.4, 4.2))
    if not options.keys:
        draw_histogram(ax, rows, options.column)
    elif len(options.keys) == 1:
        draw_curve(ax, rows, options.column, options.keys[0])
    else:
        draw_map(figure, ax, rows, options.column, options.keys)
    ax.set_title(f"{len(rows)} runs" + (f", {missing} without a value" if missing else ""))
    part = options.picture + ".part.png"
    figure.savefig(part, metadata={"Software": None})
    os.replace(part, options.picture)
    return 0


if __name__ == "__main__":
    sys.exit(main())

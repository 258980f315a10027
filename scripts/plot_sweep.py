#!/usr/bin/python3 -Es
"""Draws the table of a sweep: plot_sweep.py TABLE.csv STATISTICS.csv PICTURE.png COLUMN [KEY [KEY]] [OPTION...]

Without a key: a histogram of COLUMN. With one key: COLUMN over it, as the mean over all seeds with its 95 % confidence
band, and as the median with first and ninth decile, both from STATISTICS. A second key of words (laws, topologies)
gives a colour to each; two keys of numbers give a heat map of medians, or coloured points if they were drawn at random.
Runs that failed (crosses) or have no value of COLUMN (triangles, at the end of the run for times) are marked, and a
panel shows which part of the runs has a value. Exit codes: 0 done, 1 nothing to draw, 2 wrong use.
"""

import argparse
import csv
import pathlib
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
from regular_file import open_regular

BLUE = OKABE_ITO[0]
FAILED, MISSING = "x", "^"  # markers
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


class TableError(Exception):
    """What is wrong with a table, and where."""


csv.field_size_limit(2**31 - 1)  # a cell may hold a whole law


def rows_of(path, columns=None, having=""):
    """The cells of these columns (of all, without them), row by row, of the lines that have this text in them."""
    with open_regular(path, newline="", encoding="utf-8") as file:
        names = next(csv.reader([file.readline()]), [])
        for name in columns or ():
            if names.count(name) != 1:
                raise TableError(f"{path}:1: expected the column {name} once, got it {names.count(name)} times")
        kept = [k for k, name in enumerate(names) if columns is None or name in columns]
        for number, line in enumerate(file, 2):  # a row is a line: sweep writes no others
            if having not in line:
                continue
            cells = next(csv.reader([line]), [])
            if len(cells) != len(names):
                raise TableError(f"{path}:{number}: expected {len(names)} cells, got {len(cells)}")
            yield {names[k]: cells[k] for k in kept}


def is_wide(values):
    finite = [v for v in values if v is not None and np.isfinite(v)]
    return bool(finite) and min(finite) > 0 and max(finite) / min(finite) >= 10**DECADES


def unevenness(places):
    """How far sorted places are from being evenly spaced, as a part of their range."""
    return np.abs((places - places[0]) / (places[-1] - places[0]) - np.linspace(0, 1, places.size)).max()


def is_log_spaced(values):
    """Whether positive values are spaced by factors and not by differences: 1, 2, 4, 8, or drawn evenly from a log range."""
    places = np.unique([v for v in values if v is not None and np.isfinite(v)])
    return places.size > 2 and places[0] > 0 and 2 * unevenness(np.log(places)) < unevenness(places)


class Table:
    """The rows of the sweep, and of its statistics of one column."""

    def __init__(self, options):
        self.column, self.keys = options.column, options.keys
        self.runs = list(rows_of(options.table, {*self.keys, self.column, "error", "sim_s"}))
        points = rows_of(options.statistics, having=f"{self.column},")
        self.points = [row for row in points if row["metric"] == self.column]
        self.labels = dict(text.split("=", 1) for text in options.label)
        self.failed = [row for row in self.runs if row["error"]]
        # Figures of a law are missing in the runs of another law, and not only there.
        own = {tuple(row[key] for key in self.keys) for row in self.points}
        self.late = [
            row for row in self.runs
            if not row["error"] and number(row[self.column]) is None and tuple(row[key] for key in self.keys) in own
        ]
        self.good = [row for row in self.runs if number(row[self.column]) is not None]
        self.is_time = options.time

    def label(self, name):
        return self.labels.get(name, name)

    def has_value(self):
        """What it means for a run to have a value of the column."""
        if not self.is_time:
            return "with a value"
        return "settled" if self.column.endswith("settling_time_s") else "in time"

    def values(self):
        return [number(row[self.column]) for row in self.good]

    def end_s(self):
        """Where runs without a time are marked: at the end of the longest."""
        return max(number(row["sim_s"]) or 0 for row in self.late)

    def title(self):
        text = f"{len(self.runs)} runs"
        if self.failed:
            text += f", {len(self.failed)} failed ({FAILED})"
        if self.late:
            text += f", {len(self.late)} " + ("not " + self.has_value() if self.is_time else "without a value") + " (\u25b3)"
        return text


class Axis:
    """Positions of the values of one key: numbers at their value, words side by side in order of appearance."""

    def __init__(self, table, key):
        self.key, self.text = key, table.label(key)
        cells = [row[key] for row in table.runs]
        numbers = [number(cell) for cell in cells]
        self.is_numeric = all(n is not None for n in numbers)
        self.cells = sorted(set(cells), key=lambda cell: (number(cell), cell)) if self.is_numeric else list(dict.fromkeys(cells))
        self.is_grid = False  # a heat map with cells around each place, and a tick at each
        self.places = [number(cell) for cell in self.cells] if self.is_numeric else list(range(len(self.cells)))
        self.is_log = self.is_numeric and (is_wide(self.places) or is_log_spaced(self.places))
        self.place_of = dict(zip(self.cells, self.places))

    def of(self, cell):
        return self.place_of[cell]

    def rank(self):
        """The number of each place; the first one of places that are equal."""
        return {place: n for n, place in reversed(list(enumerate(self.places)))}

    def edges(self):
        """Edges of the cells around the places, half-way between them."""
        places = np.log(self.places) if self.is_log else np.array(self.places, float)
        between = (places[1:] + places[:-1]) / 2
        first, last = (2 * places[0] - between[0], 2 * places[-1] - between[-1]) if between.size else places[0] + [-0.5, 0.5]
        edges = np.array([first, *between, last])
        return np.exp(edges) if self.is_log else edges

    def has_tick_each(self):
        """Whether each value has its own tick: words, and few numbers in cells or on an axis that is otherwise hard to read."""
        is_hard_to_read = self.is_log and not is_wide(self.places)
        return not self.is_numeric or len(self.cells) <= TICKS_MAX and (self.is_grid or is_hard_to_read)

    def dress(self, axis):
        axis.set_label_text(self.text)
        if self.is_log:
            getattr(axis.axes, f"set_{axis.axis_name}scale")("log")
            axis.set_minor_formatter(figure_style.few_decades())
            if self.has_tick_each():
                axis.set_minor_locator(matplotlib.ticker.NullLocator())
        if self.has_tick_each():
            axis.set_ticks(self.places, [cell.strip("\"'") for cell in self.cells])


def draw_histogram(table):
    figure, ax = plt.subplots(**figure_of(6.4, 4.2))
    values = np.array(table.values())
    bins = min(BINS_MAX, 1 + int(np.sqrt(values.size)))
    if is_wide(values):
        bins = np.geomspace(values.min(), values.max(), bins + 1)
        ax.set_xscale("log")
    ax.hist(values, bins=bins, color=OKABE_ITO[5], edgecolor="white", linewidth=0.5)
    row = {name: number(cell) for name, cell in table.points[0].items()}
    if row["mean_low_95"] is not None:
        ax.axvspan(row["mean_low_95"], row["mean_high_95"], color=OKABE_ITO[1], alpha=0.25, linewidth=0,
                   label="mean, 95 % confidence")
        ax.axvline(row["mean"], color=OKABE_ITO[1])
        if np.isfinite(row["median"]):
            ax.axvline(row["median"], color="black", linestyle="--", label="median")
    if table.late and table.is_time:
        ax.plot([table.end_s()], [0.03], MISSING, color="black", markerfacecolor="white", clip_on=False,
                transform=ax.get_xaxis_transform(), label=f"not {table.has_value()}: {len(table.late)}")
    if ax.get_legend_handles_labels()[0]:
        ax.legend()
    ax.set_xlabel(table.label(table.column))
    ax.set_ylabel("runs")
    ax.yaxis.set_major_locator(matplotlib.ticker.MaxNLocator(integer=True))
    return figure


class Curves:
    """COLUMN over one key; another key of words gives the colours."""

    def __init__(self, table, key, series):
        self.table, self.x = table, Axis(table, key)
        self.series_key = series
        self.series = Axis(table, series).cells if series else [None]
        self.looks = dict(zip(self.series, figure_style.looks(len(self.series))))
        values = table.values()
        self.is_log = is_wide([number(row["median"]) for row in table.points]) and is_wide(values)
        self.floor = min(values) / 2 if self.is_log else -np.inf
        self.has_sample = any(int(point["runs"]) > 1 for point in table.points)

    def is_of(self, row, cell):
        return self.series_key is None or row[self.series_key] == cell

    def points(self, cell):
        """The statistics of a series, by x."""
        return sorted((row for row in self.table.points if self.is_of(row, cell)), key=lambda row: self.x.of(row[self.x.key]))

    def nudged(self, row):
        """Where a point stands: words side by side are spread by series, so that they do not cover each other."""
        place = self.x.of(row[self.x.key])
        if self.x.is_numeric or len(self.series) < 2:
            return place
        return place + 0.5 * (self.series.index(row[self.series_key]) / (len(self.series) - 1) - 0.5)

    def band(self, ax, cell, middle, low, high, name):
        rows = self.points(cell)
        colour, line = self.looks[cell]
        x = [self.nudged(row) for row in rows]
        y, bottom, top = ([number(row[column]) for row in rows] for column in (middle, low, high))
        y, bottom, top = (np.array([np.nan if v is None else v for v in part]) for part in (y, bottom, top))
        if self.table.is_time and self.table.late:  # a band that goes on beyond the end of the runs
            top = np.where(np.isinf(top), self.table.end_s(), top)
        text = name if cell is None else cell.strip("\"'")
        shown = np.isfinite(bottom) & np.isfinite(top)
        bottom, top = np.maximum(bottom, self.floor), np.maximum(top, self.floor)  # a log axis has no place for 0 and below
        if self.x.is_numeric:
            ax.fill_between(x, bottom, top, where=shown, color=colour, alpha=0.2, linewidth=0)
        ax.vlines(np.array(x)[shown], bottom[shown], top[shown], color=colour, alpha=0.5, linewidth=1.5)
        y = np.where(np.isfinite(y), y, np.nan)
        ax.plot(x, y, "o", linestyle=line if self.x.is_numeric else "none", color=colour, markersize=3.5, label=text)

    def marks(self, ax):
        """The runs without a value, and those that failed."""
        for runs, marker, y, transform in (
            (self.table.failed, FAILED, 0.02, ax.get_xaxis_transform()),
            (self.table.late, MISSING, self.table.end_s() if self.table.late and self.table.is_time else 0.98,
             ax.transData if self.table.is_time else ax.get_xaxis_transform()),
        ):
            for n, cell in enumerate(self.series):
                places = sorted({self.nudged(row) for row in runs if self.is_of(row, cell)})
                if not places:
                    continue
                ax.plot(places, [y] * len(places), marker, color=self.looks[cell][0], markerfacecolor="none", markersize=5 + 2 * n,
                        transform=transform, clip_on=False, zorder=3)
        if self.table.late and self.table.is_time:
            ax.axhline(self.table.end_s(), color="0.5", linestyle=":", linewidth=0.8)

    def fractions(self, ax):
        for cell in self.series:
            rows = self.points(cell)
            part = [1 - (int(row["failed"]) + int(row["without_value"])) / int(row["runs"]) for row in rows]
            colour, line = self.looks[cell]
            ax.plot([self.nudged(row) for row in rows], part, "o", linestyle=line if self.x.is_numeric else "none",
                    color=colour, markersize=3)
        ax.set_ylim(-0.06, 1.06)
        ax.set_yticks([0, 0.5, 1], ["0", "50 %", "100 %"])
        ax.set_ylabel(self.table.has_value())

    def limit(self, ax):
        """Shows the values; the confidence band of a mean of two of them may be far wider, and is cut."""
        values = self.table.values() + ([self.table.end_s()] if self.table.late and self.table.is_time else [])
        margin = 0.3 * (max(values) - min(values))
        bottom, top = ax.get_ylim()
        if margin > 0:
            ax.set_ylim(max(bottom, min(values) - margin), min(top, max(values) + margin))

    def panels(self, kinds, with_fractions):
        """A figure with a panel for each kind, side by side, or in a narrow column one below the other, and below each,
        or below both, the fractions of runs."""
        if size().is_narrow:
            heights = [1.9] * kinds + [0.8] * with_fractions
            figure, panels = plt.subplots(len(heights), 1, figsize=(size().width, 0.6 + sum(heights)), sharex=True, squeeze=False,
                                          gridspec_kw={"height_ratios": heights})
            return figure, panels[:kinds, 0], panels[kinds:, 0]
        width = 1.8 + 4.2 * kinds
        scale = size().width / 10.2 if size().is_paper else 1
        figure, panels = plt.subplots(1 + with_fractions, kinds, figsize=(width * scale, (4 + 1.2 * with_fractions) * scale),
                                      sharex=True, sharey="row", squeeze=False,
                                      gridspec_kw={"height_ratios": [3.4, 1][:1 + with_fractions]})
        return figure, panels[0], panels[1] if with_fractions else []

    def draw(self):
        table = self.table
        kinds = [("mean", "mean_low_95", "mean_high_95", "mean, 95 % confidence"),
                 ("median", "decile_1", "decile_9", "median, first to ninth decile")] if self.has_sample else [
                     ("mean", "mean_low_95", "mean_high_95", "")]
        figure, panels, fractions = self.panels(len(kinds), bool(table.failed or table.late))
        for ax, (middle, low, high, name) in zip(panels, kinds):
            for cell in self.series:
                self.band(ax, cell, middle, low, high, name)
            self.marks(ax)
            ax.set_title(name + (", of the runs " + table.has_value() if middle == "mean" and table.late and name else ""))
        if self.is_log:
            for ax in panels:
                ax.set_yscale("log")
        else:
            for ax in panels:
                self.limit(ax)
        for ax in fractions:
            self.fractions(ax)
        stacked = size().is_narrow
        for row in (panels, fractions):
            for k, ax in enumerate(row):
                if row is panels and (stacked or k == 0):
                    ax.set_ylabel(table.label(table.column))
                elif k > 0:
                    ax.set_ylabel("")
        lowest = fractions if len(fractions) else panels
        for ax in lowest[-1:] if stacked else lowest:
            self.x.dress(ax.xaxis)
        figure.align_ylabels()
        if not size().is_paper:
            figure.suptitle(table.title(), x=0.01, ha="left", fontsize=9)
        if self.series_key:
            handles, labels = panels[0].get_legend_handles_labels()
            figure_style.add_legend(figure, handles, labels, is_below=True, heading=table.label(self.series_key))
        return figure


def figure_of(width, height):
    """A figure of this size in inches on a screen; for a paper, as wide as that asks for."""
    scale = min(size().width / width, 1) if size().is_paper else 1
    return {"figsize": (width * scale, height * scale)}


def draw_cells(figure, ax, table, z, label, **colours):
    """One colour for each point of two keys: cells of a grid, perhaps with gaps, or dots."""
    axes = [Axis(table, key) for key in table.keys]
    x, y = ([axis.of(row[axis.key]) for row in table.points] for axis in axes)
    if 2 * len(z) > len(axes[0].cells) * len(axes[1].cells):
        grid = np.full((len(axes[1].cells), len(axes[0].cells)), np.nan)
        rank = [axis.rank() for axis in axes]
        for a, b, value in zip(x, y, z):
            grid[rank[1][b], rank[0][a]] = value
        ax.grid(False)
        axes[0].is_grid = axes[1].is_grid = True
        drawn = ax.pcolormesh(axes[0].edges(), axes[1].edges(), grid, cmap="viridis", **colours)
    else:
        drawn = ax.scatter(x, y, c=z, cmap="viridis", s=12, **colours)
    for rows, marker in ((table.failed, FAILED), (table.late, MISSING)):
        places = sorted({tuple(axis.of(row[axis.key]) for axis in axes) for row in rows})
        if places:
            ax.plot(*zip(*places), marker, color="black", markerfacecolor="white", markersize=5, clip_on=False)
    axes[0].dress(ax.xaxis)
    axes[1].dress(ax.yaxis)
    if np.isfinite(z).any():
        figure.colorbar(drawn, ax=ax, label=label)


def draw_map(table):
    with_fractions = bool(table.failed or table.late)
    if size().is_narrow:
        figure, panels = plt.subplots(1 + with_fractions, 1, figsize=(size().width, 2.6 * (1 + with_fractions)), sharex=True,
                                      squeeze=False)
        panels = panels.T
    else:
        figure, panels = plt.subplots(1, 1 + with_fractions, sharey=True, squeeze=False,
                                      **figure_of(6.4 + 5.2 * with_fractions, 4.6))
    medians = [number(row["median"]) for row in table.points]
    medians = np.array([np.nan if z is None or np.isinf(z) else z for z in medians])
    norm = matplotlib.colors.LogNorm() if is_wide(medians.tolist()) else None
    draw_cells(figure, panels[0, 0], table, medians, "median of " + table.label(table.column), norm=norm)
    if with_fractions:
        parts = [1 - (int(row["failed"]) + int(row["without_value"])) / int(row["runs"]) for row in table.points]
        draw_cells(figure, panels[0, 1], table, np.array(parts), f"fraction of runs {table.has_value()}", vmin=0, vmax=1)
        if size().is_narrow:
            panels[0, 0].set_xlabel("")
        else:
            panels[0, 1].set_ylabel("")
    if not size().is_paper:
        panels[0, 0].set_title(table.title())
    return figure


def draw(table):
    if not table.keys:
        figure = draw_histogram(table)
        if not size().is_paper:
            figure.axes[0].set_title(table.title())
        return figure
    if len(table.keys) == 1:
        return Curves(table, table.keys[0], None).draw()
    words = [key for key in table.keys if not Axis(table, key).is_numeric]
    if not words:
        return draw_map(table)
    series = "law.name" if "law.name" in words else words[0]
    key = next(key for key in reversed(table.keys) if key != series)
    return Curves(table, key, series).draw()


def draw_files(options, read, draw, has_values, of):
    """Reads what is drawn, and draws it in each of the formats. `of`: what a value belongs to, in words. Returns the exit
    code."""
    try:
        formats = figure_style.formats(options.format)
    except ValueError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    try:
        table = read(options)
    except TableError as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        print(f"error: {options.table}: {getattr(error, 'strerror', None) or error}", file=sys.stderr)
        return 1
    if not has_values(table):
        print(f"error: {options.table}: no {of} has a {options.column}", file=sys.stderr)
        return 1
    figure_style.use(options.size)
    for name in formats:
        figure = draw(table)  # anew: what was laid out before would change the bytes
        figure_style.save(figure, pathlib.Path(options.picture).with_suffix("." + name))
    return 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("table")
    parser.add_argument("statistics")
    parser.add_argument("picture")
    parser.add_argument("column")
    parser.add_argument("keys", nargs="*", metavar="KEY")
    parser.add_argument("--label", action="append", default=[], metavar="NAME=TEXT", help="what a column or key is called")
    parser.add_argument("--time", action="store_true", help="a run without a value is later than its end")
    parser.add_argument("--size", choices=figure_style.SIZES, default="screen")
    parser.add_argument("--format", default="png", metavar="LIST", help="png, pdf, svg, with commas between")
    options = parser.parse_intermixed_args()
    if len(options.keys) > 2:
        parser.error("expected at most two keys")
    return draw_files(options, Table, draw, lambda table: table.good, "run")


if __name__ == "__main__":
    plain.fit_streams()
    sys.exit(main())

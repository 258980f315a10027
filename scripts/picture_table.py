"""The numbers of a picture as a table: what its curves, lines and areas are drawn from, column by column.

An artist that is drawn is told by its label, or by its attribute `told`: a name in place of the label, or columns
{header: values} in place of what it draws.
"""

import csv
import itertools

import numpy as np
from matplotlib.collections import LineCollection, PathCollection, PolyCollection
from matplotlib.lines import Line2D
from matplotlib.patches import Patch


def plain_words(text):
    """The text without marks of mathematics and line breaks: "v_x (m/s)"."""
    return text.replace("\n", " ").replace("$", "").replace("\\", "").replace("{", "").replace("}", "")


def name_of(artist):
    """What the artist is called; '': it is decoration."""
    told = getattr(artist, "told", None)
    label = told if isinstance(told, str) else artist.get_label()
    return plain_words(label) if isinstance(label, str) and not label.startswith("_") else ""


def has_columns(artist):
    return isinstance(getattr(artist, "told", None), dict)


def label_of_x(axis):
    """Of panels one below the other, the lowest one has the label."""
    below = axis.get_shared_x_axes().get_siblings(axis)
    return plain_words(next((label for label in (other.get_xlabel() for other in [axis, *below]) if label), "x"))


def apart(parts):
    """Arrays (N, 2), one after the other, with a gap between each two."""
    gap = np.full((1, 2), np.nan)
    return np.concatenate([piece for part in parts for piece in (gap, np.asarray(part, dtype=float))][1:] or [gap[:0]])


class Table:
    """Columns of different lengths."""

    def __init__(self):
        self.columns = {}

    def add(self, header, values):
        """Adds a column; one of the same header gets a number."""
        for n in itertools.count(1):
            name = header if n == 1 else f"{header} [{n}]"
            if name not in self.columns:
                self.columns[name] = values
                return

    def add_curve(self, name, x, y, labels, is_shared):
        """Adds a curve; x stands once for all curves that share it."""
        x_header = labels[0] if is_shared else f"{name}: {labels[0]}"
        there = self.columns.get(x_header)
        if there is None or not np.array_equal(there, x):
            self.add(x_header, x)
        self.add(f"{name}: {labels[1]}", y)

    def rows(self):
        cells = (map(cell, values) for values in self.columns.values())
        return [list(self.columns), *itertools.zip_longest(*cells, fillvalue="")]


def cell(value):
    """A number with all its digits; nothing where a curve has none."""
    if isinstance(value, str):
        return plain_words(value)
    if isinstance(value, (int, np.integer)):
        return str(value)
    return "" if np.isnan(value) else repr(float(value))


def add_line(table, axis, line, labels, is_shared):
    x, y = (np.asarray(of, dtype=float) for of in line.get_data(orig=True))
    if line.get_transform() == axis.transData:
        if x.size:
            table.add_curve(name_of(line), x, y, labels, is_shared)
    elif line.get_transform() == axis.get_yaxis_transform(which="grid"):  # across the panel
        table.add(f"{name_of(line)}: {labels[1]}", y[:1])
    else:  # from its bottom to its top
        table.add(f"{name_of(line)}: {labels[0]}", x[:1])


def add_other(table, artist, labels):
    if isinstance(artist, LineCollection):
        points = apart(artist.get_segments())
    elif isinstance(artist, PathCollection):
        points = np.asarray(artist.get_offsets())
    elif isinstance(artist, PolyCollection):
        points = apart([path.vertices for path in artist.get_paths()])
    elif isinstance(artist, Patch):
        points = artist.get_patch_transform().transform(artist.get_path().vertices)
    else:
        return
    for values, label in zip(np.transpose(points), labels):
        table.add(f"{name_of(artist)}: {label}", values)


def table_of(figure):
    """All that is drawn in a figure: panel by panel, in the order in which it was."""
    table = Table()
    panels = [axis for axis in figure.axes if not hasattr(axis, "_colorbar")]
    for axis in panels:
        labels = label_of_x(axis), plain_words(axis.get_ylabel()) or "y"
        artists = [artist for artist in axis.get_children() if has_columns(artist) or name_of(artist)]
        curves = [line.get_xdata() for line in artists
                  if isinstance(line, Line2D) and line.get_transform() == axis.transData and len(line.get_xdata())]
        is_shared = len(curves) > 0 and all(np.array_equal(curves[0], x) for x in curves)
        for artist in artists:
            if has_columns(artist):
                for header, values in artist.told.items():
                    table.add(plain_words(header), values)
            elif isinstance(artist, Line2D):
                add_line(table, axis, artist, labels, is_shared)
            else:
                add_other(table, artist, labels)
    for header, values in getattr(figure, "told", {}).items():
        table.add(plain_words(header), values)
    return table


def write(figure, file):
    """Writes the table to an open file of text."""
    csv.writer(file, lineterminator="\n").writerows(table_of(figure).rows())

"""Style of the pictures of runs, sweeps and benchmarks: colours, sizes, legends, and how they are saved."""

import contextlib
import errno
import math
import os
import textwrap
from dataclasses import dataclass

import matplotlib
import matplotlib.pyplot as plt
import matplotlib.ticker
import numpy as np
import pgf_picture
import picture_table
from wording import Wording, did_you_mean

# Palette of Okabe and Ito, which colour-blind readers can distinguish; the palest colours last.
OKABE_ITO = ["#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#F0E442"]
# Theirs, and a purple red and a brown that are at least as far from all others as these are from each other, for eyes of
# all kinds.
COLOURS = [*OKABE_ITO[:-1], "#882255", "#5C2D00", OKABE_ITO[-1]]
# With more lines than colours, each colour but the palest comes in these; dashes are left for other uses.
LINE_STYLES = ["-", ":", "-.", (0, (7, 1.5, 1, 1.5, 1, 1.5))]
DASHED = "--"
RUN_STYLES = ["-", DASHED, ":", "-.", (0, (7, 1.5, 1, 1.5, 1, 1.5)), (0, (2, 3))]  # of runs, whose agents may not lie dashed
LOOKS_MAX = (len(COLOURS) - 1) * len(LINE_STYLES)  # more lines than this share a colour bar
# Their colours: viridis without its palest end.
MANY = matplotlib.colors.ListedColormap(plt.get_cmap("viridis")(np.linspace(0, 0.95, 256)), "many")
STYLE = {
    "axes.axisbelow": True,
    "axes.edgecolor": "0.4",
    "axes.grid": True,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlelocation": "left",
    "axes.titlesize": 10,
    "figure.constrained_layout.use": True,
    "figure.dpi": 120,
    "figure.max_open_warning": 0,  # pictures may wait for each other
    "figure.titlesize": 11,
    "font.size": 9,
    "grid.color": "0.9",
    "legend.fontsize": 8,
    "legend.frameon": False,
    "lines.linewidth": 1.2,
    "pdf.fonttype": 42,  # embeds fonts as TrueType: journals refuse Type 3
    "svg.hashsalt": "mascot",  # or else names within the file are drawn at random
}
PAPER = {  # in addition, at true size
    "axes.linewidth": 0.6,
    "axes.titlesize": 8,
    "figure.constrained_layout.h_pad": 0.02,
    "figure.constrained_layout.w_pad": 0.02,
    "figure.dpi": 300,
    "figure.titlesize": 8,
    "font.size": 8,
    "legend.columnspacing": 1.2,
    "legend.handlelength": 1.8,
    "legend.handletextpad": 0.5,
    "lines.linewidth": 1.0,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
}


@dataclass(frozen=True)
class Size:
    """Widths and heights of pictures in inches."""

    width: float
    panel: float  # height of a panel over time
    single: float  # height of the only panel over time
    square: float  # height of a picture as wide as high, about
    small_pt: float  # smallest letters
    is_paper: bool = True  # a caption is below it, and no title in it
    is_narrow: bool = False  # legends are below, not beside


SIZES = {
    "screen": Size(8, panel=1.9, single=4.2, square=6, small_pt=7, is_paper=False),
    "column": Size(3.5, panel=1.15, single=2.3, square=3, small_pt=8, is_narrow=True),  # of IEEE's journals
    "page": Size(7.16, panel=1.35, single=2.8, square=4.6, small_pt=8),  # both columns
}
IMAGES = ("png", "pdf", "svg")
TEXTS = {"pgf": pgf_picture.write, "csv": picture_table.write}  # of what is drawn; how each is written
FORMATS = (*IMAGES, *TEXTS)
NO_DATES = {"png": {"Software": None}, "svg": {"Creator": None, "Date": None},
            "pdf": {"Creator": None, "Producer": None, "CreationDate": None}}


def named(option, text, names):
    """Names in a list with commas; each once, in the order given. Raises ValueError."""
    chosen = list(dict.fromkeys(text.split(",")))
    for name in chosen:
        if name not in names:
            raise ValueError(f"{option}: expected one or more of {', '.join(names)}, with commas between, got '{name}'"
                             f"{did_you_mean(name, names)}")
    return chosen


def formats(text):
    """Names of IMAGES in a list with commas. Raises ValueError."""
    return named("--format", text, IMAGES)


class Chosen:
    """The size, the colours of lines, and the words in use."""

    size = SIZES["screen"]
    colours = COLOURS
    wording = Wording()


def use(name, sheet=None, wording=None):
    """Draws in this size from now on, whatever the user's own matplotlibrc says. `sheet`: settings of a style sheet, which
    go before ours; if it has a cycle of colours, lines are drawn in these. `wording`: texts that stand in place of
    others."""
    Chosen.size = SIZES[name]
    paper = PAPER if Chosen.size.is_paper else {}
    sheet = sheet or {}
    matplotlib.rcParams.update(matplotlib.rcParamsDefault | STYLE | paper | sheet | {"backend": plt.get_backend()})
    cycle = matplotlib.rcParams["axes.prop_cycle"].by_key().get("color") if "axes.prop_cycle" in sheet else None
    Chosen.colours = list(dict.fromkeys(cycle)) if cycle else COLOURS
    Chosen.wording = wording or Wording()


def word(text):
    """A text as it stands in a picture."""
    return Chosen.wording.of(text) if text else text


def grey(level):
    """A grey between the colour of letters (0) and that of the ground (1): black and white, if no style sheet says else."""
    letters, ground = (np.array(matplotlib.colors.to_rgb(plt.rcParams[key])) for key in ("text.color", "axes.facecolor"))
    return tuple(letters + level * (ground - letters))


def size():
    return Chosen.size


def small():
    return {"fontsize": size().small_pt, "color": grey(0.3)}


def fills(count):
    """Colours of so many areas, which have no kinds of line."""
    colours = Chosen.colours
    return colours[:count] if count <= len(colours) else [MANY(k / (count - 1)) for k in range(count)]


def looks_max():
    """How many lines have a look of their own; more share a colour bar."""
    return max(1, len(Chosen.colours) - 1) * len(LINE_STYLES)


def looks(count):
    """Colours and line styles of so many lines."""
    colours = Chosen.colours
    if len(colours) < count <= looks_max():
        return [(colour, style) for style in LINE_STYLES for colour in colours[:-1] or colours][:count]
    return [(colour, "-") for colour in fills(count)]


def looks_of_runs(count):
    """Colours and line styles of so many runs. Neighbours differ in both, so that grey print tells them apart."""
    colours = fills(count) if count <= len(Chosen.colours) or count > looks_max() else Chosen.colours[:-1] or Chosen.colours
    found = [divmod(k, len(colours)) for k in range(count)]
    return [(colours[k], RUN_STYLES[(k + again) % len(RUN_STYLES)]) for again, k in found]


def shades(palette, most=16):
    """(M, 3), M up to 256: the colours and grey, each in shades up to white: all that a picture in them needs."""
    count = min(most, 256 // (len(palette) + 1))
    rows = [np.linspace(matplotlib.colors.to_rgb(colour), (1, 1, 1), count, endpoint=False) for colour in palette]
    rows.append(np.linspace((0, 0, 0), (1, 1, 1), count))
    return np.rint(255 * np.concatenate(rows)).astype(np.uint8)


def few_decades():
    """Names more of a log axis of less than two decades than its powers of ten, for these may be one or none."""
    return matplotlib.ticker.LogFormatterSciNotation(minor_thresholds=(2, 0.5))


def log_axis(axis):
    """Makes y logarithmic."""
    axis.set_yscale("log")
    axis.yaxis.set_minor_formatter(few_decades())


def title(figure, text):
    """Names the picture, where no caption does."""
    if not size().is_paper:
        figure.suptitle(word(text), x=0.01, ha="left")


def put_words(figure):
    """Puts other words in place of those of axes, panels, curves and marks, where some are wanted."""
    for axis in figure.axes:
        for artist in axis.get_children():
            label = artist.get_label()  # of an axis of coordinates: an artist, too
            if isinstance(label, str) and not label.startswith("_"):
                artist.set_label(word(label) or label)  # without a word it stays in the table
        axis.set_xlabel(word(axis.get_xlabel()))
        axis.set_ylabel(word(axis.get_ylabel()))
        for side in ("left", "center", "right"):
            if text := axis.get_title(loc=side):
                getattr(axis, {"left": "_left_title", "center": "title", "right": "_right_title"}[side]).set_text(word(text))


def keep_free(figure, right=0.0, below=0.0):
    """Keeps these parts of the figure free of panels."""
    if engine := figure.get_layout_engine():
        engine.set(rect=(0, below, 1 - right, 1 - below))


def add_legend(figure, handles, labels, is_below=False, heading=None):
    """Adds a legend beside the panels, or below them, in as many columns as fit, and keeps its place free. A legend
    below makes the figure higher: the panels keep their height."""
    put_words(figure)
    if not handles:
        return
    labels = [word(label) for label in labels]
    width, height = figure.get_size_inches()

    def legend(columns, **where):
        made = figure.legend(handles, labels, ncols=columns, title=heading, borderaxespad=0.4, **where)
        extent = made.get_window_extent(figure.canvas.get_renderer())
        pad = 0.8 * plt.rcParams["legend.fontsize"] / 72
        return made, extent.width / figure.dpi + pad, extent.height / figure.dpi + pad

    if size().is_narrow or is_below:
        for columns in range(min(len(handles), 8), 0, -1):
            made, wide, high = legend(columns, loc="lower center")
            if wide <= width or columns == 1:
                break
            made.remove()
        figure.set_figheight(height + high)
        keep_free(figure, below=high / (height + high))
        return
    top = 0 if size().is_paper else 2.2 * plt.rcParams["figure.titlesize"] / 72
    for columns in range(1, len(handles) + 1):
        made, wide, high = legend(columns, loc="upper right", bbox_to_anchor=(1, 1 - top / height))
        if high <= height - top or columns == len(handles):
            break
        made.remove()
    keep_free(figure, right=wide / width)


def wrap_labels(figure):
    """Breaks the labels of vertical axes that are longer than their axis."""
    def may_be_longer(axis):
        long_pt = 0.6 * axis.yaxis.label.get_fontsize() * len(axis.get_ylabel())
        return long_pt > 0.6 * 72 * axis.get_window_extent().height / figure.dpi

    if not any(map(may_be_longer, figure.axes)):
        return  # laying out the panels takes time
    figure.draw_without_rendering()
    renderer = figure.canvas.get_renderer()
    for axis in figure.axes:
        label = axis.yaxis.label
        long, most = label.get_window_extent(renderer).height, axis.get_window_extent(renderer).height
        if label.get_text() and long > most:
            width = math.floor(len(label.get_text()) * most / long)
            label.set_text("\n".join(textwrap.wrap(label.get_text(), max(8, width), break_long_words=False)))


def save(figure, path):
    """Writes the picture in the format that the ending of its name says: for the same run, the same bytes."""
    kind = path.suffix[1:]
    with new_file(path) as part:
        if kind in TEXTS:
            with part.open("w", encoding="utf-8", newline="") as file:
                TEXTS[kind](figure, file)
        else:
            with part.open("wb") as file:
                figure.savefig(file, format=kind, metadata=NO_DATES[kind])


@contextlib.contextmanager
def new_file(path):
    """An empty file to write, which then takes the place of a file or link at `path`. No link is followed, and what is no
    file is left as it is: raises OSError."""
    if path.is_dir() and not path.is_symlink():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    if path.exists() and not path.is_symlink() and not path.is_file():
        raise FileExistsError(errno.EEXIST, "expected a file, got something else of this name", str(path))
    part = path.with_name(path.name + ".part")
    if part.is_file() and not part.is_symlink():
        part.unlink()
    os.close(os.open(part, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW, 0o666))
    try:
        yield part
        os.replace(part, path)
    except BaseException:
        part.unlink(missing_ok=True)
        raise

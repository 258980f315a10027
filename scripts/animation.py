"""A film of one run, seen from above: where the agents are, their ways so far, who hears whom, and what happens."""

import contextlib
import os
import shutil
import signal
import subprocess
import sys
import tempfile

import figure_style as style
import matplotlib
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import LineCollection
from pictures import (
    area_artists, colours, draw_obstacles, draw_places, edge_artists, in_order, map_axis, mark_area, name_agents,
    name_edges, square_figure,
)
from run_folder import RunError

FRAMES_PER_S = 25
LONGEST_S = 20  # of a film whose pace is not given
TOLD_S = 2  # of the film: how long it tells of an event
ENDINGS = (".mp4", ".gif")
GIF_SCALE = 2 / 3  # smaller than a film: each of its pixels is stored
CELLS_MAX = 30  # more agents than this make cells that take too long


def check(path):
    if path.suffix not in ENDINGS:
        raise RunError(f"--animate: expected a file whose name ends in {' or '.join(ENDINGS)}, got '{path}'", code=2)
    if not shutil.which("ffmpeg"):
        raise RunError("--animate: it needs the program ffmpeg, which is not installed "
                       "(Debian: apt-get install ffmpeg)")


def rows_of_frames(t, pace):
    """Indices of the rows that are frames of the film; the last row is one, too."""
    span_s = t[-1] - t[0]
    pace = pace or max(1.0, span_s / LONGEST_S)
    count = int(np.ceil(span_s / pace * FRAMES_PER_S - 1e-9)) + 1
    wanted = t[0] + np.minimum(np.arange(count) * pace / FRAMES_PER_S, span_s)
    return np.searchsorted(t, wanted - 1e-9), pace


class Film:
    """Draws frame after frame. What never changes is drawn once, and what only grows is added to it."""

    def __init__(self, run, scale, pace):
        self.run, self.told_s = run, TOLD_S * pace
        self.p = run.position[:, :, :2]
        self.seen = self.p[run.rows]
        self.spans, self.events = run.spans, run.events
        self.graphs = [(begin, in_order(edges)) for begin, _, edges in run.graphs]
        self.range_m = run.config.get("graph", {}).get("range_m") or np.inf
        plt.rcParams["figure.dpi"] *= scale
        self.figure, self.axis = square_figure()
        self.has_areas = bool(run.drawing["hull"]) or run.drawing["cells"] and run.size <= CELLS_MAX
        self.draw_still()
        self.make_moving()

    def draw_still(self):
        run, axis = self.run, self.axis
        draw_obstacles(axis, run)
        draw_places(axis, run)
        name_edges(axis, set(run.edges))
        for indices, label, look in self.kinds():
            axis.plot([], [], color=style.grey(0.4), linestyle="", label=label, **look)
        axis.plot(*np.array([self.seen.min(axis=(0, 1)), self.seen.max(axis=(0, 1))]).T, alpha=0)  # what the axes have to hold
        hidden = area_artists(axis, run, self.p[0]) if self.has_areas else []
        map_axis(axis)
        self.text = axis.text(0, 1.01, "t\nt" if self.events else "t", transform=axis.transAxes, va="bottom")
        name_agents(self.figure, [axis], run)
        for artist in hidden:
            artist.remove()
        pixels = self.figure.get_size_inches() * self.figure.dpi
        self.figure.set_size_inches((2 * np.ceil(pixels / 2 - 1e-6)) / self.figure.dpi)  # films want even numbers
        self.figure.draw_without_rendering()
        axis.set_autoscale_on(False)
        self.figure.set_layout_engine("none")
        self.text.set_text("")
        self.figure.canvas.draw()
        self.ground = self.figure.canvas.copy_from_bbox(self.figure.bbox)

    def kinds(self):
        """(indices, label, look) of the agents that are drawn alike, apart from their colours."""
        run, leader = self.run, self.run.drawing["leader"]
        others = [k for k in range(run.size) if k not in run.leads and k not in run.liars]
        size = {"markersize": np.sqrt(mark_area(run))}
        return [(indices, label, look | size) for indices, label, look in (
            (others, None, {"marker": "o"}),
            ([k for k in run.leads if k not in run.liars], leader, {"marker": "o", "markeredgecolor": "black",
                                                                   "markeredgewidth": 1.5}),
            (run.liars, "lies", {"marker": "X", "markeredgecolor": "black", "markeredgewidth": 0.5})) if indices]

    def make_moving(self):
        axis, palette = self.axis, colours(self.run)
        pale = [tuple(0.45 * np.array(matplotlib.colors.to_rgb(colour)) + 0.55) for colour in palette]
        self.ways = axis.add_collection(LineCollection([], colors=pale, linewidths=plt.rcParams["lines.linewidth"],
                                                       capstyle="round"))
        self.marks = [axis.plot([], [], color=palette[k], zorder=4, **look)[0]
                      for indices, _, look in self.kinds() for k in indices]
        self.order = [k for indices, _, _ in self.kinds() for k in indices]
        named = self.run.size <= style.looks_max()
        self.names = [axis.annotate(str(self.run.id[k]), (0, 0), xytext=(5, 4), textcoords="offset points", zorder=5,
                                    annotation_clip=True, **style.small()) for k in self.order] if named else []

    def edges(self, t_s, p):
        """(M, 2): the edges of that time between agents, at places `p` (N, 3), who are near enough."""
        at = max(0, int(np.searchsorted([begin for begin, _ in self.graphs], t_s + 1e-9, side="right")) - 1)
        edges = self.graphs[at][1]
        return edges[np.linalg.norm(p[edges[:, 0]] - p[edges[:, 1]], axis=1) < self.range_m]

    def words(self, t_s):
        """Time and phase; in a second line the events of late, as many as there is room for."""
        phases = [span.law.get("name", "") for span in self.spans if span.at_s <= t_s + 1e-9]
        told = ", ".join(words for at_s, words in self.events if at_s <= t_s + 1e-9 < at_s + self.told_s)
        room = int(72 * self.axis.get_window_extent().width / self.figure.dpi / (0.6 * plt.rcParams["font.size"]))
        told = told if len(told) <= room else told[:room - 3] + "..."
        words = f"t = {t_s:.1f} s" + (f"   {phases[-1]}" if len(self.spans) > 1 else "")
        return f"{words}\n{told}" if self.events else words

    def frame(self, row, row_before):
        """Draws the frame of a row. Returns its pixels."""
        canvas, axis, p = self.figure.canvas, self.axis, self.p[row]
        canvas.restore_region(self.ground)
        self.ways.set_segments(np.swapaxes(self.p[row_before:row + 1], 0, 1))
        axis.draw_artist(self.ways)
        self.ground = canvas.copy_from_bbox(self.figure.bbox)
        passing = edge_artists(axis, p, self.edges(self.run.t[row], self.run.position[row]))
        passing += area_artists(axis, self.run, p) if self.has_areas else []
        for artist in passing:
            axis.draw_artist(artist)
            artist.remove()
        for mark, k in zip(self.marks, self.order):
            mark.set_data([p[k, 0]], [p[k, 1]])
            axis.draw_artist(mark)
        for name, k in zip(self.names, self.order):
            name.xy = p[k]
            axis.draw_artist(name)
        self.text.set_text(self.words(self.run.t[row]))
        axis.draw_artist(self.text)
        return canvas.buffer_rgba()


def encoder(path, part, size, palette):
    """The command that makes a film of frames on its standard input."""
    exact = ["-fflags", "+bitexact", "-flags:v", "+bitexact", "-threads", "1"]
    frames = ["-f", "rawvideo", "-pix_fmt", "rgba", "-s", f"{size[0]}x{size[1]}", "-r", str(FRAMES_PER_S), "-i", "-"]
    of = {".mp4": ["-c:v", "libx264", "-preset", "fast", "-crf", "20", "-pix_fmt", "yuv420p",
                   "-movflags", "+faststart"],
          ".gif": ["-i", palette, "-lavfi", "paletteuse=dither=none:diff_mode=rectangle", "-loop", "0"]}[path.suffix]
    return ["ffmpeg", "-loglevel", "error", "-y", *frames, *of, *exact, "-f", path.suffix[1:],
            f"file:{part}"]


def write_palette(path, run):
    """As ffmpeg wants it: 16 x 16 pixels."""
    shades = style.shades(list(dict.fromkeys(colours(run))))
    square = np.resize(shades, (256, 3))
    square[len(shades):] = 255
    plt.imsave(path, square.reshape(16, 16, 3))


def film(run, path, pace, check_words=lambda: None):
    """Writes the film. Of the same run, and with the same ffmpeg, the same bytes. `check_words`: is called when all texts are
    known, and nothing is written yet."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    rows, pace = rows_of_frames(run.t[run.rows], pace)
    rows += run.rows.start
    drawing = Film(run, GIF_SCALE if path.suffix == ".gif" else 1, pace)
    try:
        check_words()
        with style.new_file(path) as part, tempfile.TemporaryDirectory() as scratch:
            palette = os.path.join(scratch, "palette.png")
            write_palette(palette, run)
            encode(drawing, rows, encoder(path, part, drawing.figure.canvas.get_width_height(), palette))
    except EncoderFailed as failure:
        raise RunError(f"{path}: ffmpeg failed: {failure}") from None
    finally:
        plt.close(drawing.figure)


class EncoderFailed(Exception):
    """What ffmpeg says last."""


def encode(drawing, rows, command):
    with tempfile.TemporaryFile() as said, subprocess.Popen(command, stdin=subprocess.PIPE, stderr=said) as process:
        try:
            for before, row in zip([rows[0], *rows], rows):
                process.stdin.write(drawing.frame(row, before))
            process.stdin.close()
        except BrokenPipeError:  # it has given up
            with contextlib.suppress(BrokenPipeError):
                process.stdin.close()
        except BaseException:
            process.kill()
            raise
        if process.wait() != 0:
            said.seek(0)
            lines = said.read().decode(errors="replace").strip().splitlines()
            raise EncoderFailed(lines[-1] if lines else f"exit code {process.returncode}")

#!/usr/bin/python3 -Es
"""Draws the pictures of runs (scripts/pictures.py), of several runs in one (overlay.py), or a film (animation.py).

The same run always gives the same bytes. Exit codes: 0 done, 1 a run cannot be read, 2 wrong use.
"""

import argparse
import math
import os
import pathlib
import sys
import traceback

sys.dont_write_bytecode = True  # the folder of the scripts may be read-only
import own_matplotlib  # noqa: F401: the first of all that draw
import animation
import figure_style
import matplotlib.pyplot as plt
import plain
import style_sheet
from overlay import OVERLAYS, draw_overlay
from pictures import PICTURES, usual
from run_folder import RunError, read_run
from wording import Wording, did_you_mean

AGENTS_EXPECTED = "--agents: expected numbers of agents and ranges of them, with commas between, such as 1,4 or 1-3"


def wrong(message):
    raise RunError(message, code=2)


def choose(run, only):
    """Names of the pictures to draw."""
    for name in only or ():
        if PICTURES[name].applies(run):
            wrong(f"--only {name}: {PICTURES[name].applies(run)}")
    names = only or usual(run)
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


def opens_windows(wanted):
    if wanted and not can_open_windows():
        print("no display: no window is opened", file=sys.stderr)
        return False
    return wanted


def finish(figure, folder, name, formats, keep):
    for ending in formats:
        figure_style.save(figure, folder / f"{name}.{ending}")
    if not keep:
        plt.close(figure)


def draw_run(folder, run, options, show):
    """Yields folder, name, figure and formats of each picture of a run."""
    if not run.summary.get("drawing"):
        print(f"{folder}: summary.json does not say how the law is drawn: only what all laws have is", file=sys.stderr)
    names = choose(run, options.only) if show or run.output("save_plot") else []
    if not names:
        print(f"{folder}: no picture drawn: config.toml's [output] switches them off", file=sys.stderr)
    for name in names:
        figure_style.Chosen.wording.begin(name)
        yield options.out or folder, name, PICTURES[name].draw(run), options.format if run.output("save_plot") else []


def list_of(option, names):
    def check(text):
        try:
            return figure_style.named(option, text, names)
        except ValueError as error:
            wrong(str(error))
    return check


def pace(text):
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0 < value < math.inf:
        wrong(f"--pace: expected a number above 0, got '{text}'")
    return value


def one_of(option, names):
    def check(text):
        if text not in names:
            wrong(f"{option}: expected one of {', '.join(names)}, got '{text}'{did_you_mean(text, names)}")
        return text
    return check


def seconds(option):
    def check(text):
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            wrong(f"{option}: expected a number of seconds, got '{text}'")
        return value
    return check


def agents(text):
    """The ranges (first, last) of numbers in a list: 1,4 or 1-3."""
    found = []
    for part in text.split(","):
        ends = part.split("-")
        if len(ends) > 2 or not all(end.isascii() and end.isdigit() and len(end) < 10 for end in ends):
            wrong(f"{AGENTS_EXPECTED}, got '{text}'")
        first, last = int(ends[0]), int(ends[-1])
        if last < first:
            wrong(f"{AGENTS_EXPECTED}, got '{part}', which ends before it begins")
        found.append((first, last))
    return found


def label(text):
    key, equals, words = text.partition("=")
    if not (key and equals):
        wrong(f"--label: expected KEY=TEXT, got '{text}'")
    return key, words


def style(text):
    try:
        return style_sheet.read(text)
    except style_sheet.StyleError as error:
        wrong(str(error))


class Parser(argparse.ArgumentParser):
    def error(self, message):
        wrong(message)


def parser():
    made = Parser(description="Draws the pictures of runs, by default each into the folder of its run.")
    made.add_argument("runs", metavar="RUN_FOLDER", type=pathlib.Path, nargs="+")
    made.add_argument("--only", metavar="LIST", type=list_of("--only", PICTURES),
                      help=", ".join(PICTURES) + ", with commas between")
    made.add_argument("--format", metavar="LIST", type=list_of("--format", figure_style.FORMATS),
                      help=", ".join(figure_style.FORMATS) + ", with commas between (png)")
    made.add_argument("--size", metavar="SIZE", type=one_of("--size", figure_style.SIZES), default="screen",
                      help="one of " + ", ".join(figure_style.SIZES))
    made.add_argument("--style", metavar="FILE", type=style,
                      help="a style sheet of matplotlib (.mplstyle), or the name of one that matplotlib has")
    made.add_argument("--agents", metavar="LIST", type=agents, help="draw these agents only: 1,4 or 1-3")
    made.add_argument("--from-s", metavar="X", type=seconds("--from-s"), help="draw what was from this time on")
    made.add_argument("--to-s", metavar="Y", type=seconds("--to-s"), help="draw what was up to this time")
    made.add_argument("--label", metavar="KEY=TEXT", type=label, action="append", default=[],
                      help="TEXT in the place of the text KEY of the pictures, or of one: PICTURE.KEY")
    made.add_argument("--out", metavar="FOLDER", type=pathlib.Path, help="where the pictures go")
    made.add_argument("--overlay", action="store_true", help="all runs in the same pictures")
    made.add_argument("--animate", metavar="FILE", type=pathlib.Path, help="a film (.mp4, .gif) instead of pictures")
    made.add_argument("--pace", metavar="X", type=pace, help="of the film: simulated seconds per second")
    made.add_argument("--show", action="store_true", help="open windows, too")
    return made


def check(options):
    """Refuses options that do not go together."""
    if options.overlay:
        if len(options.runs) < 2:
            wrong("--overlay: expected at least 2 runs, got 1")
        if not options.out:
            wrong("--overlay: it needs --out FOLDER, for the pictures belong to no single run")
        for name in options.only or ():
            if name not in OVERLAYS:
                wrong(f"--only {name}: expected one of {', '.join(OVERLAYS)} with --overlay")
    elif options.out and len(options.runs) > 1:
        wrong(f"--out: expected one run, or --overlay, got {len(options.runs)} runs, whose pictures have the same "
              "names")
    if options.animate:
        if len(options.runs) > 1:
            wrong(f"--animate: expected one run, got {len(options.runs)}")
        for name in ("only", "format", "agents", "out", "show"):
            if getattr(options, name):
                wrong(f"--animate: it draws a film and nothing else, got --{name} too")
        animation.check(options.animate)
    elif options.pace:
        wrong("--pace: it is that of a film, and needs --animate")
    if None not in (options.from_s, options.to_s) and not options.from_s < options.to_s:
        wrong(f"--to-s: expected a time after that of --from-s, {options.from_s:g} s, got {options.to_s:g}")
    for key, _ in options.label:
        if [other for other, _ in options.label].count(key) > 1:
            wrong(f"--label: expected another text for '{key}' once, got {[other for other, _ in options.label].count(key)}")


def see(folder, run, options):
    """Chooses what of a run is drawn: which agents, and when."""
    if options.agents:
        index = {int(number): k for k, number in enumerate(run.id)}
        for first, last in options.agents:
            unknown = next((number for number in (first, last) if number not in index), None)
            if unknown is not None:
                wrong(f"--agents: {folder}: expected numbers from {min(index)} to {max(index)}, got {unknown}")
        run.only = tuple(k for number, k in sorted(index.items())
                         if any(first <= number <= last for first, last in options.agents))
    run.from_s = -math.inf if options.from_s is None else options.from_s
    run.to_s = math.inf if options.to_s is None else options.to_s
    if run.rows.start == run.rows.stop:
        option, value = ("--from-s", options.from_s) if options.from_s is not None else ("--to-s", options.to_s)
        until = f" to {options.to_s:g}" if None not in (options.from_s, options.to_s) else ""
        wrong(f"{option}: {folder}: expected a window of time with rows of the run, which is from {run.t[0]:g} to "
              f"{run.t[-1]:g} s, got {value:g}{until}")


def check_words():
    """Refuses a --label for a text that is in none of the pictures."""
    if unused := figure_style.Chosen.wording.unused():
        wrong(f"--label: {unused}")


def draw(options):
    check(options)
    runs = [read_run(folder) for folder in options.runs]
    for folder, run in zip(options.runs, runs):
        see(folder, run, options)
    wording = Wording(dict(options.label))
    if options.animate:
        figure_style.use(options.size, options.style, wording)
        animation.film(runs[0], options.animate, options.pace, check_words)
        return
    show = opens_windows(options.show or not options.overlay and any(run.output("show_plot") for run in runs))
    figure_style.use(options.size, options.style, wording)
    options.format = options.format or ["png"]
    if options.overlay:
        made = ((options.out, name, figure, options.format)
                for name, figure in draw_overlay(options.runs, runs, options.only))
    else:
        made = (one for folder, run in zip(options.runs, runs) for one in draw_run(folder, run, options, show))
    if options.label:  # no picture is written if a text is not found
        made = list(made)
        check_words()
    if options.out:
        options.out.mkdir(parents=True, exist_ok=True)
    for folder, name, figure, formats in made:
        finish(figure, folder, name, formats, show)
    if show:
        plt.show()


def main(arguments):
    try:
        draw(parser().parse_args(arguments))
    except RunError as error:
        print(f"error: {error}", file=sys.stderr)
        return error.code
    except (AttributeError, IndexError, KeyError, TypeError, ValueError) as error:
        where = traceback.extract_tb(error.__traceback__)[-1]
        print(f"error: config.toml or summary.json says something else than a run's does: {type(error).__name__}: "
              f"{error} (in {pathlib.Path(where.filename).name}:{where.lineno})", file=sys.stderr)
        return 1
    except OSError as error:
        print(f"error: {error.filename}: {error.strerror or error}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    plain.fit_streams()
    sys.exit(main(sys.argv[1:]))

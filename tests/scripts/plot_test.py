#!/usr/bin/python3
"""Tests of scripts/plot.py and scripts/law_pictures: which pictures and films they make, what these contain, how large
they are, and error messages."""

import contextlib
import csv
import importlib.machinery
import importlib.util
import io
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import zipfile
from unittest import mock

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
sys.dont_write_bytecode = True
import animation
import figure_style
import overlay
import pictures
import plain
import plot
import plot_sweep
import run_folder
import style_sheet
import wording
import matplotlib
from matplotlib.quiver import Quiver

loader = importlib.machinery.SourceFileLoader("law_pictures", str(pathlib.Path(plot.__file__).parent / "law_pictures"))
law_pictures = importlib.util.module_from_spec(importlib.util.spec_from_loader("law_pictures", loader))
loader.exec_module(law_pictures)

ROOT = pathlib.Path(plot.__file__).parent.parent
LIMIT_S = 240  # of a command; ctest ends the test after 300 s, without a word
CONSENSUS = '[run]\nname = "demo"\n[law]\nname = "consensus"\n'
LEADER = CONSENSUS + "leader = 2\n"
MINMAX = '[law]\nname = "minmax"\nleader = 1\n'
WAYPOINT = '[law]\nname = "waypoint"\naxes = "xyz"\nwaypoints_m = [[4, 0, 1], [4, 4, 1]]\ndwell_s = 0.5\n'
AGREEMENT = {"leader": "leader", "switches": False, "pictures": ["disagreement"]}
PURSUIT = {"leader": "root", "switches": True, "pictures": ["disagreement", "tracking"]}
FLIGHT = {"leader": "leader", "switches": False, "pictures": ["error"]}
PATH = {"graph": {"edges": [[1, 2, 1.0], [2, 1, 1.0], [2, 3, 1.0], [3, 2, 1.0]]}}


def arrays(agents=3, rows=51):
    """States of agents on a circle that contract exponentially to (1, 2), each at its own height."""
    t = np.arange(rows) / 10
    angle = 2 * np.pi * np.arange(agents) / agents
    start = np.stack([5 * np.cos(angle), 5 * np.sin(angle), 1 + np.arange(agents)], axis=1)
    shrink = np.exp(-t)[:, None, None] * np.array([1, 1, 0])
    end = np.array([1, 2, 0]) + start * np.array([0, 0, 1])
    offset = start * np.array([1, 1, 0])
    return {"t": t, "id": np.arange(1, agents + 1), "position": end + shrink * offset, "velocity": -shrink * offset,
            "acceleration_command": shrink * offset}


def setUpModule():
    figure_style.STYLE |= {"figure.dpi": 30, "figure.constrained_layout.use": False}  # fast: nobody looks at these


@contextlib.contextmanager
def laid_out(dpi=30):
    """Panels have their true places meanwhile."""
    changed = {"figure.constrained_layout.use": True, "figure.dpi": dpi}
    with mock.patch.dict(figure_style.STYLE, changed), mock.patch.dict(figure_style.PAPER, {"figure.dpi": dpi}):
        yield


class PlotTest(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name) / "a run"
        self.folder.mkdir()
        self.addCleanup(plot.plt.close, "all")

    def write(self, config=CONSENSUS, summary=None, states=None):
        np.savez(self.folder / "states.npz", **(arrays() if states is None else states))
        (self.folder / "config.toml").write_text(config)
        drawing = PURSUIT if "minmax" in config else FLIGHT if "waypoint\"" in config else AGREEMENT
        (self.folder / "summary.json").write_text(json.dumps({"drawing": drawing} | (summary or {})))

    def run_plot(self, *options):
        """Runs plot.py. Returns its exit code and its stderr."""
        errors = io.StringIO()
        with contextlib.redirect_stderr(errors):
            code = plot.main([str(self.folder), *options])
        return code, errors.getvalue()

    def check(self, code, message, *options):
        self.assertEqual(self.run_plot(*options), (code, f"error: {message}\n"))

    def pictures(self):
        return sorted(path.stem for path in self.folder.glob("*.png"))

    def clipped(self, name, size):
        """What of the picture is not whole: beyond the page, or covered by the legend."""
        figure_style.use(size)
        figure = pictures.PICTURES[name].draw(run_folder.read_run(self.folder))
        figure.canvas.draw()
        renderer = figure.canvas.get_renderer()
        tight, (wide, high) = figure.get_tightbbox(renderer), figure.get_size_inches()
        over = max(-tight.x0, -tight.y0, tight.x1 - wide, tight.y1 - high)
        covered = [axis for axis in figure.axes for legend in figure.legends
                   if axis.get_visible() and legend.get_window_extent(renderer).overlaps(axis.get_tightbbox(renderer))]
        plot.plt.close(figure)
        return (["beyond the page"] if over > 0.002 else []) + covered

    def figure(self, name, size="screen", **what):
        self.write(**what)
        figure_style.use(size)
        return pictures.PICTURES[name].draw(run_folder.read_run(self.folder))


class Pictures(PlotTest):
    def test_consensus_gets_five(self):
        self.write()
        self.assertEqual(self.run_plot(), (0, ""))
        self.assertEqual(self.pictures(), ["acceleration", "disagreement", "paths", "position", "velocity"])

    def test_minmax_also_gets_tracking(self):
        self.write(MINMAX, PATH)
        self.assertEqual(self.run_plot(), (0, ""))
        self.assertIn("tracking", self.pictures())

    def test_waypoint_gets_error_and_no_disagreement(self):
        self.write(WAYPOINT)
        self.assertEqual(self.run_plot(), (0, ""))
        self.assertEqual(self.pictures(), ["acceleration", "error", "paths", "position", "velocity"])

    def test_without_its_summary_a_law_gets_what_all_laws_have(self):
        self.write()
        (self.folder / "summary.json").unlink()
        code, errors = self.run_plot()
        self.assertEqual(code, 0)
        self.assertRegex(errors, r"summary\.json does not say how the law is drawn: only what all laws have is\n$")
        self.assertEqual(self.pictures(), ["acceleration", "paths", "position", "velocity"])

    def test_one_agent_one_row_and_many_agents_are_drawn(self):
        for agents, rows in ((1, 51), (3, 1), (11, 5), (201, 2)):
            with self.subTest(agents=agents, rows=rows):
                self.write(states=arrays(agents, rows))
                for name in ["paths", "velocity"] + ["disagreement"] * (agents > 1):
                    self.assertEqual(self.run_plot("--only", name), (0, ""))

    def test_up_replaces_all_pictures_by_name(self):
        told = (ROOT / "orchestrator/recording/run_folder.cc").read_text()
        names = re.search(r"kPictures\[\] = \{(.*?)\}", told, re.S)[1]
        self.assertEqual(sorted(re.findall(r'"(\w+)"', names)), sorted(pictures.PICTURES))
        endings = re.search(r"kPictureFormats\[\] = \{(.*?)\}", told, re.S)[1]
        self.assertEqual(re.findall(r'"\.(\w+)"', endings), list(figure_style.FORMATS))

    def test_the_program_tells_the_words_of_its_options(self):
        told = dict(re.findall(r'\{"--(\w+)", "\w+:\{(.*?)\}"', (ROOT / "orchestrator/verbs/plot.cc").read_text()))
        self.assertEqual({option: words.split(",") for option, words in told.items()}, {
            "only": list(pictures.PICTURES), "format": list(figure_style.FORMATS), "size": list(figure_style.SIZES)})

    def test_only_draws_those_that_it_names(self):
        self.write()
        self.assertEqual(self.run_plot("--only", "velocity"), (0, ""))
        self.assertEqual(self.pictures(), ["velocity"])
        self.assertEqual(self.run_plot("--only", "position,paths"), (0, ""))
        self.assertEqual(self.pictures(), ["paths", "position", "velocity"])

    def test_the_same_run_gives_the_same_bytes(self):
        self.write(LEADER, PATH)
        for name in ("paths", "disagreement"):
            self.run_plot("--only", name)
        first = {path.name: path.read_bytes() for path in self.folder.glob("*.png")}
        self.run_plot()
        self.assertEqual({path.name: path.read_bytes() for path in self.folder.glob("*.png") if path.name in first}, first)
        self.assertNotIn(b"tEXt", first["paths.png"])


class LawCurves(PlotTest):
    """The picture `curve`: the law's own."""

    GAP = {"name": "smallest gap", "unit": "m", "meaning": "between neighbours", "decays": False, "figure": "least_gap_m"}
    MISS = {"name": "miss", "unit": "m^2", "meaning": "of the farthest", "decays": True, "figure": ""}

    def write_run(self, curve=GAP, values=None, config=CONSENSUS, states=None, **told):
        values = np.linspace(5, 3, 51) if values is None else values
        (self.folder / "law_curve.csv").write_text("t_s,value\n" + "".join(f"{k / 10},{v}\n" for k, v in enumerate(values)))
        self.write(config, {"drawing": AGREEMENT | {"curve": curve}} | told, states)
        figure_style.use("screen")
        return run_folder.read_run(self.folder)

    def draw(self, *run, **what):
        axis, = pictures.PICTURES["curve"].draw(*run or [self.write_run(**what)]).axes
        return axis, {line.get_label(): line for line in [*axis.get_lines(), *axis.collections]}

    def test_it_is_drawn_with_its_name_its_unit_and_what_theory_predicts_of_it(self):
        laws = {"consensus": {"predicted": {"least_gap_m": 2.5}, "bounds": {"least_gap_m": "at_least"}}}
        axis, lines = self.draw(laws=laws)
        self.assertEqual((axis.get_ylabel(), axis.get_yscale()), ("smallest gap (m)", "linear"))
        np.testing.assert_allclose(lines["smallest gap"].get_data(), [arrays()["t"], np.linspace(5, 3, 51)])
        self.assertEqual(lines["least gap, predicted: at least 2.5 m"].get_segments()[0].tolist(), [[0, 2.5], [5, 2.5]])
        laws["consensus"]["predicted"]["least_gap_m"] = None
        self.assertEqual(list(self.draw(laws=laws)[1]), ["smallest gap"])

    def test_a_curve_that_decays_has_a_log_axis_and_ends_at_the_floor(self):
        axis, lines = self.draw(curve=self.MISS, values=10.0 ** -np.linspace(0, 10, 51))
        self.assertEqual((axis.get_ylabel(), axis.get_yscale()), ("miss (m²)", "log"))
        self.assertEqual(int(np.isnan(lines["miss"].get_ydata()).sum()), 21)
        self.assertIn("floor: 1e-6 m²", lines)

    def test_of_a_schedule_the_curve_of_the_last_phase_is_drawn_where_it_is_flown(self):
        told = [{"at_s": at_s, "law": law, "drawing": AGREEMENT | {"curve": curve}, "laws": {law: laws}}
                for at_s, law, curve, laws in ((0, "chase", None, {}), (2, "chase", self.MISS, {}), (4, "flee", self.GAP, {
                    "predicted": {"least_gap_m": 4}, "bounds": {"least_gap_m": "equal"}}))]
        axis, lines = self.draw(config=Changes.PHASES, phases=told)
        self.assertEqual(np.isnan(lines["smallest gap"].get_ydata()).tolist(), [True] * 40 + [False] * 11)
        self.assertEqual(lines["least gap, predicted 4 m"].get_segments()[0].tolist(), [[4, 4], [5, 4]])
        self.assertEqual([text.get_text() for text in axis.texts], ["chase", "leader = 3", "flee"])

    def test_a_window_of_time_and_a_table(self):
        run = self.write_run(laws={"consensus": {"predicted": {"least_gap_m": 2.5}, "bounds": {"least_gap_m": "at_least"}}})
        run.from_s, run.to_s = 1.0, 2.0
        self.assertEqual(self.draw(run)[1]["smallest gap"].get_xdata().size, 11)
        self.assertEqual(self.run_plot("--only", "curve", "--format", "csv"), (0, ""))
        header, *rows = csv.reader((self.folder / "curve.csv").read_text().splitlines())
        least = "least gap, predicted: at least 2.5 m"
        self.assertEqual(header, ["time (s)", "smallest gap: smallest gap (m)", f"{least}: time (s)", f"{least}: smallest gap (m)"])
        self.assertEqual(rows[:3], [["0.0", "5.0", "0.0", "2.5"], ["0.1", "4.96", "5.0", "2.5"], ["0.2", "4.92", "", ""]])

    def test_what_tells_most_of_the_law_comes_first(self):
        run = self.write_run()
        self.assertEqual(pictures.usual(run), ["paths", "curve", "position", "velocity", "disagreement", "acceleration"])
        run.summary["drawing"]["telling"] = "velocity"
        run.__dict__.pop("spans", None)
        self.assertEqual(pictures.usual(run)[0], "velocity")

    def test_paths_along_one_line_give_way_to_the_curve(self):
        states = arrays()
        states["position"][:, :, 1] = 0
        run = self.write_run(states=states)
        self.assertIn("paths", pictures.usual(run), "the law says that they tell most")
        run.summary["drawing"]["telling"] = "velocity"
        self.assertNotIn("paths", pictures.usual(run))
        self.assertEqual(plot.choose(run, ["paths"]), ["paths"], "if it is asked for")
        run.law_curve = ()
        self.assertIn("paths", pictures.usual(run), "there is nothing else")
        run = self.write_run(states=states, config=CONSENSUS + '[[physics.obstacles]]\nshape = "sphere"\nposition_m = [9, 9, 1]\n'
                             'size_m = [2, 2, 2]\n')
        run.summary["drawing"]["telling"] = "velocity"
        self.assertIn("paths", pictures.usual(run))

    def test_a_run_without_a_curve_and_a_damaged_one(self):
        self.write()
        none = "--only curve: it needs a law with a curve of its own, and the run's law_curve.csv"
        self.check(2, none, "--only", "curve")
        self.write_run(curve=None)
        self.check(2, none, "--only", "curve")
        path = self.folder / "law_curve.csv"
        for text, why in (("t_s,value\n0,x\n", "damaged, or not a table of times and values"),
                          ("a,b\n1,2\n", "damaged, or not a table of times and values"),
                          ("t_s,value\n1,2\n1,3\n", "expected times that increase and numbers, got others"),
                          ("t_s,value\n1,nan\n", "expected times that increase and numbers, got others")):
            path.write_text(text)
            self.check(1, f"{path}: {why}")


class Switches(PlotTest):
    def test_position_plot_off_leaves_velocity_and_acceleration(self):
        self.write(CONSENSUS + "[output]\nposition_plot = false\n")
        self.assertEqual(self.run_plot()[0], 0)
        self.assertEqual(self.pictures(), ["acceleration", "velocity"])

    def test_velocity_plot_off_leaves_the_others(self):
        self.write(MINMAX + "[output]\nvelocity_plot = false\n", PATH)
        self.assertEqual(self.run_plot()[0], 0)
        self.assertEqual(self.pictures(), ["disagreement", "graph", "paths", "position", "tracking"])

    def test_save_plot_off_writes_none_and_says_so(self):
        self.write(CONSENSUS + "[output]\nsave_plot = false\n")
        code, errors = self.run_plot()
        self.assertEqual((code, self.pictures()), (0, []))
        self.assertIn("no picture drawn", errors)

    def test_show_without_a_display_still_writes_and_exits_0(self):
        kept = {key: os.environ.pop(key) for key in ("DISPLAY", "WAYLAND_DISPLAY") if key in os.environ}
        self.addCleanup(os.environ.update, kept)
        self.write(CONSENSUS + "[output]\nshow_plot = true\n")
        for options in ((), ("--show",)):
            self.assertEqual(self.run_plot("--only", "paths", *options), (0, "no display: no window is opened\n"))
        self.assertEqual(self.pictures(), ["paths"])


class WhatIsInThem(PlotTest):
    def lines(self, axis):
        return {line.get_label(): line for line in axis.get_lines()}

    def test_axes_are_labelled_with_units(self):
        position = self.figure("position").axes
        self.assertEqual([axis.get_ylabel() for axis in position], ["x (m)", "y (m)", "z (m)"])
        self.assertEqual(position[-1].get_xlabel(), "time (s)")
        velocity = self.figure("velocity").axes
        self.assertEqual([axis.get_ylabel() for axis in velocity], [f"$v_{k}$ (m/s)" for k in "xyz"])
        paths = self.figure("paths").axes[0]
        self.assertEqual((paths.get_xlabel(), paths.get_ylabel()), ("x, east (m)", "y, north (m)"))
        self.assertEqual(paths.get_aspect(), 1)

    def test_acceleration_shows_the_axes_of_the_law_and_the_limit(self):
        axes = self.figure("acceleration").axes
        self.assertEqual([axis.get_ylabel() for axis in axes], ["$a_x$ (m/s²)", "$a_y$ (m/s²)"])
        self.assertNotIn("limit ±3 m/s²", self.lines(axes[0]))
        self.assertEqual(axes[0].get_title(loc="right"), "some agents have other limits")
        axes = self.figure("acceleration", config=CONSENSUS + "[control]\nmax_acceleration_m_per_s2 = 5\n").axes
        self.assertEqual(self.lines(axes[0])["limit ±5 m/s²"].get_ydata()[0], 5)
        self.assertEqual(len(self.figure("acceleration", config=WAYPOINT).axes), 3)

    def test_acceleration_says_that_none_is_commanded(self):
        states = arrays()
        states["acceleration_command"] *= 0
        axes = self.figure("acceleration", states=states).axes
        self.assertEqual(axes[0].get_title(loc="right"), "none is commanded")

    def test_a_limit_far_away_does_not_flatten_the_lines(self):
        axes = self.figure("acceleration", config=CONSENSUS + "[control]\nmax_acceleration_m_per_s2 = 100\n").axes
        self.assertLess(axes[0].get_ylim()[1], 10)
        self.assertEqual(axes[0].get_title(loc="right"), "limit ±100 m/s², out of view")

    def test_an_acceleration_that_switches_is_smoothed(self):
        states = arrays(rows=51)
        states["acceleration_command"] = np.tile(np.array([1.0, -1.0, 1, -1, 1, -1])[:, None, None], (9, 3, 3))[:51]
        axis = self.figure("acceleration", config=MINMAX, states=states).axes[0]
        smooth = self.lines(axis)["agent 2"].get_ydata()
        self.assertEqual(smooth[0], 1)
        self.assertLess(np.abs(smooth[5:]).max(), 0.21)  # mean over five rows of +-1
        self.assertEqual(len(axis.collections[0].get_segments()), 3)

    def test_a_log_axis_of_little_more_than_a_decade_names_several_values(self):
        states = arrays()
        states["position"] *= np.linspace(1, 0.3, states["t"].size)[:, None, None]
        figure = self.figure("error", config=WAYPOINT, states=states)
        low, high = figure.axes[0].get_ylim()
        self.assertLess(high / low, 100)
        figure.draw_without_rendering()
        labels = figure.axes[0].get_yticklabels(which="both")
        shown = [label for label in labels if label.get_text() and low <= label.get_position()[1] <= high]
        self.assertGreaterEqual(len(shown), 3)

    def test_disagreement_is_the_distance_to_the_mean_on_a_log_axis(self):
        axis = self.figure("disagreement").axes[0]
        self.assertEqual((axis.get_yscale(), axis.get_ylabel()), ("log", "distance to the mean (m)"))
        np.testing.assert_allclose(self.lines(axis)["largest"].get_ydata(), 5 * np.exp(-arrays()["t"]), rtol=1e-12)

    def test_curves_end_at_the_floor_which_has_a_name(self):
        states = arrays(rows=301)  # from 5 m to 5e-13 m
        axis = self.figure("disagreement", states=states).axes[0]
        lines = self.lines(axis)
        for name in ("agent 1", "largest"):
            drawn = lines[name].get_ydata()
            self.assertEqual(np.isnan(drawn).tolist(), (5 * np.exp(-states["t"]) <= 1e-6).tolist())
        self.assertEqual(lines["floor: 1e-6 m"].get_ydata()[0], 1e-6)
        self.assertNotIn("floor: 1e-6 m", self.lines(self.figure("disagreement").axes[0]), "no curve comes to it")
        far = arrays(rows=101)
        far["position"] = far["position"] + 1e11  # what rounding leaves of them is worse
        self.assertIn("floor of rounding: 1e-3 m", self.lines(self.figure("disagreement", states=far).axes[0]))

    def test_disagreement_of_a_formation_leaves_the_places_out(self):
        config = '[law]\nname = "formation"\n'
        states = arrays()
        offsets = [[0, 0, 0], [3, 0, 0], [0, 4, 0]]
        states["position"] = states["position"] + np.array(offsets)
        summary = {"formation": {"offsets_m": offsets}}
        axis = self.figure("disagreement", config=config, summary=summary, states=states).axes[0]
        self.assertEqual(axis.get_ylabel(), "distance from its place, seen from the mean (m)")
        np.testing.assert_allclose(self.lines(axis)["largest"].get_ydata(), 5 * np.exp(-arrays()["t"]), rtol=1e-12)

    def test_obstacles_are_drawn_where_they_stand(self):
        config = CONSENSUS + ('[[physics.obstacles]]\nshape = "box"\nposition_m = [1, 2, 0]\nsize_m = [2, 4, 1]\n'
                              '[[physics.obstacles]]\nshape = "sphere"\nposition_m = [5, 0, 1]\nsize_m = [2, 2, 2]\n')
        figure = self.figure("paths", config=config)
        box, sphere = figure.axes[0].patches[:2]
        self.assertEqual([text.get_text() for text in figure.legends[0].get_texts()].count("obstacles"), 1)
        self.assertEqual((box.get_x(), box.get_y(), box.get_width(), box.get_height()), (0, 0, 2, 4))
        self.assertEqual((tuple(sphere.center), sphere.radius), ((5, 0), 1))

    def test_a_liar_is_dashed_and_named_and_does_not_count_in_the_disagreement(self):
        config = CONSENSUS + '[[agents.override]]\nid = 2\nlie = { kind = "constant", offset_m = [9, 0, 0] }\n'
        lines = self.lines(self.figure("paths", config=config).axes[0])
        self.assertEqual([lines[f"agent {name}"].get_linestyle() for name in ("1", "2 (lies)", "3")], ["-", "--", "-"])
        states = arrays()
        states["position"][:, 1] = [100, 0, 1]
        axis = self.figure("disagreement", config=config, states=states).axes[0]
        p = states["position"][0, [0, 2], :2]
        self.assertAlmostEqual(self.lines(axis)["largest"].get_ydata()[0], np.linalg.norm(p[0] - p[1]) / 2)

    FAULTS = CONSENSUS + ('[[events]]\nat_s = 1.0\nfault = { agent = 2, kind = "kill" }\n'
                          '[[events]]\nat_s = 2.0\nrestart = 2\n'
                          '[[events]]\nat_s = 3.0\nfault = { agent = 3, of = "agent", kind = "lie", offset_m = [1, 0, 0] }\n'
                          '[[events]]\nat_s = 3.5\nfault = { agent = 1, of = "motor", kind = "off", motor = 2 }\n'
                          '[[events]]\nat_s = 4.0\nfault = { agent = 3, kind = "ok" }\n')

    def counting(self, config):
        """Who counts at each half second, by number."""
        self.write(config)
        run = run_folder.read_run(self.folder)
        return {float(t_s): [int(k) + 1 for k in np.flatnonzero(of)] for t_s, of in zip(run.t, run.counts) if t_s % 0.5 == 0}

    def test_who_is_lost_or_lies_at_a_time_does_not_count(self):
        all_of_them = [1, 2, 3]
        self.assertEqual(self.counting(self.FAULTS), {
            0.0: all_of_them, 0.5: all_of_them, 1.0: [1, 3], 1.5: [1, 3], 2.0: all_of_them, 2.5: all_of_them,
            3.0: [1, 2], 3.5: [1, 2], 4.0: all_of_them, 4.5: all_of_them, 5.0: all_of_them})
        kill, hang = ('[[events]]\nat_s = {}\nfault = { agent = 2, kind = "' + kind + '" }\n' for kind in ("kill", "hang"))
        restarts = CONSENSUS.replace("[run]\n", '[run]\non_agent_loss = "restart"\nrestart_after_s = 1.5\n')
        twice = self.counting(restarts + kill.replace("{}", "1.0") + hang.replace("{}", "3.0"))
        self.assertEqual([t_s for t_s, who in twice.items() if who != all_of_them], [1.0, 1.5, 2.0, 3.0, 3.5, 4.0])
        by_event = self.counting(restarts + kill.replace("{}", "1.0") + "[[events]]\nat_s = 2.0\nrestart = 2\n"
                                 + hang.replace("{}", "2.5"))
        self.assertEqual([t_s for t_s, who in by_event.items() if who != all_of_them], [1.0, 1.5, 2.5, 3.0, 3.5])
        nobody = "".join(f'[[events]]\nat_s = 1.0\nfault = {{ agent = {k}, kind = "kill" }}\n' for k in all_of_them)
        self.assertEqual(set(map(tuple, self.counting(CONSENSUS + nobody).values())), {(1, 2, 3)})

    def test_the_disagreement_is_of_those_who_count(self):
        states = arrays()
        states["position"][:, 2] = [100, 0, 1]
        axis = self.figure("disagreement", config=self.FAULTS, states=states).axes[0]
        p, largest = states["position"][:, :2, :2], self.lines(axis)["largest"].get_ydata()
        self.assertAlmostEqual(largest[35], np.linalg.norm(p[35, 0] - p[35, 1]) / 2)
        self.assertGreater(largest[25], 50)
        self.assertGreater(largest[45], 50)

    def test_the_hull_of_listed_leaders_is_drawn_at_the_end(self):
        config = '[law]\nname = "chase"\nguides = [1, 2, 3, 5]\n'
        states = arrays(agents=5)
        states["position"][-1] = [[0, 0, 1], [2, 0, 1], [1, 2, 1], [9, 9, 1], [1, 1, 1]]
        axis = self.figure("paths", config=config, states=states, summary={"drawing": {"hull": "guides"}}).axes[0]
        corners = axis.patches[0].get_xy()[:-1]  # without the first one again
        self.assertEqual(corners.tolist(), [[0, 0], [2, 0], [1, 2]])
        lines = self.lines(axis)
        self.assertEqual([lines[name].get_linewidth() for name in ("agent 1 (leader)", "agent 4")], [1.8 * 1.2, 1.2])
        self.assertIn("hull of leaders", axis.get_legend_handles_labels()[1])

    def test_the_hull_of_two_leaders_is_a_line(self):
        self.assertEqual(run_folder.hull(np.array([[1, 0], [0, 0]])).tolist(), [[0, 0], [1, 0]])

    def test_cells_divide_their_region_at_the_end(self):
        config = '[law]\nname = "chase"\nfield = [[0, 0], [4, 0], [4, 2], [0, 2]]\n'
        states = arrays(agents=2)
        states["position"][-1] = [[1, 1, 1], [3, 1, 1]]
        axis = self.figure("paths", config=config, states=states, summary={"drawing": {"cells": "field"}}).axes[0]
        found = [sorted(map(tuple, patch.get_xy()[:-1].tolist())) for patch in axis.patches]
        self.assertEqual(found, [[(0, 0), (0, 2), (2, 0), (2, 2)], [(2, 0), (2, 2), (4, 0), (4, 2)]])

    def test_disagreement_with_a_leader_is_the_distance_to_it(self):
        axis = self.figure("disagreement", config=LEADER).axes[0]
        self.assertEqual(axis.get_ylabel(), "distance to agent 2 (m)")
        self.assertNotIn("agent 2 (leader)", self.lines(axis))
        np.testing.assert_allclose(self.lines(axis)["largest"].get_ydata()[0], 5 * np.sqrt(3), rtol=1e-12)

    def test_tracking_is_relative_to_the_parent_in_the_tree(self):
        figure = self.figure("tracking", config=MINMAX, summary=PATH)
        x, y, v_x, _ = figure.axes
        self.assertEqual(x.get_ylabel(), "x relative to parent (m)")
        self.assertEqual(v_x.get_ylabel(), "$v_x$ relative to parent (m/s)")
        p = arrays()["position"]
        np.testing.assert_array_equal(self.lines(x)["agent 3"].get_ydata(), p[:, 2, 0] - p[:, 1, 0])
        self.assertNotIn("agent 1 (root)", self.lines(y))

    def test_the_tree_takes_the_lowest_parent_one_level_up(self):
        edges = [[2, 1, 1], [3, 1, 1], [4, 3, 1], [4, 2, 1], [3, 4, 1], [2, 3, 1]]
        self.write(MINMAX, {"graph": {"edges": edges}}, arrays(agents=4))
        self.assertEqual(run_folder.spanning_tree(run_folder.read_run(self.folder)), [(1, 0), (2, 0), (3, 1)])

    def test_a_waypoint_is_left_after_dwelling_within_its_radius(self):
        states = arrays(agents=1, rows=21)
        states["position"][:] = [0, 0, 1]
        states["position"][5:] = [4, 0.1, 1]  # arrives at 0.5 s and dwells 0.5 s
        self.write(WAYPOINT, states=states)
        targets = run_folder.waypoint_targets(run_folder.read_run(self.folder), 0)
        np.testing.assert_array_equal(targets[:10], np.tile([4, 0, 1], (10, 1)))
        np.testing.assert_array_equal(targets[10:], np.tile([4, 4, 1], (11, 1)))

    def test_timed_waypoints_begin_at_their_times(self):
        self.write(WAYPOINT.replace("dwell_s = 0.5", "times_s = [1, 2]"), states=arrays(agents=1))
        run = run_folder.read_run(self.folder)
        targets = run_folder.waypoint_targets(run, 0)
        np.testing.assert_array_equal(targets[9], run.position[0, 0])
        np.testing.assert_array_equal(targets[10], [4, 0, 1])
        np.testing.assert_array_equal(targets[20], [4, 4, 1])

    def test_agents_are_named_in_a_legend_and_many_by_a_colour_bar(self):
        legend = self.figure("paths", config=LEADER).legends[0]
        names = [text.get_text() for text in legend.get_texts()]
        self.assertEqual(names, ["agent 1", "agent 2 (leader)", "agent 3", "start", "end"])
        several = self.figure("position", states=arrays(agents=figure_style.LOOKS_MAX))
        self.assertEqual(len(several.legends[0].get_texts()), figure_style.LOOKS_MAX)
        many = self.figure("position", states=arrays(agents=50))
        self.assertEqual(many.legends, [])
        self.assertEqual(many.axes[-1].get_ylabel(), "agent")

    def test_no_two_agents_look_alike_and_ten_differ_in_colour(self):
        for agents in (1, 8, 9, 10, 11, 36, 37, 50, 100):
            with self.subTest(agents=agents):
                looks = figure_style.looks(agents)
                self.assertEqual(len(set(map(str, looks))), agents)
                self.assertEqual(all(colour in figure_style.COLOURS for colour, _ in looks), agents <= 36)
                self.assertNotIn(figure_style.DASHED, [line for _, line in looks], "dashes are those of liars")
                self.assertEqual(len(set(map(str, figure_style.fills(agents)))), agents)
        self.assertEqual({line for _, line in figure_style.looks(10)}, {"-"})
        lines = self.lines(self.figure("position", states=arrays(agents=11)).axes[0])
        self.assertEqual(lines["agent 1"].get_color(), lines["agent 10"].get_color())
        self.assertEqual([lines[f"agent {k}"].get_linestyle() for k in (1, 10)], ["-", ":"])

    def test_the_graph_and_the_prediction_are_drawn(self):
        summary = PATH | {"consensus": {"settling_time_s": None, "predicted": {"value_m": [1, 2, 3]}}}
        axis = self.figure("paths", summary=summary).axes[0]
        self.assertEqual(len(axis.collections[0].get_segments()), 2)  # two pairs that hear each other
        self.assertEqual([c for c in axis.collections if isinstance(c, Quiver)], [])
        self.assertEqual([list(d) for d in self.lines(axis)["predicted"].get_data()], [[1], [2]])

    def test_an_edge_in_one_direction_is_an_arrow_to_who_hears(self):
        edges = [[1, 2, 1.0], [2, 1, 1.0], [3, 1, 1.0]]  # 3 hears 1, and not the other way round
        axis = self.figure("paths", summary={"graph": {"edges": edges}}).axes[0]
        self.assertEqual(len(axis.collections[0].get_segments()), 2)
        (arrows,) = (c for c in axis.collections if isinstance(c, Quiver))
        start = arrays()["position"][0, :, :2]  # the agents end close together: the graph is where they start
        way = start[2] - start[0]
        np.testing.assert_allclose([arrows.U[0], arrows.V[0]], way / np.linalg.norm(way))
        np.testing.assert_allclose(arrows.XY[0], start[0] + 0.62 * way)
        self.assertLessEqual({"hear each other", "arrow to who hears"}, self.lines(axis).keys())


class Graphs(PlotTest):
    """The picture of who hears whom, and when."""

    A, B = [[1, 2, 1.0], [2, 1, 1.0]], [[3, 2, 1.0]]
    TWO = {"graph": {"edges": A + B, "schedule": [{"at_s": 0, "edges": A}, {"at_s": 1.5, "edges": B}]}}

    EVENTS = CONSENSUS + ('[[events]]\nat_s = 1.0\ncut = [[1, 2]]\n[[events]]\nat_s = 2.0\nmend = [[1, 2]]\n'
                          '[[events]]\nat_s = 3.0\ngraph = { edges = [[3, 2]] }\n'
                          '[[events]]\nat_s = 9.0\ncut = [[3, 2]]\n')

    def titles(self, figure):
        return [axis.get_title() for axis in figure.axes]

    def test_a_graph_that_stays_has_one_panel(self):
        self.assertEqual(self.titles(self.figure("graph", summary=PATH)), ["at any time"])

    def test_each_distinct_graph_has_a_panel_with_its_times(self):
        figure = self.figure("graph", summary=self.TWO)
        self.assertEqual(self.titles(figure), ["0 to 1.5 s", "1.5 to 5 s"])
        self.assertEqual([sum(isinstance(c, Quiver) for c in axis.collections) for axis in figure.axes], [0, 1])
        figure = self.figure("graph", summary=self.TWO, config=CONSENSUS + "[graph]\nrepeat_s = 2.0\n")
        self.assertEqual(self.titles(figure), ["0 to 1.5 s\nof each 2 s", "1.5 to 2 s\nof each 2 s"])
        figure = self.figure("graph", summary=PATH, config=CONSENSUS + "[graph]\nrange_m = 2.5\n")
        self.assertEqual(self.titles(figure), ["at any time\nwithin 2.5 m"])

    def test_events_change_the_graph(self):
        figure = self.figure("graph", summary=PATH, config=self.EVENTS)
        self.assertEqual(self.titles(figure), ["0 to 1 s, 2 to 3 s", "1 to 2 s", "3 to 5 s"])
        run = run_folder.read_run(self.folder)
        whole = set(run.edges)
        self.assertEqual([set(edges) for _, _, edges in run.graphs], [whole, whole - {(0, 1)}, whole, {(2, 1)}])

    def test_a_graph_that_repeats_goes_on_between_events(self):
        config = CONSENSUS + ("[graph]\nrepeat_s = 2.0\n[[events]]\nat_s = 3.0\ncut = [[3, 2], [1, 2]]\n"
                              "[[events]]\nat_s = 4.5\ncut = [[2, 1]]\n")
        self.write(config, self.TWO)
        a, b, less = {(0, 1), (1, 0)}, {(2, 1)}, {(1, 0)}
        self.assertEqual([(begin, end, set(edges)) for begin, end, edges in run_folder.read_run(self.folder).graphs],
                         [(0, 1.5, a), (1.5, 2, b), (2, 3, a), (3, 3.5, less), (3.5, 4, set()), (4, 4.5, less), (4.5, 5, set())])

    def test_at_most_twelve_graphs_are_drawn(self):
        phases = [{"at_s": 0.25 * k, "edges": [[k % 5 + 1, k // 5 + 6, 1.0]]} for k in range(20)]
        figure = self.figure("graph", states=arrays(agents=9), summary={
            "graph": {"edges": [edge for phase in phases for edge in phase["edges"]], "schedule": phases}})
        self.assertEqual(len(figure.axes), 12)
        self.assertIn("(12 of 20 graphs)", figure._suptitle.get_text())

    def test_circles_are_whole(self):
        for size in figure_style.SIZES:
            for summary, config in ((PATH, CONSENSUS), (self.TWO, CONSENSUS), (PATH, self.EVENTS)):
                figure = self.figure("graph", summary=summary, config=config, size=size)
                figure.canvas.draw()
                for axis in figure.axes:
                    panel = axis.get_window_extent()
                    for line in axis.get_lines():
                        if line.get_marker() != "o":
                            continue
                        (x, y), radius = axis.transData.transform(line.get_xydata()[0]), line.get_markersize() / 72 * figure.dpi / 2
                        self.assertTrue(panel.x0 <= x - radius and x + radius <= panel.x1, size)
                        self.assertTrue(panel.y0 <= y - radius and y + radius <= panel.y1, size)
                plot.plt.close(figure)

    def test_agents_have_their_numbers_if_there_is_room(self):
        for agents, numbers in ((10, 10), (200, 0)):
            figure = self.figure("graph", states=arrays(agents, 2), summary=PATH)
            self.assertEqual(len(figure.axes[0].texts), numbers)


class Changes(PlotTest):
    """Phases of [[law.schedule]], events, and commands that law.safety changed."""

    PHASES = ('[law]\nname = "chase"\nleader = 1\n[[law.schedule]]\nat_s = 2.0\nname = "chase"\nleader = 3\n'
              '[[law.schedule]]\nat_s = 4.0\nname = "flee"\nleader = 0\n')
    TOLD = {"phases": [{"at_s": at_s, "law": law, "drawing": AGREEMENT, "consensus": {"settling_time_s": settled_s}}
                       for at_s, law, settled_s in ((0, "chase", 1.5), (2, "chase", None), (4, "flee", 0.5))]}

    def marks(self, axis):
        return [text.get_text() for text in axis.texts]

    def vertical(self, axis):
        return sorted(line.get_xdata()[0] for line in axis.get_lines() if list(line.get_ydata()) == [0, 1]
                      and line.get_xdata()[0] == line.get_xdata()[1])

    def test_disagreement_is_seen_from_the_leader_of_each_phase(self):
        axis = self.figure("disagreement", config=self.PHASES, summary=self.TOLD).axes[0]
        p, t = arrays()["position"][:, :, :2], arrays()["t"]
        lines = {line.get_label(): line.get_ydata() for line in axis.get_lines()}
        for rows, reference, leader in ((t < 2, p[:, 0], 0), ((t >= 2) & (t < 4), p[:, 2], 2),
                                        (t >= 4, p.mean(axis=1), None)):
            for k in range(3):
                expected = np.linalg.norm(p[rows, k] - reference[rows], axis=1)
                found = lines[f"agent {k + 1}"][rows]
                if k == leader:
                    self.assertTrue(np.isnan(found).all(), "a leader is not far from itself")
                else:
                    np.testing.assert_allclose(found, expected, rtol=1e-12)
        self.assertEqual(self.marks(axis), ["chase, to agent 1", "leader = 3, to agent 3", "flee, to the mean"])
        self.assertEqual(axis.get_ylabel(), "distance to the mean or the leader (m)")
        self.assertLessEqual({"settled at 1.50 s", "settled at 4.50 s"}, lines.keys())

    def test_a_phase_whose_law_does_not_agree_has_no_disagreement(self):
        first, _, last = self.TOLD["phases"]
        self.write(self.PHASES, {"phases": [first, {"at_s": 2, "law": "chase", "drawing": FLIGHT}, last]})
        distance = run_folder.disagreement(run_folder.read_run(self.folder))
        self.assertEqual([np.isnan(distance[row]).all() for row in (0, 19, 20, 39, 40, 50)],
                         [False, False, True, True, False, False])

    def test_phases_and_events_are_marked_and_named(self):
        config = self.PHASES + ('[[events]]\nat_s = 1.0\nset = { "law.p_gain" = 0.25 }\nagents = [1, 2]\n'
                                '[[events]]\nat_s = 3.0\ngoto = { agent = 3, position_m = [1, 2, 3] }\n'
                                '[[events]]\nat_s = 3.0\ncut = [[1, 2], [2, 1], [3, 1]]\n'
                                '[[events]]\nat_s = 3.5\nmend = [[1, 2]]\n'
                                '[[events]]\nat_s = 4.5\ngraph = { edges = [] }\n'
                                '[[events]]\nat_s = 8.0\nset = { "law.p_gain" = 1 }\n')
        for name in ("position", "velocity", "acceleration"):
            axes = self.figure(name, config=config, summary=self.TOLD).axes
            self.assertEqual(self.marks(axes[0]), [
                "chase", "leader = 3", "flee", "p_gain = 0.25, of 1, 2", "goto 3, cut 1,2 and 2 more", "mend 1,2",
                "another graph"])
            for axis in axes:
                self.assertEqual(self.vertical(axis), [1, 2, 3, 3.5, 4, 4.5])

    def test_faults_and_fresh_starts_are_marked_and_named(self):
        config = CONSENSUS.replace("[run]\n", '[run]\non_agent_loss = "restart"\nrestart_after_s = 0.5\n') + (
            '[[events]]\nat_s = 1.0\nfault = { agent = 2, of = "agent", kind = "kill" }\n'
            '[[events]]\nat_s = 2.0\nrestart = 3\n'
            '[[events]]\nat_s = 3.0\nfault = { agent = 1, of = "motor", kind = "off", motor = 2 }\n')
        axis = self.figure("velocity", config=config).axes[0]
        self.assertEqual(self.marks(axis), ["kill 2", "restart 2", "restart 3", "motor off 1"])
        self.assertEqual(self.vertical(axis), [1, 1.5, 2, 3])

    def test_phases_are_called_by_what_changed(self):
        first = {"name": "chase", "at_s": 0, "beta": 1.0, "gains": [1], "leader": 0, "axes": "xy"}
        for change, words in (({"beta": 2.0}, "beta = 2"), ({"axes": "xyz", "leader": 1}, "leader = 1, axes = xyz"),
                              ({"gains": [2]}, "gains"), ({"beta": 3, "leader": 2, "axes": "xyz"}, "beta = 3, leader = 2 and 1 more"),
                              ({"slack_m": 0.5}, "slack_m = 0.5"), ({"name": "flee", "beta": 9}, "flee"), ({}, "")):
            self.assertEqual(run_folder.words_of_change(first, first | change | {"at_s": 5}), words)
        self.assertEqual(run_folder.words_of_change(first | {"slack_m": 1}, first), "no slack_m")
        config = CONSENSUS + "".join(f"[[law.schedule]]\nat_s = {at_s}\nname = 'consensus'\n{more}" for at_s, more in
                                     ((1, "p_gain = 2\n"), (2, "p_gain = 2\n")))
        told = {"phases": [{"at_s": at_s, "law": "consensus", "drawing": AGREEMENT} for at_s in range(3)]}
        self.assertEqual(self.marks(self.figure("velocity", config=config, summary=told).axes[0]),
                         ["consensus", "p_gain = 2", "the same again"])

    def test_phases_of_the_graph_are_called_by_their_topology(self):
        phases = "".join(f"[[graph.schedule]]\nat_s = {at_s}\n{graph}\n" for at_s, graph in
                         ((1, 'topology = "ring"'), (3, "edges = [[1, 2]]"), (9, 'topology = "path"')))
        axis = self.figure("velocity", config=CONSENSUS + '[graph]\ntopology = "complete"\n' + phases).axes[0]
        self.assertEqual((self.marks(axis), self.vertical(axis)), (["topology = ring", "another graph"], [1, 3]))
        repeats = self.figure("velocity", config=CONSENSUS + "[graph]\nrepeat_s = 4.0\n" + phases).axes[0]
        self.assertEqual((self.marks(repeats), self.vertical(repeats)), ([], []))

    def test_an_event_a_phase_and_a_time_that_was_measured_look_different(self):
        axis = self.figure("disagreement", config=self.PHASES + "[[events]]\nat_s = 1.0\ncut = [[1, 2]]\n",
                           summary=self.TOLD).axes[0]
        lines = {line.get_xdata()[0]: line for line in axis.get_lines() if list(line.get_ydata()) == [0, 1]}
        event, phase, settled = (lines[at_s] for at_s in (1, 2, 1.5))
        self.assertEqual(len({str(line._dash_pattern) for line in (event, phase, settled)}), 3)
        self.assertEqual([line.get_marker() for line in (event, phase, settled)], ["None", "None", "^"])

    def test_no_line_is_drawn_at_two_percent_of_the_start_of_a_leader_that_departs(self):
        def levels(axis):
            return [line.get_segments()[0][0][1] for line in axis.collections if len(line.get_segments()) == 1]
        states = arrays()
        states["position"][:, 0, :2] = [1, 2]  # agent 1 stays
        self.assertEqual(len(levels(self.figure("disagreement", config=CONSENSUS + "leader = 1\n", states=states).axes[0])), 1)
        states["position"][:, 0, 0] += np.linspace(0, 3, 51)  # by 3 m, and all others started 5 m away
        told = {"consensus": {"settling_time_s": 2.0}}
        axis = self.figure("disagreement", config=CONSENSUS + "leader = 1\n", states=states, summary=told).axes[0]
        self.assertEqual(levels(axis), [])
        self.assertEqual([name for name in axis.get_legend_handles_labels()[1] if "settled" in name or "%" in name], [])

    def test_names_of_changes_do_not_cover_each_other(self):
        events = "".join(f'[[events]]\nat_s = {at_s}\nset = {{ "law.a_long_name" = 1 }}\n'
                         for at_s in (0.1, 0.5, 2.1, 2.2, 4.9))
        for size in figure_style.SIZES:
            with self.subTest(size=size), laid_out(dpi=100):
                self.write(self.PHASES + events, self.TOLD)
                figure_style.use(size)
                figure = pictures.PICTURES["velocity"].draw(run_folder.read_run(self.folder))
                figure.canvas.draw()
                boxes = [text.get_window_extent() for text in figure.axes[0].texts]
                self.assertEqual(len(boxes), 8)
                for k, box in enumerate(boxes):
                    self.assertEqual([other for other in boxes[:k] if box.overlaps(other)], [])

    def test_a_crowd_of_events_leaves_room_for_the_panels(self):
        events = "".join(f'[[events]]\nat_s = {k / 50}\nset = {{ "law.p_gain" = {k} }}\n' for k in range(1, 200))
        figure = self.figure("velocity", config=CONSENSUS + events)
        self.assertEqual(len(self.vertical(figure.axes[0])), 199)
        self.assertLess(len(self.marks(figure.axes[0])), 60)
        self.assertLess(figure.get_figheight(), 9)

    def test_commands_that_the_safety_filter_changed_are_drawn(self):
        states = arrays()
        states["flags"] = np.zeros((51, 3))
        self.write(states=states)
        self.assertEqual(self.run_plot("--only", "safety")[0], 2, "it changed none")
        states["flags"][10:20, 1] = 16 + 1
        states["flags"][15:17, 1] += 32
        states["flags"][50, 2] = 16
        config = CONSENSUS + "[law.safety]\ndistance_m = 1.5\n"
        near, when = self.figure("safety", config=config, states=states).axes
        bars = [[path.get_extents().bounds for path in bars.get_paths()] for bars in when.collections]
        bars = [of_agent for of_agent in bars if of_agent]
        np.testing.assert_allclose(bars, [[(1, 1.6, 1, 0.8)], [(5, 2.6, 0.1, 0.8)], [(1.5, 1.6, 0.2, 0.8)]])
        lines = {line.get_label(): line.get_ydata() for line in near.get_lines()}
        np.testing.assert_allclose(lines["smallest distance"], 5 * np.sqrt(3) * np.exp(-arrays()["t"]))
        self.assertEqual(lines["to be kept: 1.5 m"][0], 1.5)

    EVENTS = ('t_s,until_s,what,count,agent,with,detail\n'
              '0,0.5,tilt_limit,6,2,,\n'
              '1,1,contact,1,1,agent 3,2.5 m/s\n'
              '2,2,contact,1,2,obstacle 1,0.5 m/s\n'
              '2.5,2.5,event,1,,event 1,"set = { ""law.p_gain"" = 2.0 }"\n'
              '3,4,tilt_limit,9,2,,\n')

    def test_what_the_run_came_up_against_is_drawn_for_those_whom_it_concerns(self):
        (self.folder / "events.csv").write_text(self.EVENTS)
        axis, = self.figure("incidents").axes
        self.assertEqual([label.get_text() for label in axis.get_yticklabels()], ["tilt limit", "contact"])
        boxes, moments = axis.collections
        lane = 0.8 / 3
        low = -0.4 + lane  # of agent 2 in the first row
        np.testing.assert_allclose([path.get_extents().bounds for path in boxes.get_paths()],
                                   [(0, low, 0.6, lane), (1, 0.6, 0.1, lane), (1, 0.6 + 2 * lane, 0.1, lane),
                                    (2, 0.6 + lane, 0.1, lane), (3, low, 1.1, lane)])
        self.assertEqual(len(moments.get_paths()), 0, "a tick is two per cent of this run")
        self.assertEqual(axis.get_legend_handles_labels()[1], ["agent 1", "agent 2", "agent 3"])

    def test_bars_of_more_agents_than_there_are_colours_have_those_of_a_colour_bar(self):
        (self.folder / "events.csv").write_text(self.EVENTS)
        named, = self.figure("incidents", states=arrays(agents=10)).legends
        self.assertEqual([text.get_text() for text in named.get_texts()], ["agent 1", "agent 2", "agent 3"])
        figure = self.figure("incidents", states=arrays(agents=11))
        self.assertEqual((figure.legends, figure.axes[-1].get_ylabel()), ([], "agent"))

    def test_contacts_are_marked_where_they_were(self):
        (self.folder / "events.csv").write_text(self.EVENTS)
        axis, = self.figure("paths").axes
        stars, = [marks for marks in axis.collections if marks.get_label() == "contact"]
        p = arrays()["position"][:, :, :2]
        np.testing.assert_allclose(stars.get_offsets(), [p[10, 0], p[10, 2], p[20, 1]])

    def test_no_picture_is_drawn_of_what_only_the_start_brings(self):
        for text in ("", "t_s,until_s,what,count,agent,with,detail\n0,0.9,rotor_limit,6,2,,\n"):
            self.write()
            (self.folder / "events.csv").write_text(text)
            self.check(2, "--only incidents: it needs an events.csv in which something happened after the first second", "--only", "incidents")

    def test_a_damaged_table_is_said(self):
        self.write()
        for text in (b"t_s,until_s,what,count,agent,with,detail\nsoon,1,contact,1,1,ground,\n", b"a,b\n1,2\n", b"\xff"):
            (self.folder / "events.csv").write_bytes(text)
            code, errors = self.run_plot()
            self.assertEqual((code, errors), (1, f"error: {self.folder / 'events.csv'}: damaged, or not a table of events\n"))


class Paper(PlotTest):
    """Pictures at true size."""

    POINTS = {"column": 252, "page": 515.52}

    def test_pages_are_as_wide_as_asked_with_embedded_fonts_and_without_dates(self):
        for size, wide in self.POINTS.items():
            with self.subTest(size=size):
                self.write(LEADER, PATH)
                options = ("--only", "disagreement", "--size", size, "--format", "svg,pdf")
                self.assertEqual(self.run_plot(*options), (0, ""))
                pdf, svg = ((self.folder / f"disagreement.{ending}").read_bytes() for ending in ("pdf", "svg"))
                box = re.search(rb"/MediaBox \[ 0 0 ([\d.]+) ([\d.]+) \]", pdf)
                self.assertAlmostEqual(float(box[1]), wide)
                self.assertIn(f'width="{wide}pt"'.encode(), svg)
                self.assertIn(b"/FontFile2", pdf)
                self.assertNotIn(b"/Type3", pdf)
                self.assertEqual(re.findall(rb"Date|dc:date|Matplotlib v", pdf + svg), [])
                self.run_plot(*options)
                self.assertEqual((self.folder / "disagreement.pdf").read_bytes(), pdf)
                self.assertEqual((self.folder / "disagreement.svg").read_bytes(), svg)
        self.assertEqual(self.pictures(), [], "PNG was not asked for")

    def test_letters_are_of_8_points_and_there_is_no_title(self):
        config, summary = Changes.PHASES, Changes.TOLD | PATH
        for name in ("paths", "acceleration", "disagreement", "graph"):
            self.write(config, summary)
            figure_style.use("column")
            figure = pictures.PICTURES[name].draw(run_folder.read_run(self.folder))
            self.assertIsNone(figure._suptitle)
            sizes = {text.get_fontsize() for text in figure.findobj(matplotlib.text.Text) if text.get_text()}
            self.assertEqual(sizes, {8.0}, name)

    def test_nothing_is_clipped_or_covered(self):
        with laid_out():
            self.write(Graphs.EVENTS, PATH)
            for size in figure_style.SIZES:
                self.assertEqual(self.clipped("graph", size), [], "three panels")
            for agents, names in ((3, ("paths", "disagreement")), (10, ("paths", "graph")), (28, ("paths", "velocity")),
                                  (50, ("disagreement", "graph"))):
                edges = [[k, k % agents + 1, 1.0] for k in range(1, agents + 1)]
                self.write(Changes.PHASES, Changes.TOLD | {"graph": {"edges": edges}}, arrays(agents, 51))
                for name in names:
                    for size in ("column", "screen" if agents == 50 else "page")[:1 if agents < 28 else 2]:
                        with self.subTest(agents=agents, size=size, name=name):
                            self.assertEqual(self.clipped(name, size), [])

    def test_the_last_label_of_time_is_on_the_page(self):
        states = arrays(6, 201)  # 20 s: with steps of 2.5 s the last label is wide
        self.write(states=states | {"acceleration_command": 0 * states["velocity"]})
        with laid_out(dpi=100):
            self.assertEqual(self.clipped("acceleration", "column"), [])

    def test_a_long_label_is_broken(self):
        offsets = [[0, 0, 0], [3, 0, 0], [0, 4, 0]]
        told = {"phases": [phase | {"formation": {"offsets_m": offsets}} for phase in Changes.TOLD["phases"]]}
        with laid_out():
            self.write(Changes.PHASES, told)
            self.assertEqual(self.clipped("disagreement", "column"), [])
            figure = pictures.PICTURES["disagreement"].draw(run_folder.read_run(self.folder))
            self.assertEqual(figure.axes[0].get_ylabel().replace("\n", " "),
                             "distance from its place, seen from the mean or the leader (m)")
            self.assertIn("\n", figure.axes[0].get_ylabel())

    def test_pictures_go_where_they_are_asked_to(self):
        self.write()
        out = self.folder.parent / "for/the paper"
        self.assertEqual(self.run_plot("--only", "paths", "--format", "png,pdf", "--out", str(out)), (0, ""))
        self.assertEqual(sorted(path.name for path in out.iterdir()), ["paths.pdf", "paths.png"])
        self.assertEqual(self.pictures(), [])


class Options(PlotTest):
    """--style, --agents, --from-s, --to-s, --label, and the formats that are text."""

    def figure_with(self, name, *options, **what):
        """The figure that these options make of a picture."""
        self.write(**what)
        finished = {}
        with mock.patch.object(plot, "finish", lambda figure, folder, made, formats, keep: finished.update({made: figure})):
            self.assertEqual(self.run_plot("--only", name, *options), (0, ""))
        return finished[name]

    def table(self, name, *options, **what):
        """{header: cells} of the CSV of a picture, without the empty cells after each column's end."""
        self.write(**what)
        self.assertEqual(self.run_plot("--only", name, "--format", "csv", *options), (0, ""))
        with (self.folder / f"{name}.csv").open(newline="") as file:
            header, *rows = csv.reader(file)
        columns = {}
        for title, cells in zip(header, zip(*rows)):
            while cells and not cells[-1]:
                cells = cells[:-1]
            columns[title] = list(cells)
        self.assertEqual(len(columns), len(header), "no header stands twice")
        return columns

    def lines(self, axis):
        return {line.get_label(): line for line in axis.get_lines()}

    def sheet(self, text):
        path = self.folder.parent / "mine.mplstyle"
        path.write_text(text)
        return path

    # --- --style

    def test_a_style_sheet_goes_before_our_style_and_its_colours_are_those_of_agents(self):
        sheet = self.sheet('# mine\nlines.linewidth: 3  # bold\naxes.prop_cycle: cycler("color", ["#111111", "777777"])\n'
                           'axes.grid: False\naxes.facecolor: "#eeeeee"\n\n')
        figure = self.figure_with("position", "--style", str(sheet))
        lines = self.lines(figure.axes[0])
        self.assertEqual([lines[f"agent {k}"].get_linewidth() for k in (1, 3)], [3, 3 * 1.3])
        self.assertEqual([lines[f"agent {k}"].get_color() for k in (1, 2, 3)], ["#111111", "#111111", "#111111"])
        self.assertEqual([lines[f"agent {k}"].get_linestyle() for k in (1, 2, 3)], ["-", ":", "-."])
        self.assertEqual(figure.axes[0].get_facecolor()[:3], (0xee / 255,) * 3)
        two = self.figure_with("position", "--style", str(sheet), states=arrays(2))
        self.assertEqual([line.get_color() for line in two.axes[0].get_lines()], ["#111111", "#777777"])
        usual = self.lines(self.figure_with("position").axes[0])["agent 1"]
        self.assertEqual((usual.get_linewidth(), usual.get_color()), (1.2, figure_style.OKABE_ITO[0]), "the next picture is ours")

    def test_a_style_of_matplotlib_has_a_name_and_letters_can_be_read_on_its_ground(self):
        figure = self.figure_with("disagreement", "--style", "dark_background")
        self.assertEqual(figure.axes[0].get_facecolor(), (0, 0, 0, 1))
        np.testing.assert_allclose(matplotlib.colors.to_rgb(self.lines(figure.axes[0])["largest"].get_color()), [0.9] * 3)
        self.assertEqual(figure_style.grey(0.3), (0.7,) * 3)
        figure_style.use("screen")
        self.assertEqual(figure_style.grey(0.3), (0.3,) * 3)

    def test_a_style_keeps_sizes_and_bytes(self):
        self.write()
        options = ("--only", "velocity", "--format", "svg", "--size", "column", "--style", "ggplot")
        self.assertEqual(self.run_plot(*options), (0, ""))
        first = (self.folder / "velocity.svg").read_bytes()
        self.assertIn(b'width="252pt"', first)
        self.run_plot(*options)
        self.assertEqual((self.folder / "velocity.svg").read_bytes(), first)

    def test_a_style_that_is_not_there_or_says_nonsense(self):
        self.write()
        names = ", ".join(style_sheet.names())
        self.check(2, f"--style: expected a file FILE.mplstyle or a style of matplotlib ({names}), got 'gplot' (did you mean "
                      "\"ggplot\"?)", "--style", "gplot")
        self.check(2, f"{self.folder}/my.mplstyle: no such file", "--style", f"{self.folder}/my.mplstyle")
        self.check(2, f"{self.folder}: Is a directory", "--style", str(self.folder))
        for text, message in (
                ("lines.linewdth: 2\n", '1: lines.linewdth: unknown key (did you mean "lines.linewidth"?)'),
                ("# a\n\nlines.linewidth: thick\n", "3: lines.linewidth: matplotlib takes no 'thick': Could not convert "
                                                     "'thick' to float"),
                ("backend: Agg\n", "1: backend: it says nothing about how a picture looks"),
                ("grid\n", "1: expected KEY: VALUE, got 'grid'")):
            sheet = self.sheet(text)
            self.check(2, f"{sheet}:{message}", "--style", str(sheet))
        sheet = self.sheet("text.usetex: True\n")
        with mock.patch.dict(os.environ, {"PATH": str(self.folder)}):
            self.check(2, f"{sheet}:1: text.usetex: it needs the program latex, which is not installed (Debian: apt-get install "
                          "texlive-latex-extra cm-super dvipng)", "--style", str(sheet))
        sheet.write_bytes(b"\xff")
        self.check(2, f"{sheet}: it is no text in UTF-8", "--style", str(sheet))

    # --- --agents

    def test_only_the_agents_that_it_names_are_drawn_in_the_colours_that_they_have_among_all(self):
        whole = self.lines(self.figure_with("position", states=arrays(5)).axes[0])
        for listed, names in (("1,4", (1, 4)), ("2-4", (2, 3, 4)), ("5,1-2,2", (1, 2, 5))):
            for name in ("position", "paths", "disagreement", "acceleration"):
                lines = self.lines(self.figure_with(name, "--agents", listed, states=arrays(5)).axes[0])
                self.assertEqual([label for label in lines if label.startswith("agent")], [f"agent {k}" for k in names])
                self.assertEqual(lines["agent 1" if 1 in names else "agent 2"].get_color(),
                                 whole["agent 1" if 1 in names else "agent 2"].get_color())
        p = arrays(5)["position"]
        marks = self.figure_with("paths", "--agents", "1,4", states=arrays(5)).axes[0].collections
        np.testing.assert_array_equal(marks[-1].get_offsets(), p[-1, [0, 3], :2])

    def test_edges_join_agents_that_are_drawn_and_the_largest_disagreement_is_that_of_all(self):
        axis = self.figure_with("paths", "--agents", "1,2", summary=PATH).axes[0]
        self.assertEqual(len(axis.collections[0].get_segments()), 1)
        states = arrays()
        states["position"][:, 2, :2] *= 3
        axis = self.figure_with("disagreement", "--agents", "1,2", states=states).axes[0]
        p = states["position"][0, :, :2]
        self.assertAlmostEqual(self.lines(axis)["largest"].get_ydata()[0], np.linalg.norm(p - p.mean(axis=0), axis=1).max())

    def test_of_many_agents_a_few_have_a_legend(self):
        figure = self.figure_with("velocity", "--agents", "7,60-61", states=arrays(100))
        self.assertEqual([text.get_text() for text in figure.legends[0].get_texts()], ["agent 7", "agent 60", "agent 61"])

    def test_lanes_and_contacts_are_those_of_the_agents_that_are_drawn(self):
        (self.folder / "events.csv").write_text(Changes.EVENTS)
        axis, = self.figure_with("incidents", "--agents", "1").axes
        self.assertEqual(axis.get_legend_handles_labels()[1], ["agent 1"])
        axis, = self.figure_with("paths", "--agents", "1").axes
        stars, = [marks for marks in axis.collections if marks.get_label() == "contact"]
        self.assertEqual(len(stars.get_offsets()), 1)

    def test_agents_that_are_not_there(self):
        self.write()
        expected = "--agents: expected numbers of agents and ranges of them, with commas between, such as 1,4 or 1-3"
        for text in ("one", "1,", "1-2-3", "-1", "1;2", "1.5"):
            self.check(2, f"{expected}, got '{text}'", f"--agents={text}")
        self.check(2, f"{expected}, got '3-1', which ends before it begins", "--agents", "1,3-1")
        self.check(2, f"--agents: {self.folder}: expected numbers from 1 to 3, got 4", "--agents", "1,4")
        self.check(2, f"--agents: {self.folder}: expected numbers from 1 to 3, got 9", "--agents", "1-9")

    # --- --from-s, --to-s

    def test_a_window_of_time_has_the_rows_within_it_and_what_is_measured_stays(self):
        window = ("--from-s", "1", "--to-s", "2.5")
        for name in ("position", "velocity", "acceleration", "disagreement"):
            axes = self.figure_with(name, *window).axes
            self.assertEqual(axes[-1].get_xlim(), (1, 2.5))
            np.testing.assert_allclose(self.lines(axes[0])["agent 1"].get_xdata(), np.arange(10, 26) / 10)
        axis = self.figure_with("disagreement", *window).axes[0]
        level, = [line.get_segments()[0] for line in axis.collections]
        np.testing.assert_allclose(level, [[1, 0.1], [2.5, 0.1]], err_msg="of the start of the run, not of the window")
        axis = self.figure_with("paths", *window).axes[0]
        p = arrays()["position"]
        np.testing.assert_array_equal([marks.get_offsets() for marks in axis.collections[-2:]], p[[10, 25], :, :2])
        self.assertLessEqual({"at 1 s", "at 2.5 s"}, self.lines(axis).keys())
        self.assertLessEqual({"start", "at 2.5 s"}, self.lines(self.figure_with("paths", "--to-s", "2.5").axes[0]).keys())

    def test_a_window_names_the_phase_in_which_it_begins_and_changes_within_it(self):
        config = Changes.PHASES + "".join(f"[[events]]\nat_s = {at_s}\ncut = [[1, {k}]]\n" for at_s, k in ((1, 2), (3, 3)))
        axis = self.figure_with("velocity", "--from-s", "2.5", config=config, summary=Changes.TOLD).axes[0]
        self.assertEqual([text.get_text() for text in axis.texts], ["leader = 3", "flee", "cut 1,3"])
        axis = self.figure_with("disagreement", "--to-s", "3", config=config, summary=Changes.TOLD).axes[0]
        named = axis.get_legend_handles_labels()[1]
        self.assertEqual([name for name in named if "settled" in name], ["settled at 1.50 s"])

    def test_a_window_shows_the_graphs_bars_and_incidents_within_it(self):
        figure = self.figure_with("graph", "--from-s", "2.5", summary=Graphs.TWO)
        self.assertEqual([axis.get_title() for axis in figure.axes], ["at any time"])
        figure = self.figure_with("graph", "--from-s", "1", "--to-s", "2", summary=Graphs.TWO)
        self.assertEqual([axis.get_title() for axis in figure.axes], ["1 to 1.5 s", "1.5 to 2 s"])
        states = arrays() | {"flags": np.zeros((51, 3))}
        states["flags"][[5, 20], 1] = 16
        _, when = self.figure_with("safety", "--from-s", "1", states=states).axes
        self.assertEqual([len(bars.get_paths()) for bars in when.collections], [0, 1, 0])
        (self.folder / "events.csv").write_text(Changes.EVENTS)
        axis, = self.figure_with("incidents", "--from-s", "1.5", "--to-s", "2.5").axes
        self.assertEqual(len(axis.collections[0].get_paths()), 1)

    def test_a_film_shows_the_window(self):
        self.write()
        run = run_folder.read_run(self.folder)
        run.from_s, run.to_s = 1, 3
        with mock.patch.object(animation, "encode") as encode:
            path = self.folder / "film.gif"
            animation.film(run, path, 1.0)
        self.assertEqual((encode.call_args.args[1][0], encode.call_args.args[1][-1]), (10, 30))

    def test_windows_that_are_none(self):
        self.write()
        self.check(2, "--from-s: expected a number of seconds, got 'soon'", "--from-s", "soon")
        self.check(2, "--to-s: expected a number of seconds, got 'nan'", "--to-s", "nan")
        self.check(2, "--to-s: expected a time after that of --from-s, 3 s, got 2", "--from-s", "3", "--to-s", "2")
        none = "expected a window of time with rows of the run, which is from 0 to 5 s, got"
        self.check(2, f"--from-s: {self.folder}: {none} 6", "--from-s", "6")
        self.check(2, f"--to-s: {self.folder}: {none} -1", "--to-s=-1")
        self.check(2, f"--from-s: {self.folder}: {none} 1.01 to 1.02", "--from-s", "1.01", "--to-s", "1.02")

    # --- --label

    def test_texts_are_called_otherwise_in_all_pictures_or_in_one(self):
        options = ("--label", "agent 2 (leader)=the \"scout\"", "--label", "time (s)=Zeit (s)", "--label", "velocity.agent 1=first")
        self.write(LEADER)
        finished = {}
        with mock.patch.object(plot, "finish", lambda figure, folder, name, formats, keep: finished.update({name: figure})):
            self.assertEqual(self.run_plot("--only", "position,velocity", *options), (0, ""))
        for name, first in (("position", "agent 1"), ("velocity", "first")):
            self.assertEqual([text.get_text() for text in finished[name].legends[0].get_texts()], [first, 'the "scout"', "agent 3"])
            self.assertEqual(finished[name].axes[-1].get_xlabel(), "Zeit (s)")

    def test_every_kind_of_text_may_be_another(self):
        events = "[[events]]\nat_s = 1.0\ncut = [[1, 2]]\n"
        (self.folder / "events.csv").write_text(Changes.EVENTS)
        for name, text in (("position", "demo: position"), ("position", "$v_x$ (m/s)"), ("velocity", "cut 1,2"), ("paths", "start"),
                           ("graph", "0 to 1 s"), ("disagreement", "distance to the mean (m)"), ("incidents", "contact"),
                           ("acceleration", "limit ±3 m/s², out of view"), ("safety", "smallest distance")):
            with self.subTest(text=text):
                states = arrays() | {"flags": np.full((51, 3), 16)}
                if text.startswith("$"):
                    name = "velocity"
                if text.startswith("limit"):
                    states["acceleration_command"] *= 0.1
                figure = self.figure_with(name, "--label", f"{text}=another = text", config=CONSENSUS + events, summary=PATH,
                                          states=states)
                figure.draw_without_rendering()
                shown = {found.get_text() for found in figure.findobj(matplotlib.text.Text)}
                self.assertIn("another = text", shown)
                self.assertNotIn(text, shown)

    def test_a_long_text_is_broken_and_its_legend_has_room(self):
        with laid_out():
            self.write()
            figure_style.use("column", wording=wording.Wording({"agent 1": "the agent that was the first one", "distance to the mean (m)":
                                                                "how far apart from all of the others together this one is (m)"}))
            figure = pictures.PICTURES["disagreement"].draw(run_folder.read_run(self.folder))
            figure.canvas.draw()
            self.assertIn("\n", figure.axes[0].get_ylabel())
            box = figure.legends[0].get_window_extent()
            self.assertGreaterEqual(box.x0, -1)
            self.assertLessEqual(box.x1, figure.bbox.width + 1)

    def test_a_text_that_is_in_no_picture_is_refused_before_one_is_written(self):
        self.write()
        for key, near in (("agnet 1", 'agent 1'), ("velocity.agent 1", "position.agent 1")):
            self.check(2, f"--label: '{key}' is no text of the pictures (did you mean \"{near}\"?)", "--only", "position",
                       "--label", f"{key}=x")
        self.check(2, "--label: 'qqqq' is no text of the pictures", "--label", "qqqq=x")
        self.assertEqual(self.pictures(), [])
        self.check(2, "--label: 'qqqq' is no text of the pictures", "--label", "qqqq=x", "--animate", f"{self.folder}/film.gif")
        self.check(2, "--label: expected KEY=TEXT, got 'agent 1'", "--label", "agent 1")
        self.check(2, "--label: expected KEY=TEXT, got '=x'", "--label", "=x")
        self.check(2, "--label: expected another text for 'agent 1' once, got 2", "--label", "agent 1=a", "--label", "agent 1=b")

    # --- --format csv

    def test_a_table_has_what_was_drawn_with_names_and_units(self):
        table = self.table("position")
        self.assertEqual(list(table), ["time (s)", *(f"agent {k}: {axis} (m)" for axis in "xyz" for k in (1, 2, 3))])
        self.assertEqual([float(cell) for cell in table["agent 2: y (m)"]], arrays()["position"][:, 1, 1].tolist(), "to the bit")
        self.assertEqual([float(cell) for cell in table["time (s)"]], arrays()["t"].tolist())
        table = self.table("velocity", "--agents", "3", "--from-s", "1", "--to-s", "2", "--label", "agent 3=last")
        self.assertEqual(list(table), ["time (s)", "last: v_x (m/s)", "last: v_y (m/s)", "last: v_z (m/s)"])
        self.assertEqual(len(table["time (s)"]), 11)

    def test_the_table_of_paths_has_edges_marks_and_areas(self):
        config = CONSENSUS + '[[physics.obstacles]]\nshape = "box"\nposition_m = [1, 2, 0]\nsize_m = [2, 4, 1]\n'
        table = self.table("paths", config=config, summary=PATH)
        self.assertEqual([table["edge: agent"], table["edge: hears agent"]], [["1", "2", "2", "3"], ["2", "1", "3", "2"]])
        self.assertEqual(sorted(map(float, table["obstacle 1: y, north (m)"])), [0, 0, 0, 4, 4])
        self.assertEqual(len(table["agent 3: x, east (m)"]), 51)

    def test_the_table_of_disagreement_ends_where_curves_do_and_has_lines_and_changes(self):
        table = self.table("disagreement", config=Changes.PHASES, summary=Changes.TOLD)
        to = "distance to the mean or the leader (m)"
        self.assertAlmostEqual(float(table[f"2 % of the start: {to}"][0]), 0.02 * 5 * np.sqrt(3))
        self.assertEqual(table["settled at 1.50 s: time (s)"], ["1.5"])
        self.assertEqual(list(zip(table["change: time (s)"], table["change"])),
                         [("0.0", "chase, to agent 1"), ("2.0", "leader = 3, to agent 3"), ("4.0", "flee, to the mean")])
        self.assertEqual(table[f"agent 1: {to}"][:20], [""] * 20, "a leader is not far from itself")
        table = self.table("disagreement", states=arrays(rows=301))
        self.assertEqual(len(table["agent 1: distance to the mean (m)"]), 301 - 146)
        self.assertEqual(table["floor: 1e-6 m: distance to the mean (m)"], ["1e-06"])

    def test_tables_of_pictures_without_curves(self):
        table = self.table("graph", summary=Graphs.TWO)
        self.assertEqual(table["edge 0 to 1.5 s: agent"], ["1", "2"])
        self.assertEqual(table["edge 1.5 to 5 s: hears agent"], ["2"])
        (self.folder / "events.csv").write_text(Changes.EVENTS)
        table = self.table("incidents")
        self.assertEqual([table[name][1] for name in ("what", "agent", "from (s)", "until (s)")], ["contact", "1", "1.0", "1.1"])
        states = arrays() | {"flags": np.zeros((51, 3))}
        states["flags"][10:20, 1] = 16
        table = self.table("safety", states=states)
        self.assertEqual(len(table["smallest distance: distance (m)"]), 51)
        self.assertEqual([float(table[f"agent 2, changed by law.safety: {at} (s)"][0]) for at in ("from", "until")], [1, 2])

    def test_every_curve_of_an_acceleration_that_switches_is_in_its_table(self):
        table = self.table("acceleration", config=MINMAX)
        self.assertEqual(len(table["agent 2, no mean: a_x (m/s²)"]), 51)
        self.assertEqual(float(table["agent 2, no mean: a_x (m/s²)"][7]), arrays()["acceleration_command"][7, 1, 0])
        self.assertNotEqual(table["agent 2: a_x (m/s²)"], table["agent 2, no mean: a_x (m/s²)"])

    # --- --format pgf

    def test_pgf_is_text_for_latex_in_which_nothing_is_a_command_by_chance(self):
        self.write(CONSENSUS.replace("demo", "a_b & {c} 50 %#") + "[[events]]\nat_s = 1.0\nset = { \"law.p_gain\" = 2 }\n")
        self.assertEqual(self.run_plot("--only", "velocity", "--format", "pgf"), (0, ""))
        first = (self.folder / "velocity.pgf").read_text()
        self.assertIn("a\\_b \\& \\{c\\} 50 \\%\\#: velocity", first)
        self.assertIn("p\\_gain = 2", first)
        self.assertIn("\\(\\displaystyle v_x\\) (m/s)", first)
        for command in ("\\begin{pgfpicture}", "\\end{pgfpicture}", "\\pgfqpoint{8.000000in}{"):
            self.assertIn(command, first)
        self.assertNotIn("mathdefault", first)
        self.assertNotRegex(first, r"Matplotlib|matplotlib", "no version")
        self.run_plot("--only", "velocity", "--format", "pgf")
        self.assertEqual((self.folder / "velocity.pgf").read_text(), first)

    def test_pgf_of_many_agents_needs_no_image_beside_it(self):
        self.write(states=arrays(50, 2))
        self.assertEqual(self.run_plot("--only", "position", "--format", "pgf,png"), (0, ""))
        self.assertEqual(sorted(path.name for path in self.folder.glob("position*")), ["position.pgf", "position.png"])
        self.assertNotIn("includegraphics", (self.folder / "position.pgf").read_text())


class Overlays(PlotTest):
    def setUp(self):
        super().setUp()
        self.out = self.folder.parent / "both"
        self.folders = [self.folder.parent / name for name in ("slow", "fast")]

    def write_two(self, configs=(CONSENSUS, CONSENSUS), states=(None, None)):
        for self.folder, config, of in zip(self.folders, configs, states):
            self.folder.mkdir(exist_ok=True)
            self.write(config, states=of)

    def overlay(self, *options):
        errors = io.StringIO()
        with contextlib.redirect_stderr(errors):
            code = plot.main([*map(str, self.folders), "--overlay", *options])
        return code, errors.getvalue()

    def test_all_pictures_that_apply_to_all_runs_are_drawn(self):
        self.write_two((CONSENSUS, WAYPOINT))
        self.assertEqual(self.overlay("--out", str(self.out), "--format", "png,svg", "--size", "column"), (0, ""))
        names = ("acceleration", "paths", "position", "velocity")
        self.assertEqual(sorted(path.name for path in self.out.iterdir()),
                         [f"{name}.{ending}" for name in names for ending in ("png", "svg")])

    def test_a_run_has_one_colour_and_one_name(self):
        self.write_two(states=(arrays(3), arrays(4)))
        figure_style.use("screen")
        runs = [run_folder.read_run(folder) for folder in self.folders]
        figures = dict(overlay.draw_overlay(self.folders, runs, None))
        self.assertEqual(list(figures), ["paths", "position", "velocity", "acceleration", "disagreement"])
        lines = figures["position"].axes[0].get_lines()
        blue, orange = figure_style.OKABE_ITO[:2]
        self.assertEqual([line.get_color() for line in lines], [blue] * 3 + [orange] * 4)
        self.assertEqual([line.get_linestyle() for line in lines], ["-"] * 3 + ["--"] * 4, "grey print tells them apart, too")
        np.testing.assert_array_equal(lines[4].get_ydata(), runs[1].position[:, 1, 0])
        names = [text.get_text() for text in figures["position"].legends[0].get_texts()]
        self.assertEqual(names, ["slow", "fast"], "the runs have the same name: those of their folders")
        (slow, fast) = figures["disagreement"].axes[0].get_lines()
        np.testing.assert_allclose(slow.get_ydata(), 5 * np.exp(-runs[0].t), rtol=1e-12)
        self.assertEqual(figures["disagreement"].axes[0].get_ylabel(), "largest distance to the mean (m)")

    def test_no_two_runs_look_alike_and_neighbours_differ_in_their_kind_of_line(self):
        for count in (2, 6, 10, 11, 30, 36):
            looks = figure_style.looks_of_runs(count)
            self.assertEqual(len(set(map(str, looks))), count)
            self.assertTrue(all(one[1] != other[1] for one, other in zip(looks, looks[1:])), count)

    def test_curves_of_laws_are_drawn_if_they_are_of_one_kind(self):
        self.write_two()
        told = [LawCurves.MISS, LawCurves.MISS | {"name": "lag"}]

        def runs(*curves):
            for folder, curve in zip(self.folders, curves):
                (folder / "law_curve.csv").write_text("t_s,value\n0,1\n1,0.1\n2,1e-9\n")
                (folder / "summary.json").write_text(json.dumps({"drawing": AGREEMENT | {"curve": curve}}))
            return [run_folder.read_run(folder) for folder in self.folders]

        figure = dict(overlay.draw_overlay(self.folders, runs(told[0], told[0]), None))["curve"]
        lines = {line.get_label(): line.get_ydata() for line in figure.axes[0].get_lines()}
        self.assertEqual(list(lines), ["slow", "fast", "floor: 1e-6 m²"])
        np.testing.assert_array_equal(lines["fast"], [1, 0.1, np.nan])
        self.assertNotIn("curve", dict(overlay.draw_overlay(self.folders, runs(*told), None)))
        self.assertEqual(self.overlay("--out", str(self.out), "--only", "curve"), (
            2, f"error: --only curve: {self.folders[0]}: expected laws with the same curve, got miss (m²), lag (m²)\n"))

    def test_options_are_about_all_runs(self):
        self.write_two(states=(arrays(3), arrays(4)))
        options = ("--out", str(self.out), "--only", "position", "--format", "csv", "--agents", "1-2", "--from-s", "4.9", "--label",
                   "slow=without")
        self.assertEqual(self.overlay(*options), (0, ""))
        header, *rows = csv.reader((self.out / "position.csv").read_text().splitlines())
        self.assertEqual(header[:5], ["time (s)", "without, agent 1: x (m)", "without, agent 2: x (m)", "fast, agent 1: x (m)",
                                      "fast, agent 2: x (m)"])
        self.assertEqual([row[0] for row in rows], ["4.9", "5.0"])
        self.assertEqual(self.overlay("--out", str(self.out), "--agents", "4"),
                         (2, f"error: --agents: {self.folders[0]}: expected numbers from 1 to 3, got 4\n"))

    def test_curves_of_several_runs_end_at_the_floor(self):
        self.write_two(states=(arrays(rows=301), arrays()))
        runs = [run_folder.read_run(folder) for folder in self.folders]
        figure, = dict(overlay.draw_overlay(self.folders, runs, ["disagreement"])).values()
        lines = {line.get_label(): line.get_ydata() for line in figure.axes[0].get_lines()}
        self.assertEqual([int(np.isnan(lines[name]).sum()) for name in ("slow", "fast")], [146, 0])
        self.assertIn("floor: 1e-6 m", lines)

    def test_disagreement_is_labelled_by_what_it_is_measured_against(self):
        self.write_two((CONSENSUS, LEADER))
        runs = [run_folder.read_run(folder) for folder in self.folders]
        for several, against in [((0, 1), "the mean or the leader"), ((1, 1), "agent 2"), ((0, 0), "the mean")]:
            figures = dict(overlay.draw_overlay(self.folders, [runs[k] for k in several], ["disagreement"]))
            label = figures["disagreement"].axes[0].get_ylabel().replace("\n", " ")  # it is broken where it is long
            self.assertEqual(label, f"largest distance to {against} (m)")

    def test_runs_have_their_own_names_if_they_differ(self):
        self.write_two((CONSENSUS, CONSENSUS.replace("demo", "other")))
        runs = [run_folder.read_run(folder) for folder in self.folders]
        self.assertEqual(overlay.names_of(self.folders, runs), ["demo", "other"])

    def test_wrong_use(self):
        self.write_two((CONSENSUS, WAYPOINT))
        out = ("--out", str(self.out))
        for options, message in (
                ((), "--overlay: it needs --out FOLDER, for the pictures belong to no single run"),
                ((*out, "--only", "graph"), "--only graph: expected one of paths, curve, position, velocity, acceleration, "
                                            "disagreement with --overlay"),
                ((*out, "--only", "disagreement"),
                 f"--only disagreement: {self.folders[1]}: it needs several agents and a law of agreement")):
            self.assertEqual(self.overlay(*options), (2, f"error: {message}\n"))
        self.folders.pop()
        self.assertEqual(self.overlay(*out), (2, "error: --overlay: expected at least 2 runs, got 1\n"))


def probe(path):
    """Codec, width, height, number of frames and frames per second of a film."""
    wanted = ("codec_name", "width", "height", "nb_read_frames", "r_frame_rate")
    told = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-of", "json", "-show_entries",
                           "stream=" + ",".join(wanted), path], check=True, capture_output=True, timeout=LIMIT_S)
    return tuple(json.loads(told.stdout)["streams"][0][name] for name in wanted)


class Films(PlotTest):
    """They need ffmpeg: scripts/setup --test."""

    def test_a_film_has_its_frames_and_size_and_the_same_bytes_each_time(self):
        self.write(LEADER, PATH)
        for ending, codec, scale in ((".mp4", "h264", 30), (".gif", "gif", 20)):
            path = self.folder.parent / f"film{ending}"
            self.assertEqual(self.run_plot("--animate", str(path), "--pace", "5"), (0, ""))
            self.assertEqual(probe(path), (codec, 8 * scale, 6 * scale, "26", "25/1"))
            first = path.read_bytes()
            self.run_plot("--animate", str(path), "--pace", "5")
            self.assertEqual(path.read_bytes(), first)
        self.assertEqual(sorted(path.name for path in self.folder.parent.iterdir()), ["a run", "film.gif", "film.mp4"])
        self.assertEqual(self.pictures(), [])

    def test_frames_begin_with_the_first_row_and_end_with_the_last(self):
        t = np.arange(1001) / 10
        for pace, frames, used in ((None, 501, 5), (1.0, 2501, 1.0), (7.0, 359, 7.0), (1e9, 2, 1e9)):
            rows, found = animation.rows_of_frames(t, pace)
            self.assertEqual((len(rows), rows[0], rows[-1], found), (frames, 0, 1000, used))
            self.assertTrue(np.all(np.diff(rows) >= 0))
        self.assertEqual(animation.rows_of_frames(t[:1], None)[0].tolist(), [0])

    def film(self, **what):
        self.write(**what)
        figure_style.use("screen")
        return animation.Film(run_folder.read_run(self.folder), 3, 1)

    def test_agents_are_where_they_were_and_their_ways_remain(self):
        film = self.film(states=arrays(agents=3))
        p = film.p
        for row, before in ((0, 0), (5, 0), (10, 5)):
            pixels = np.asarray(film.frame(row, before))
            high = pixels.shape[0]
            for k in range(3):
                x, y = film.axis.transData.transform(p[row, k])
                colour = 255 * np.array(matplotlib.colors.to_rgb(figure_style.OKABE_ITO[k]))
                np.testing.assert_allclose(pixels[int(high - y), int(x), :3], colour, atol=8)
        x, y = film.axis.transData.transform(p[2, 0])
        self.assertLess(pixels[int(high - y) - 1:int(high - y) + 2, int(x), 0].min(), 200, "agent 1 came along here")

    def test_edges_are_those_of_their_time_and_of_agents_that_are_near(self):
        film = self.film(summary=Graphs.TWO, config=CONSENSUS + "[graph]\nrange_m = 5.0\n")
        near = np.zeros((3, 3))
        self.assertEqual([film.edges(t_s, near).tolist() for t_s in (0, 1.4, 1.5, 5)],
                         [[[0, 1], [1, 0]]] * 2 + [[[2, 1]]] * 2)
        self.assertEqual(film.edges(0, np.array([[0, 0, 0], [0, 0, 6], [0, 0, 0]])).tolist(), [])

    def test_it_tells_the_time_the_phase_and_events_of_late(self):
        film = self.film(config=Changes.PHASES + "[[events]]\nat_s = 1.0\ncut = [[1, 2]]\n", summary=Changes.TOLD)
        self.assertEqual([film.words(t_s) for t_s in (0.94, 1, 2.9, 4)], [
            "t = 0.9 s   chase\n", "t = 1.0 s   chase\ncut 1,2", "t = 2.9 s   chase\ncut 1,2", "t = 4.0 s   flee\n"])
        self.assertEqual(self.film().words(1), "t = 1.0 s")

    def test_hull_and_cells_move(self):
        film = self.film(config='[law]\nname = "chase"\nguides = [1, 2, 3]\n', summary={"drawing": {"hull": "guides"}})
        first = np.array(film.frame(0, 0))
        self.assertGreater(np.count_nonzero(first != np.array(film.frame(20, 20))), 0)
        self.assertEqual(list(film.axis.patches), [], "each frame has its own")

    def test_wrong_use(self):
        self.write()
        film = ("--animate", str(self.folder / "film.mp4"))
        for options, code, message in (
                (("--animate", "film.avi"), 2,
                 "--animate: expected a file whose name ends in .mp4 or .gif, got 'film.avi'"),
                ((*film, "--only", "paths"), 2, "--animate: it draws a film and nothing else, got --only too"),
                ((*film, "--format", "svg"), 2, "--animate: it draws a film and nothing else, got --format too"),
                ((*film, "--agents", "1"), 2, "--animate: it draws a film and nothing else, got --agents too"),
                ((*film, "--show"), 2, "--animate: it draws a film and nothing else, got --show too"),
                ((*film, "--pace", "0"), 2, "--pace: expected a number above 0, got '0'"),
                ((*film, "--pace", "fast"), 2, "--pace: expected a number above 0, got 'fast'"),
                (("--pace", "2"), 2, "--pace: it is that of a film, and needs --animate"),
                ((str(self.folder), *film), 2, "--animate: expected one run, got 2")):
            self.check(code, message, *options)

    def test_without_ffmpeg_it_says_what_to_install(self):
        self.write()
        with mock.patch.dict(os.environ, {"PATH": str(self.folder)}):
            self.check(1, "--animate: it needs the program ffmpeg, which is not installed (Debian: apt-get install ffmpeg)",
                       "--animate", str(self.folder / "film.mp4"))

    def test_a_failure_of_ffmpeg_is_told_and_leaves_no_file(self):
        self.write()
        ffmpeg = self.folder / "ffmpeg"
        ffmpeg.write_text("#!/bin/sh\n[ -z \"$KEEPS_ON\" ] || /bin/cat > /dev/null\necho no room for it >&2\nexit 1\n")
        ffmpeg.chmod(0o755)
        path = self.folder / "film.gif"
        for keeps_on in ("", "yes"):
            with mock.patch.dict(os.environ, {"PATH": str(self.folder), "KEEPS_ON": keeps_on}):
                self.assertEqual(self.run_plot("--animate", str(path), "--pace", "5"),
                                 (1, f"error: {path}: ffmpeg failed: no room for it\n"))
            self.assertEqual(list(self.folder.glob("film*")), [])


class PicturesOfLaws(PlotTest):
    """scripts/law_pictures, which draws the pictures in docs/laws.md."""

    def test_each_experiment_that_the_page_names_has_its_picture(self):
        named = law_pictures.experiments()
        self.assertGreater(len(named), 20)
        self.assertEqual(sorted(named), sorted(path.stem for path in law_pictures.PICTURES.glob("*.png")))
        for experiment in named.values():
            self.assertTrue((law_pictures.ROOT / experiment).is_file(), experiment)

    def test_the_picture_that_tells_most_is_drawn_in_few_colours_without_axes_where_nothing_moves(self):
        self.write(summary={"drawing": {"telling": "velocity"}})
        run = run_folder.read_run(self.folder)
        self.assertEqual(law_pictures.moving(run.velocity), [0, 1])
        self.assertEqual(law_pictures.moving(0 * run.velocity), [0])
        for name in ("a", "b"):
            law_pictures.draw(run, self.folder / f"{name}.png")
        first, second = ((self.folder / f"{name}.png").read_bytes() for name in ("a", "b"))
        self.assertEqual(first[:4], b"\x89PNG")
        self.assertEqual(first[25], 3, "the colours are those of a palette")
        self.assertEqual(first, second)


class Errors(PlotTest):
    def test_missing_folder(self):
        self.folder = self.folder / "gone"
        self.check(2, f"{self.folder}: no such folder")

    def test_missing_states(self):
        missing = f"{self.folder}/states.npz: no such file: "
        self.check(1, missing + "this is not the folder of a run")
        export = f"; orchestrator export {self.folder} --format npz writes it"
        for config, has_summary, why in ((CONSENSUS, False, "the run was killed, or has not ended"), (CONSENSUS, True, "it was removed"),
                                         (CONSENSUS + "[output]\nsave_data = false\n", True, "output.save_data is off")):
            self.write(config)
            (self.folder / "states.npz").unlink()
            if not has_summary:
                (self.folder / "summary.json").unlink()
            self.check(1, missing + why + export)

    def test_damaged_states(self):
        self.write()
        path = self.folder / "states.npz"
        whole = path.read_bytes()
        for damaged in (b"", b"no zip", whole[: len(whole) // 2], whole[:200] + b"\xff" * 50 + whole[250:]):
            path.write_bytes(damaged)
            self.check(1, f"{path}: damaged, or not an .npz file of numbers")

    def test_states_that_lack_an_array(self):
        states = arrays()
        del states["velocity"]
        self.write(states=states)
        self.check(1, f"{self.folder}/states.npz: velocity: no such array")

    def test_states_of_the_wrong_shape(self):
        self.write(states=arrays() | {"velocity": np.zeros((51, 2, 3))})
        self.check(1, f"{self.folder}/states.npz: velocity: expected shape (51, 3, 3), got (51, 2, 3)")

    def test_flags_of_the_wrong_shape(self):
        self.write(states=arrays() | {"flags": np.zeros((51, 2))})
        self.check(1, f"{self.folder}/states.npz: flags: expected shape (51, 3), got (51, 2)")

    def test_states_that_no_run_has(self):
        path, good = f"{self.folder}/states.npz", arrays()
        later, hole = good["t"].copy(), good["position"].copy()
        later[7], hole[5, 1, 2] = later[6], np.nan
        for name, array, why in (
                ("t", later, "t: expected times that increase, got others"),
                ("t", later * np.nan, "t: expected times that increase, got others"),
                ("t", np.array(["now"] * 51), "t: expected numbers, got <U3"),
                ("id", np.array([1, 2, 2]), "id: expected each agent's number once, from 1 on, got others"),
                ("id", np.array([0, 1, 2]), "id: expected each agent's number once, from 1 on, got others"),
                ("id", np.array([1, 2, 2.5]), "id: expected each agent's number once, from 1 on, got others"),
                ("position", hole, "position: expected finite numbers, got others at 0.5 s of agent 2"),
                ("velocity", good["velocity"] * 1j, "velocity: expected numbers, got complex128"),
                ("flags", np.full((51, 3), 0.5), "flags: expected integers from 0 on, got others")):
            with self.subTest(name=name, why=why):
                self.write(states=good | {name: array})
                self.check(1, f"{path}: {why}")

    def test_states_that_unpack_to_very_much(self):
        self.write()
        path = self.folder / "states.npz"
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive:
            for name in ("t", "id", "position"):
                with archive.open(f"{name}.npy", "w", force_zip64=True) as file:
                    for _ in range(100):
                        file.write(bytes(1 << 20))
        with self.assertRaisesRegex(run_folder.RunError, "unpacks to 314572800 bytes, above the limit of 1048576 and 10"):
            with mock.patch.object(run_folder, "UNPACKED_FREE", 1 << 20), mock.patch.object(run_folder, "UNPACKED_TIMES", 10):
                run_folder.read_states(path)

    def test_incidents_that_no_run_has(self):
        self.write()
        path = self.folder / "events.csv"
        head = "t_s,until_s,agent,what,with,value\n"
        for row, why in (("nan,1,1,loss,,\n", ":2: expected an incident with its times, got nan and 1"),
                         ("0,1,1,loss\n", ":2: expected an incident with its times, got 0 and 1"),
                         ("soon,1,1,loss,,\n", ": damaged, or not a table of events")):
            path.write_text(head + row)
            self.check(1, f"{path}{why}")

    def test_texts_of_another_kind(self):
        self.write()
        (self.folder / "summary.json").write_text("[1, 2]")
        self.check(1, f"{self.folder}/summary.json: expected a table, got a list")
        (self.folder / "summary.json").write_text('{"graph": 3}')
        code, errors = self.run_plot()
        self.assertEqual(code, 1)
        self.assertRegex(errors, r"\nerror: config\.toml or summary\.json says something else than a run's does: .*\n$")

    def test_states_without_a_tick(self):
        self.write(states=arrays(rows=0))
        self.check(1, f"{self.folder}/states.npz: holds no tick")

    def test_missing_and_damaged_texts(self):
        self.write()
        (self.folder / "summary.json").write_text("{")
        code, errors = self.run_plot()
        self.assertEqual(code, 1)
        self.assertRegex(errors, r"^error: .*/summary\.json: Expecting .*\n$")
        (self.folder / "config.toml").unlink()
        self.check(1, f"{self.folder}/config.toml: No such file or directory")

    def test_a_pipe_in_the_place_of_a_file_is_refused(self):
        for name in ("states.npz", "config.toml", "summary.json", "events.csv", "law_curve.csv"):
            self.write()
            (self.folder / name).unlink(missing_ok=True)
            os.mkfifo(self.folder / name)
            self.check(1, f"{self.folder}/{name}: not a regular file")
            (self.folder / name).unlink()

    def test_a_newer_format_is_refused(self):
        self.write(summary={"format": 2})
        self.check(2, f"{self.folder}/summary.json: it is of format 2, newer than the 1 that this version reads")
        self.write(config="format = 2\n" + CONSENSUS)
        self.check(2, f"{self.folder}/config.toml: it is of format 2, newer than the 1 that this version reads")

    def test_wrong_use(self):
        self.write()
        code, errors = self.run_plot("--only", "speed")
        self.assertEqual(code, 2)
        self.assertEqual(errors, "error: --only: expected one or more of paths, curve, position, velocity, disagreement, acceleration, "
                                 "tracking, error, graph, safety, incidents, with commas between, got 'speed'\n")
        self.check(2, "--only error: it needs a law that flies to waypoints, from start to end", "--only", "error")
        self.check(2, "--only tracking: it needs a law of pursuit, from start to end, and the graph in summary.json", "--only", "tracking")
        self.check(2, "unrecognized arguments: --fast", "--fast")
        self.check(2, "--only: expected one or more of paths, curve, position, velocity, disagreement, acceleration, tracking, error, "
                      "graph, safety, incidents, with commas between, got 'pathes' (did you mean \"paths\"?)", "--only", "pathes")
        self.check(2, "--format: expected one or more of png, pdf, svg, pgf, csv, with commas between, got 'bmp'",
                   "--format", "pdf,bmp")
        self.check(2, "--size: expected one of screen, column, page, got 'colum' (did you mean \"column\"?)", "--size", "colum")
        self.check(2, "--size: expected one of screen, column, page, got 'poster'", "--size", "poster")
        self.check(2, "--out: expected one run, or --overlay, got 2 runs, whose pictures have the same names",
                   str(self.folder), "--out", "x")

    def test_a_folder_that_cannot_be_written(self):
        self.write()
        (self.folder / "paths.png").mkdir()
        self.check(1, f"{self.folder}/paths.png: Is a directory")


class OthersFiles(PlotTest):
    """What has the name of a picture, or of one that is not finished yet."""

    def setUp(self):
        super().setUp()
        self.write()
        self.other = self.folder.parent / "other"
        self.other.write_text("mine")

    def test_a_link_gives_way_to_the_picture_and_what_it_leads_to_stays(self):
        (self.folder / "paths.png").symlink_to(self.other)
        self.assertEqual(self.run_plot("--only=paths"), (0, ""))
        self.assertFalse((self.folder / "paths.png").is_symlink())
        self.assertEqual(self.other.read_text(), "mine")

    def test_a_link_at_the_name_of_an_unfinished_picture_is_refused(self):
        (self.folder / "paths.png.part").symlink_to(self.other)
        self.check(1, f"{self.folder}/paths.png.part: File exists", "--only=paths")
        self.assertEqual(self.other.read_text(), "mine")

    def test_what_a_killed_process_left_gives_way(self):
        (self.folder / "paths.png.part").write_text("half a pic")
        self.assertEqual(self.run_plot("--only=paths"), (0, ""))
        self.assertEqual(self.pictures(), ["paths"])
        self.assertFalse((self.folder / "paths.png.part").exists())

    def test_a_pipe_is_refused(self):
        os.mkfifo(self.folder / "paths.png")
        self.check(1, f"{self.folder}/paths.png: expected a file, got something else of this name", "--only=paths")


class Surroundings(PlotTest):
    """The same run makes the same bytes, whoever draws it, and wherever."""

    def setUp(self):
        super().setUp()
        self.write()
        self.place = self.folder.parent / "place"
        self.place.mkdir()

    def drawn(self, **environment):
        """Draws as the programs do, in a folder of its own. Returns the bytes of the picture."""
        script = pathlib.Path(plot.__file__)
        environment = {"PATH": "/usr/bin:/bin", **environment}
        done = subprocess.run(["/usr/bin/python3", "-E", "-s", "-B", "-X", "utf8", script, self.folder, "--only=paths"],
                              cwd=self.place, env=environment, capture_output=True, text=True, timeout=LIMIT_S)
        self.assertEqual((done.returncode, done.stdout, done.stderr), (0, "", ""))
        return (self.folder / "paths.png").read_bytes()

    def test_no_matplotlibrc_no_module_and_no_variable_changes_a_picture(self):
        usual = self.drawn(HOME=os.path.expanduser("~"))
        home = self.folder.parent / "home"
        for folder in (self.place, home / ".config/matplotlib", home / "modules"):
            folder.mkdir(parents=True, exist_ok=True)
            (folder / "matplotlibrc").write_text("backend: nonsense\nlines.linewidth: 9\nsavefig.dpi: 33\n")
            for module in ("numpy", "matplotlib", "json", "sitecustomize", "usercustomize"):
                (folder / f"{module}.py").write_text("raise SystemExit('not the one that was meant')\n")
        others = str(home / "modules")
        self.assertEqual(usual, self.drawn(
            HOME=str(home), TMPDIR="/nowhere", MPLBACKEND="nonsense", MPLCONFIGDIR=str(home / ".config/matplotlib"),
            MATPLOTLIBRC=str(self.place), PYTHONPATH=others, PYTHONHOME=others, PYTHONSTARTUP=others + "/numpy.py",
            PYTHONOPTIMIZE="2", PYTHONWARNINGS="error", LC_ALL="C", TZ="Pacific/Auckland",
            NPY_DISABLE_CPU_FEATURES="AVX2 NONSENSE", OPENBLAS_CORETYPE="Prescott"))
        self.assertEqual(sorted(path.name for path in home.iterdir()), [".config", "modules"])

    def test_nobody_needs_a_home_and_nothing_is_left_behind(self):
        temporary = self.folder.parent / "temporary"
        temporary.mkdir()
        usual = self.drawn(HOME=os.path.expanduser("~"))
        for environment in ({}, {"HOME": "/nowhere"}, {"HOME": "/proc/self"}, {"HOME": ""}):
            self.assertEqual(usual, self.drawn(TMPDIR=str(temporary), **environment))
            self.assertEqual(list(temporary.iterdir()), [])

    def test_fonts_of_the_user_are_not_looked_at(self):
        usual = self.drawn(HOME=os.path.expanduser("~"))
        fonts = self.folder.parent / "home/.fonts"
        fonts.mkdir(parents=True)
        oblique = pathlib.Path(matplotlib.get_data_path()) / "fonts/ttf/DejaVuSans-Oblique.ttf"
        (fonts / "DejaVuSans.ttf").write_bytes(oblique.read_bytes())
        self.assertEqual(usual, self.drawn(HOME=str(fonts.parent)))


class PlainWords(unittest.TestCase):
    def test_what_acts_on_other_text_is_escaped(self):
        self.assertEqual(plain.plain("Gr\u00fc\u00dfe,\tline\n\U0001f681"), "Gr\u00fc\u00dfe,\tline\n\U0001f681")
        self.assertEqual(plain.plain("\x1b[31m\r\x00\x7f\x9b"), "\\u001b[31m\\r\\u0000\\u007f\\u009b")
        for code in [0x061c, 0x200e, 0x200f, *range(0x2028, 0x202f), *range(0x2066, 0x206a)]:
            self.assertEqual(plain.plain(chr(code)), f"\\u{code:04x}")
        self.assertEqual(plain.plain("\udcff"), "\ufffd")

    def test_scripts_print_no_word_of_others_as_it_is(self):
        evil = "no\x1b[31m\u202e"
        for script, words in [("plot.py", [evil]), ("plot.py", ["runs", "--" + evil]),
                              ("plot_sweep.py", ["t.csv", "s.csv", "p.png", "c", "--" + evil])]:
            ran = subprocess.run(["/usr/bin/python3", ROOT / "scripts" / script, *words], capture_output=True,
                                 timeout=LIMIT_S)
            said = (ran.stdout + ran.stderr).decode()
            self.assertNotEqual(ran.returncode, 0)
            self.assertIn("\\u001b[31m\\u202e", said)
            self.assertEqual(plain.plain(said), said)


class ManyAgentsTest(unittest.TestCase):
    """What is computed in bulk is, to the bit, what it is one by one."""

    def test_separation(self):
        position = np.random.default_rng(1).normal(size=(1203, 40, 3))
        for axes in ([0, 1], [0, 1, 2]):
            p = position[:, :, axes]
            pairs = [np.linalg.norm(p[:, i] - p[:, j], axis=1) for i in range(40) for j in range(i)]
            run = mock.Mock(position=position, axes=axes, size=40, t=np.arange(1203))
            np.testing.assert_array_equal(run_folder.separation(run), np.min(pairs, axis=0))

    def test_edges(self):
        rng = np.random.default_rng(2)
        at = rng.normal(size=(60, 2))
        edges = {(int(i), int(j)) for i, j in rng.integers(60, size=(700, 2)) if i != j}
        lines = sorted(edge for edge in edges if edge[0] < edge[1] or edge[::-1] not in edges)
        arrows = [edge for edge in lines if edge[::-1] not in edges]
        self.assertNotIn(len(arrows), (0, len(lines)), "edges of both kinds")
        with mock.patch.object(pictures, "arrow_heads") as heads:
            drawn = pictures.edge_artists(pictures.plt.figure().add_subplot(), at, pictures.in_order(edges))[0]
        np.testing.assert_array_equal(drawn.get_segments(), [at[list(edge)] for edge in lines])
        np.testing.assert_array_equal(heads.call_args.args[1:3], [at[[j for _, j in arrows]], at[[i for i, _ in arrows]]])
        pictures.plt.close("all")


class SweepTableTest(unittest.TestCase):
    COLUMN = "control.effort"

    def table_of(self, runs, statistics, *keys):
        """The Table of CSV files with these lines."""
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        paths = [pathlib.Path(scratch.name) / name for name in ("sweep.csv", "sweep.stats.csv")]
        for path, lines in zip(paths, (runs, statistics)):
            path.write_text("".join(f"{line}\n" for line in lines))
        return plot_sweep.Table(mock.Mock(table=paths[0], statistics=paths[1], column=self.COLUMN, keys=list(keys), label=[], time=False))

    def test_a_table_that_no_sweep_has_written(self):
        header = "run,error,sim_s,control.effort"
        for runs, why in ((["run,error,sim_s"], r":1: expected the column control\.effort once, got it 0 times"),
                          ([header + ",error"], ":1: expected the column error once, got it 2 times"),
                          ([header, "0,,1,2", "1,,1"], ":3: expected 4 cells, got 3")):
            with self.assertRaisesRegex(plot_sweep.TableError, why):
                self.table_of(runs, ["metric,median"])

    def test_very_many_points(self):
        count = 20_000
        runs = [f'{k},{k / 2},"a, b",why,{k + 1}.0,9' for k in range(count)]
        points = [f"{k / 2},{metric},1,{k + 1}.0" for metric in ("ticks", self.COLUMN) for k in range(count)]
        table = self.table_of([f"run,law.p_gain,word,error,{self.COLUMN},sim_s", *runs],
                              ["law.p_gain,metric,runs,mean", *points], "law.p_gain")
        self.assertEqual(set(table.runs[0]), {"law.p_gain", "error", self.COLUMN, "sim_s"}, "what is drawn, and no more")
        self.assertEqual([row["mean"] for row in table.points], [f"{k + 1}.0" for k in range(count)])
        axis = plot_sweep.Axis(table, "law.p_gain")
        self.assertEqual([axis.of(row["law.p_gain"]) for row in table.points], [k / 2 for k in range(count)])
        self.assertEqual(axis.rank()[(count - 1) / 2], count - 1)

    def test_a_band_that_goes_below_zero_ends_at_the_foot_of_a_log_axis(self):
        table = self.table_of([f"run,law.beta,error,{self.COLUMN},sim_s", *(f"0,{k},,{y},1" for k in (1, 2) for y in (1, 9e3))],
                              ["law.beta,metric,runs,failed,without_value,mean,mean_low_95,mean_high_95,median,decile_1,decile_9",
                               f"1,{self.COLUMN},2,0,0,5,1,9,5,1,9", f"2,{self.COLUMN},2,0,0,4000,-500,9000,4000,1,9000"],
                              "law.beta")
        plot_sweep.figure_style.use("screen")
        axis = plot_sweep.Curves(table, "law.beta", None).draw().axes[0]
        self.addCleanup(plot.plt.close, "all")
        band = axis.collections[0].get_paths()[0].vertices[:, 1]
        self.assertEqual((axis.get_yscale(), band.min(), band.max()), ("log", 0.5, 9000))

    def test_series_differ_in_colour_or_kind_of_line_and_are_named_below_the_panels(self):
        laws = [f"law_{n}" for n in range(12)]
        points = [f"{law},{k},{self.COLUMN},1,0,0,{k},,,{k},," for law in laws for k in (1, 2)]
        table = self.table_of([f"run,law.name,law.beta,error,{self.COLUMN},sim_s", *(f"0,{law},{k},,{k},1" for law in laws for k in (1, 2))],
                              ["law.name,law.beta,metric,runs,failed,without_value,mean,mean_low_95,mean_high_95,median,decile_1,decile_9",
                               *points], "law.name", "law.beta")
        with laid_out():
            plot_sweep.figure_style.use("column")
            figure = plot_sweep.draw(table)
        self.addCleanup(plot.plt.close, "all")
        axis = figure.axes[0]
        self.assertEqual(len({(line.get_color(), line.get_linestyle()) for line in axis.get_lines()}), len(laws))
        figure.draw_without_rendering()
        legend, = figure.legends
        self.assertEqual(legend.get_title().get_text(), "law.name")
        self.assertLess(legend.get_window_extent().y1, axis.xaxis.label.get_window_extent().y0)

    def drawn_over(self, values):
        """The axis of keys of the picture of a sweep over these values of a gain."""
        header = "law.beta,metric,runs,failed,without_value,mean,mean_low_95,mean_high_95,median,decile_1,decile_9"
        table = self.table_of([f"run,law.beta,error,{self.COLUMN},sim_s", *(f"0,{x},,{5 + x},1" for x in values)],
                              [header, *(f"{x},{self.COLUMN},1,0,0,{5 + x},,,{5 + x},," for x in values)], "law.beta")
        plot_sweep.figure_style.use("screen")
        figure = plot_sweep.draw(table)
        self.addCleanup(plot.plt.close, "all")
        figure.draw_without_rendering()
        return figure.axes[0].xaxis

    def test_values_that_are_spaced_by_factors_have_a_log_axis(self):
        drawn = np.random.default_rng(1).uniform(0, 1, 60)
        for values, scale in (([0.1, 0.2, 0.4, 0.8], "log"), ([1, 2, 5, 10], "log"), ([0.01, 1, 100], "log"),
                              (10**drawn, "log"), ([0.1, 0.2, 0.3, 0.4], "linear"), ([1, 2], "linear"), ([-1, 1, 4], "linear"),
                              ([0, 1, 2, 4], "linear"), (1 + 9 * drawn, "linear"), ([3, 3, 3], "linear")):
            self.assertEqual(self.drawn_over(list(values)).get_scale(), scale, values)
        axis = self.drawn_over([0.1, 0.2, 0.4, 0.8])
        self.assertEqual([label.get_text() for label in axis.get_ticklabels(which="both") if label.get_text()],
                         ["0.1", "0.2", "0.4", "0.8"])

    def test_equal_numbers_in_other_words_stand_in_one_order(self):
        cells = ["1.00", "1", "1.0", "0.5"]
        table = self.table_of([f"run,law.beta,error,{self.COLUMN},sim_s", *(f"0,{cell},,1,1" for cell in cells)],
                              ["law.beta,metric"], "law.beta")
        axis = plot_sweep.Axis(table, "law.beta")
        self.assertEqual(axis.cells, ["0.5", "1", "1.0", "1.00"], "not in that of a set, which is another every time")
        self.assertEqual(axis.rank(), {0.5: 0, 1.0: 1})


if __name__ == "__main__":
    unittest.main()

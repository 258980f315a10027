#!/usr/bin/python3
"""Tests of scripts/plot.py and scripts/law_pictures: which plots they make, what these contain, and error messages."""

import contextlib
import importlib.machinery
import importlib.util
import io
import json
import os
import pathlib
import sys
import tempfile
import unittest

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "scripts"))
sys.dont_write_bytecode = True
import plot
import run_folder

loader = importlib.machinery.SourceFileLoader("law_pictures", str(pathlib.Path(plot.__file__).parent / "law_pictures"))
law_pictures = importlib.util.module_from_spec(importlib.util.spec_from_loader("law_pictures", loader))
loader.exec_module(law_pictures)

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
    plot.STYLE |= {"figure.dpi": 30, "figure.constrained_layout.use": False}  # to be fast: nobody looks at these plots


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

    def pictures(self):
        return sorted(path.stem for path in self.folder.glob("*.png"))

    def figure(self, name, **what):
        self.write(**what)
        return plot.PICTURES[name].draw(run_folder.read_run(self.folder))


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

    def test_only_draws_one(self):
        self.write()
        self.assertEqual(self.run_plot("--only", "velocity"), (0, ""))
        self.assertEqual(self.pictures(), ["velocity"])

    def test_the_same_run_gives_the_same_bytes(self):
        self.write(LEADER, PATH)
        for name in ("paths", "disagreement"):
            self.run_plot("--only", name)
        first = {path.name: path.read_bytes() for path in self.folder.glob("*.png")}
        self.run_plot()
        self.assertEqual({path.name: path.read_bytes() for path in self.folder.glob("*.png") if path.name in first}, first)
        self.assertNotIn(b"tEXt", first["paths.png"])


class Switches(PlotTest):
    def test_position_plot_off_leaves_velocity_and_acceleration(self):
        self.write(CONSENSUS + "[output]\nposition_plot = false\n")
        self.assertEqual(self.run_plot()[0], 0)
        self.assertEqual(self.pictures(), ["acceleration", "velocity"])

    def test_velocity_plot_off_leaves_the_others(self):
        self.write(MINMAX + "[output]\nvelocity_plot = false\n", PATH)
        self.assertEqual(self.run_plot()[0], 0)
        self.assertEqual(self.pictures(), ["disagreement", "paths", "position", "tracking"])

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

    def test_disagreement_is_the_distance_to_the_mean_on_a_log_axis(self):
        axis = self.figure("disagreement").axes[0]
        self.assertEqual((axis.get_yscale(), axis.get_ylabel()), ("log", "distance to the mean (m)"))
        np.testing.assert_allclose(self.lines(axis)["largest"].get_ydata(), 5 * np.exp(-arrays()["t"]), rtol=1e-12)

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
        box, sphere = self.figure("paths", config=config).axes[0].patches[:2]
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

    def test_the_hull_of_listed_leaders_is_drawn_at_the_end(self):
        config = '[law]\nname = "chase"\nguides = [1, 2, 3, 5]\n'
        states = arrays(agents=5)
        states["position"][-1] = [[0, 0, 1], [2, 0, 1], [1, 2, 1], [9, 9, 1], [1, 1, 1]]
        axis = self.figure("paths", config=config, states=states, summary={"drawing": {"hull": "guides"}}).axes[0]
        corners = axis.patches[0].get_xy()[:-1]  # without the first one again
        self.assertEqual(corners.tolist(), [[0, 0], [2, 0], [1, 2]])
        lines = self.lines(axis)
        self.assertEqual([lines[name].get_linewidth() for name in ("agent 1 (leader)", "agent 4")], [2.2, 1.2])
        self.assertIn("hull of leaders", [text.get_text() for text in axis.get_legend().get_texts()])

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
        legend = self.figure("paths", config=LEADER).axes[0].get_legend()
        names = [text.get_text() for text in legend.get_texts()]
        self.assertEqual(names, ["agent 1", "agent 2 (leader)", "agent 3", "start", "end"])
        many = self.figure("position", states=arrays(agents=11))
        self.assertIsNone(many.axes[0].get_legend())
        self.assertEqual(many.axes[-1].get_ylabel(), "agent")

    def test_colours_differ_and_are_okabe_and_itos_up_to_eight(self):
        self.write(states=arrays(agents=8))
        self.assertEqual(sorted(plot.colours(run_folder.read_run(self.folder))), sorted(plot.OKABE_ITO))
        self.write(states=arrays(agents=100))
        self.assertEqual(len(set(plot.colours(run_folder.read_run(self.folder)))), 100)

    def test_the_graph_and_the_prediction_are_drawn(self):
        summary = PATH | {"consensus": {"settling_time_s": None, "predicted": {"value_m": [1, 2, 3]}}}
        axis = self.figure("paths", summary=summary).axes[0]
        self.assertEqual(len(axis.collections[0].get_segments()), 2)  # two pairs that hear each other
        self.assertEqual([list(d) for d in self.lines(axis)["predicted"].get_data()], [[1], [2]])


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
    def check(self, code, message, *options):
        self.assertEqual(self.run_plot(*options), (code, f"error: {message}\n"))

    def test_missing_folder(self):
        self.folder = self.folder / "gone"
        self.check(2, f"{self.folder}: no such folder")

    def test_missing_states(self):
        self.check(1, f"{self.folder}/states.npz: no such file (output.save_data = false writes none)")

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

    def test_a_newer_format_is_refused(self):
        self.write(summary={"format": 2})
        self.check(2, f"{self.folder}/summary.json: it is of format 2, newer than the 1 that this version reads")
        self.write(config="format = 2\n" + CONSENSUS)
        self.check(2, f"{self.folder}/config.toml: it is of format 2, newer than the 1 that this version reads")

    def test_wrong_use(self):
        self.write()
        code, errors = self.run_plot("--only", "speed")
        self.assertEqual(code, 2)
        self.assertRegex(errors, r"^error: argument --only: invalid choice: 'speed' \(choose from 'paths', .*\)\n$")
        self.check(2, "--only error: it needs a law that flies to waypoints, from start to end", "--only", "error")
        self.check(2, "--only tracking: it needs a law of pursuit, from start to end, and the graph in summary.json", "--only", "tracking")
        self.check(2, "unrecognized arguments: --fast", "--fast")

    def test_a_folder_that_cannot_be_written(self):
        self.write()
        (self.folder / "paths.png").mkdir()
        self.check(1, f"{self.folder}/paths.png: Is a directory")


if __name__ == "__main__":
    unittest.main()

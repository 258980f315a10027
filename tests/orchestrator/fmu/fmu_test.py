#!/usr/bin/python3
"""Steps FMUs that `orchestrator fmu` has made (docs/fmu.md) by a tool that knows FMI alone, and compares with `up` and with
`orchestrator serve`."""

import contextlib
import json
import os
import pathlib
import re
import select
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import unittest
import zipfile

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
import fmi  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[3]
BINARIES = pathlib.Path(os.environ["MASCOT_BINARY_DIR"]).resolve()
ORCHESTRATOR = BINARIES / "orchestrator"
LIMIT_S = 60
TEAM = """[run]
name = "team"
duration_s = 0.5
[agents]
count = 3
model = "double_integrator"
position_m = [[0, 0, 1], [4, 0, 1], [0, 3, 1]]
[graph]
topology = "complete"
[law]
name = "formation"
offsets_m = [[0, 0, 0], [2, 0, 0], [0, 2, 0]]
"""


def make(*arguments):
    return subprocess.run([ORCHESTRATOR, "fmu", *map(str, arguments)], capture_output=True, text=True, timeout=LIMIT_S)


def children():
    """The processes that this one has started, and not yet reaped."""
    return pathlib.Path(f"/proc/self/task/{os.getpid()}/children").read_text().split()


def descriptors():
    return len(os.listdir("/proc/self/fd"))


class Made(unittest.TestCase):
    """Has a folder, a team, and FMUs of both versions of FMI."""

    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory(prefix="mascot-fmu-")))
        self.team = self.folder / "team.toml"
        self.team.write_text(TEAM)
        self.count = 0
        self.descriptors = descriptors()

    def tearDown(self):
        self.assertEqual(children(), [])
        self.assertEqual(descriptors(), self.descriptors)

    def fmu(self, version, *arguments, team=None):
        self.count += 1
        path = self.folder / f"{self.count}.fmu"
        done = make(team or self.team, "--out", path, "--fmi", version, *arguments)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        return fmi.Fmu(path, self.folder / f"unpacked {self.count}")  # a space, which a URI says as %20

    def both(self, *arguments, team=None):
        for version in (2, 3):
            yield self.fmu(version, *arguments, team=team)

    def up(self, *arguments):
        out = self.folder / f"up {len(list(self.folder.iterdir()))}"
        subprocess.run([ORCHESTRATOR, "up", *map(str, arguments), "--engine", "inprocess", "--quiet", "--set",
                        "output.save_plot=false", "--out", out], check=True, timeout=LIMIT_S)
        return numpy.load(out / "states.npz")

    def refused(self, words, call, *arguments, status=fmi.ERROR):
        """`call` of an instance is an error with these words."""
        with self.assertRaises(fmi.FmiError) as caught:
            call(*arguments)
        self.assertEqual(caught.exception.status, status)
        self.assertEqual(call.__self__.words(), words)


def names(part, count, agents):
    return [f"agent[{id}].{part}[{n}]" for id in range(1, agents + 1) for n in range(1, count + 1)]


def rows(instance, agents):
    """Positions and velocities of all agents."""
    return [numpy.reshape(instance.get(*names(part, 3, agents)), (agents, 3)) for part in "pv"]


class Trajectories(Made):
    def test_are_those_of_up_to_the_last_bit_with_a_step_back_in_the_middle(self):
        config = ROOT / "configs/leaderless.toml"
        flown = self.up(config)
        ticks = len(flown["t"]) - 1
        for fmu in self.both(team=config):
            with fmu.instance() as team:
                team.start()
                for tick in range(ticks + 1):
                    p, v = rows(team, 4)
                    self.assertTrue(numpy.array_equal(p, flown["position"][tick]), tick)
                    self.assertTrue(numpy.array_equal(v, flown["velocity"][tick]), tick)
                    if tick == ticks // 4:
                        kept = team.state()
                    if tick == ticks // 2:
                        team.restore(kept)
                        self.assertEqual(team.get("tick"), [ticks // 4])
                        for again in range(ticks // 4, ticks // 2):
                            self.assertTrue(numpy.array_equal(rows(team, 4)[0], flown["position"][again]), again)
                            self.assertFalse(team.step(0.01))
                        self.assertTrue(numpy.array_equal(rows(team, 4)[0], flown["position"][tick]))
                    self.assertEqual(team.get("over"), [tick == ticks])
                    self.assertEqual(team.step(0.01), tick == ticks)
                self.assertAlmostEqual(team.time, ticks / 100, delta=1e-9)
                team.call("Terminate")

    def test_over_dds_too(self):
        flown = self.up(self.team)
        for fmu in self.both():
            with fmu.instance() as team:
                team.set({"engine": "dds"})
                team.start()
                for tick in range(20):
                    if tick == 10:
                        kept = team.state()
                    self.assertTrue(numpy.array_equal(rows(team, 3)[0], flown["position"][tick]), tick)
                    team.step(0.01)
                team.restore(kept)
                self.assertTrue(numpy.array_equal(rows(team, 3)[0], flown["position"][10]))

    def test_attitude_and_angular_velocity_too(self):
        self.team.write_text(TEAM.replace("double_integrator", "quadrotor"))
        flown = self.up(self.team)
        for fmu in self.both():
            with fmu.instance() as team:
                team.start()
                team.step(0.3)
                attitude = numpy.reshape(team.get(*names("attitude", 4, 3)), (3, 4))
                w = numpy.reshape(team.get(*names("w", 3, 3)), (3, 3))
            recorded = flown["orientation"][30]  # w, x, y, z
            sign = numpy.where(recorded[:, :1] < 0, -1.0, 1.0)
            self.assertTrue(numpy.array_equal(attitude, sign * recorded[:, [1, 2, 3, 0]]))
            self.assertTrue(numpy.array_equal(w, flown["angular_velocity"][30]))

    def test_steps_of_any_length_fly_the_ticks_up_to_their_end(self):
        flown = self.up(self.team)["position"]
        for fmu in self.both():
            with fmu.instance() as team:
                team.start()
                for step, tick in ((0.004, 0), (0.005, 0), (0.001, 1), (0.025, 3), (0.0001, 3), (0.2149, 25), (0.25, 50)):
                    self.assertFalse(team.step(step))
                    self.assertEqual(team.get("tick"), [tick])
                    self.assertTrue(numpy.array_equal(rows(team, 3)[0], flown[tick]))
                self.assertTrue(team.step(0.01))

    def test_end_at_the_last_tick_or_where_a_tool_must_go_on_to(self):
        for fmu in self.both():
            for early_return, end_s in ((True, 0.5), (False, 0.5 if fmu.version == 2 else 0.7)):
                with fmu.instance(early_return=early_return) as team:
                    team.start()
                    self.assertTrue(team.step(0.7))
                    self.assertEqual((team.time, team.get("time"), team.get("tick")), (end_s, [end_s], [50]))

    def test_begin_at_the_start_time_of_the_tool(self):
        for fmu in self.both():
            with fmu.instance() as team:
                team.enter(start_s=7.5)
                team.call("ExitInitializationMode")
                self.assertEqual(team.get("time"), [7.5])
                team.step(0.1)
                self.assertEqual(team.get("tick"), [10])
                self.assertAlmostEqual(team.get("time")[0], 7.6, delta=1e-12)

    def test_figures_and_who_was_heard_and_lost(self):
        self.team.write_text(TEAM.replace('topology = "complete"', "edges = [[2, 1], [3, 2]]") +
                             '[[events]]\nat_s = 0.1\nfault = { agent = 3, kind = "kill" }\n')
        self.team.write_text(self.team.read_text().replace("[agents]", 'on_agent_loss = "drop"\n[agents]'))
        for fmu in self.both():
            with fmu.instance() as team:
                team.start()
                self.assertEqual(team.get("separation_m"), [3.0])
                self.assertEqual(team.get(*names("heard", 3, 3)), [0, 0, 0, 1, 0, 0, 0, 1, 0])
                self.assertEqual(team.get("agent[1].heard_count", "agent[2].heard_count"), [0, 1])
                team.step(0.2)
                self.assertEqual(team.get(*(f"agent[{id}].lost" for id in (1, 2, 3))), [False, False, True])


class Parameters(Made):
    def test_seed_is_that_of_the_run(self):
        self.team.write_text(TEAM.replace("position_m = [[0, 0, 1], [4, 0, 1], [0, 3, 1]]",
                                          "random = { min_m = [0, 0, 1], max_m = [9, 9, 3] }"))
        for fmu in self.both():
            with fmu.instance() as team:
                team.enter()
                first = rows(team, 3)[0]
                team.set({"seed": 5})  # the episode begins again
                self.assertTrue(numpy.array_equal(rows(team, 3)[0], self.up(self.team, "--seed", 5)["position"][0]))
                self.assertFalse(numpy.array_equal(rows(team, 3)[0], first))
                self.refused(f"fmi{fmu.version}Set{team.TYPES['Integer'][0]}: seed: expected at least 0, got -1", team.set,
                             {"seed": -1})

    def test_tunable_ones_change_the_flight_from_the_next_tick_on(self):
        event = '[[events]]\nat_s = 0.11\nset = { "law.p_gain" = 0.9, "law.offsets_m" = [[0, 0, 0], [7, 0, 0], [0, 2, 0]] }\n'
        events = self.folder / "events.toml"
        events.write_text(TEAM + event)
        flown = self.up(events)["position"]
        for fmu in self.both():
            self.assertEqual(fmu.variables["law.p_gain"].variability, "tunable")
            with fmu.instance() as team:
                team.start()
                team.step(0.1)
                team.set({"law.p_gain": 0.9, "law.offsets_m[2,1]": 7.0})
                team.step(0.4)
                self.assertTrue(numpy.array_equal(rows(team, 3)[0], flown[50]))

    def test_before_the_first_step_they_are_those_of_the_run(self):
        flown = self.up(self.team, "--set", "law.p_gain=0.9")["position"]
        for fmu in self.both():
            with fmu.instance() as team:
                team.start(**{"law.p_gain": 0.9})
                team.step(0.5)
                self.assertTrue(numpy.array_equal(rows(team, 3)[0], flown[50]))

    def test_a_wrong_value_is_an_error_in_the_words_of_serve(self):
        for fmu in self.both():
            with fmu.instance() as team:
                team.start()
                team.set({"law.p_gain": -1.0})
                with self.assertRaises(fmi.FmiError) as caught:
                    team.step(0.01)
                self.assertEqual(caught.exception.status, fmi.ERROR)
                self.assertIn("law.p_gain: expected a number in", team.words())
                self.refused(f"fmi{fmu.version}DoStep: not after an error", team.step, 0.01)
                team.call("Reset")
                team.start()
                self.assertFalse(team.step(0.01))

    def test_names_are_short_and_unique_and_have_units_and_descriptions(self):
        for config in sorted((ROOT / "configs").glob("*.toml")):
            if config.stem in ("leaderless", "affine_formation", "flocking", "platoon", "event_triggered"):
                fmu = self.fmu(3, team=config)
                for name, variable in fmu.variables.items():
                    self.assertLessEqual(len(name), 55, name)
                    self.assertTrue(variable.description, name)
                units = {unit.get("name") for unit in fmu.description.iter("Unit")}
                used = {variable.unit for variable in fmu.variables.values() if variable.unit}
                self.assertEqual(units, used)
        self.assertEqual(fmu.variables["control.max_acceleration_m_per_s2"].unit, "m/s^2")
        base = {unit.get("name"): unit[0].attrib for unit in fmu.description.iter("Unit")}
        self.assertEqual(base["m/s^2"], {"m": "1", "s": "-2"})

    def test_engine_is_that_of_serve(self):
        for fmu in self.both():
            with fmu.instance() as team:
                self.refused(f'fmi{fmu.version}SetString: engine: expected "inprocess" or "dds", got "x"', team.set,
                             {"engine": "x"})
                team.set({"engine": "dds"})
                self.assertEqual(team.get("engine") if fmu.version == 3 else ["dds"], ["dds"])


class Ports(Made):
    ACTIONS = [[0.5, 0, 0], [0, -0.25, 0.125]]

    def test_drive_agents_as_steps_of_serve_do(self):
        for fmu in self.both("--ports", "1,3"):
            inputs = [name for name, variable in fmu.variables.items() if variable.causality == "input"]
            self.assertEqual(inputs, [f"agent[{id}].wanted_acceleration[{n}]" for id in (1, 3) for n in (1, 2, 3)])
            self.assertEqual({fmu.variables[name].unit for name in inputs}, {"m/s^2"})
            with fmu.instance() as team, server(self.team, "--ports", "1,3") as address:
                with Served(address) as served:
                    team.start()
                    for actions, ticks in ((self.ACTIONS, 3), (self.ACTIONS[::-1], 1), (None, 10)):
                        if actions:
                            team.set(dict(zip(inputs, sum(actions, []))))
                        team.step(ticks / 100)
                        state = served.ask("step", actions=actions, ticks=ticks)
                        p, v = rows(team, 3)
                        self.assertEqual((p.tolist(), v.tolist()), (state["p"], state["v"]))

    def test_an_input_counts_from_the_first_tick_that_is_not_earlier(self):
        for fmu in self.both("--ports", "1"):
            wanted = "agent[1].wanted_acceleration[1]"
            with fmu.instance() as team, fmu.instance() as late:
                team.start()
                late.start()
                team.step(0.015)
                team.set({wanted: 1.0})
                team.step(0.015)  # ticks 1 and 2: the input was set after tick 1
                late.step(0.02)
                late.set({wanted: 1.0})
                late.step(0.01)
                self.assertEqual(team.get("tick"), late.get("tick"))
                self.assertEqual(rows(team, 3)[1].tolist(), rows(late, 3)[1].tolist())
                self.assertGreater(team.get("agent[1].v[1]")[0], 0)

    def test_velocities_are_inputs_of_laws_that_want_them(self):
        self.team.write_text(re.sub(r'"formation"\noffsets.*', '"actions"\noutput = "velocity"', TEAM))
        for fmu in self.both():
            self.assertEqual(fmu.variables["agent[3].wanted_velocity[2]"].unit, "m/s")

    def test_numbers_that_are_not_finite_are_refused(self):
        for fmu in self.both("--ports", "1"):
            with fmu.instance() as team:
                team.start()
                real = team.TYPES["Real"][0]
                self.refused(f"fmi{fmu.version}Set{real}: agent[1].wanted_acceleration[1]: expected a finite number",
                             team.set, {"agent[1].wanted_acceleration[1]": float("nan")})


class States(Made):
    def test_have_inputs_parameters_and_time(self):
        for fmu in self.both("--ports", "1"):
            wanted = "agent[1].wanted_acceleration[1]"
            with fmu.instance() as team:
                team.start()
                team.set({wanted: 0.5})
                team.step(0.055)
                team.set({wanted: -0.5, "law.p_gain": 0.7})  # not yet given to the server
                kept = team.state()
                team.step(0.1)
                first = rows(team, 3)
                team.set({wanted: 0.0, "law.p_gain": 0.1})
                team.step(0.1)
                team.restore(kept)
                self.assertEqual((team.get(wanted), team.get("law.p_gain"), team.get("tick")), ([-0.5], [0.7], [5]))
                self.assertAlmostEqual(team.get("time")[0], 0.055, delta=1e-12)
                team.step(0.1)
                self.assertEqual(numpy.array(rows(team, 3)).tolist(), numpy.array(first).tolist())
                team.forget(kept)

    def test_travel_as_bytes_to_another_instance(self):
        for fmu in self.both("--ports", "1"):
            with fmu.instance() as team, fmu.instance("other") as other:
                team.start()
                team.set({"agent[1].wanted_acceleration[2]": 0.5})
                team.step(0.1)
                kept = team.state()
                data = team.serialize(kept)
                team.step(0.2)
                other.restore(other.deserialize(data, time=kept[1]))  # which was not even initialized
                self.assertEqual(other.get("tick"), [10])
                other.step(0.2)
                self.assertEqual(numpy.array(rows(team, 3)).tolist(), numpy.array(rows(other, 3)).tolist())
                for wrong in (data[:-100000], data[:40], b"x" + data[1:], data[:60]):
                    self.refused("expected the bytes of a state of this FMU, got others", other.deserialize, wrong)

    def test_are_as_many_as_the_tool_likes(self):
        for fmu in self.both():
            with fmu.instance() as team:
                team.start()
                kept = []
                for tick in range(30):
                    kept += [team.state() for _ in range(10)]
                    team.step(0.01)
                at_the_end = rows(team, 3)[0].tolist()
                for tick in (0, 12, 29):
                    team.restore(kept[10 * tick + 5])
                    self.assertEqual(team.get("tick"), [tick])
                    team.step(0.3 - tick / 100)
                    self.assertEqual(rows(team, 3)[0].tolist(), at_the_end)

    def test_outlive_the_server(self):
        for fmu in self.both():
            with fmu.instance() as team:
                team.start()
                team.step(0.1)
                kept = team.state()
                team.step(0.1)
                after = rows(team, 3)[0].tolist()
                team.call("Terminate")
                self.assertEqual(children(), [])
                team.restore(kept)
                team.step(0.1)
                self.assertEqual(rows(team, 3)[0].tolist(), after)
                team.call("Reset")
                team.restore(kept)
                self.assertEqual(team.get("tick"), [10])

    def test_of_others_are_refused(self):
        for fmu in self.both():
            with fmu.instance() as team, fmu.instance("other") as other:
                kept = team.state()
                self.refused("this is no state of this instance", other.restore, kept)
                self.refused("this is no state of this instance", other.serialize, kept)
                self.refused("this is no state of this instance", other.forget, kept)


class Calls(Made):
    def test_in_a_wrong_state_are_errors(self):
        for fmu in self.both():
            say = f"fmi{fmu.version}"
            with fmu.instance() as team:
                self.refused(f"{say}DoStep: not before its initialization", team.step, 0.1)
                self.refused(f"{say}ExitInitializationMode: not before its initialization", team.call,
                             "ExitInitializationMode")
                self.refused(f"{say}Terminate: not before its initialization", team.call, "Terminate")
                team.enter()
                self.refused(f"{say}DoStep: not in its initialization", team.step, 0.1)
                team.call("ExitInitializationMode")
                first = "EnterInitializationMode" if fmu.version == 3 else "SetupExperiment"
                self.refused(f"{say}{first}: not between steps", team.enter)
                self.refused(f"{say}SetString: address is fixed once the initialization is over", team.set, {"address": "x"})
                self.refused(f"{say}Set{team.TYPES['Real'][0]}: agent[1].p[1] is an output, which cannot be set", team.set,
                             {"agent[1].p[1]": 0.0})
                team.call("Terminate")
                self.refused(f"{say}DoStep: not after its end", team.step, 0.1)
                self.assertEqual(team.get("tick"), [0])

    def test_with_wrong_references_are_errors(self):
        for fmu in self.both():
            fmu.variables["unknown"] = fmi.Variable("unknown", 99999, "Real")
            fmu.variables["wrong"] = fmi.Variable("wrong", fmu.variables["tick"].reference, "Real")
            with fmu.instance() as team:
                team.start()
                real, integer = team.TYPES["Real"][0], team.TYPES["Integer"][0]
                self.refused(f"fmi{fmu.version}Get{real}: no variable has the value reference 99999", team.get, "unknown")
                self.refused(f"fmi{fmu.version}Get{real}: tick is a {integer}, not a {real}", team.get, "wrong")

    def test_of_steps_that_cannot_be_are_errors(self):
        for fmu in self.both():
            for step, words in ((0.0, "a step must be longer than 0 s, got 0 s"),
                                (-1.0, "a step must be longer than 0 s, got -1 s")):
                with fmu.instance() as team:
                    team.start()
                    self.refused(words, team.step, step)
            with fmu.instance() as team:
                team.start()
                team.time = 0.3
                self.refused("a step must begin at 0 s, where the one before has ended, not at 0.29999999999999999 s",
                             team.step, 0.1)

    def test_that_make_no_instance_say_why(self):
        for fmu in self.both():
            for arguments, words in (
                    ({"token": "x"}, f"the FMU's token is {fmu.token}, got x"),
                    ({"name": ""}, "expected the name of an instance, got none"),
                    ({"resources": "/nowhere"}, "/nowhere/variables.txt: no variables of an FMU of MASCOT can be read there")):
                with self.assertRaises(fmi.FmiError) as caught:
                    fmu.instance(**arguments)
                self.assertIn(words, str(caught.exception))

    def test_many_instances_leave_nothing_behind(self):
        for fmu in self.both():
            for _ in range(1000):
                fmu.instance().free()
            self.assertLessEqual(descriptors(), self.descriptors)

    def test_two_instances_fly_at_once(self):
        for fmu in self.both():
            with fmu.instance("a") as a, fmu.instance("b") as b:
                a.enter()
                b.enter()  # both servers start
                self.assertEqual(len(children()), 2)
                b.set({"law.p_gain": 0.9})
                a.call("ExitInitializationMode")
                b.call("ExitInitializationMode")
                a.step(0.3)
                b.step(0.3)
                self.assertNotEqual(rows(a, 3)[0].tolist(), rows(b, 3)[0].tolist())

    def test_log_what_the_tool_wants_to_hear(self):
        for fmu in self.both():
            with fmu.instance() as team:
                category = fmi.c_char_p(b"logNothing")
                categories = (fmi.c_char_p * 1)(category)
                self.refused('there is no log category "logNothing"', team.call, "SetDebugLogging", fmi.c_int(1),
                             fmi.c_size_t(1), categories)
            for logging in (False, True):
                with fmu.instance(logging=logging) as team:
                    team.start()
                    self.assertTrue(team.step(1.0))
                    wanted = [(fmi.DISCARD, "logStatusDiscard", "the episode is over at 0.5 s")] if fmu.version == 2 else []
                    self.assertEqual(team.messages, wanted if logging else [])


class Served:
    """A client of `orchestrator serve` in JSON."""

    def __init__(self, address):
        host, port = address.rsplit(":", 1)
        self.socket = socket.create_connection((host, int(port)), timeout=LIMIT_S)
        self.file = self.socket.makefile("rw")

    def __enter__(self):
        self.ask("hello", protocol=1)
        return self

    def __exit__(self, *_):
        self.file.close()
        self.socket.close()

    def ask(self, kind, **fields):
        print(json.dumps({"request": kind, **fields}), file=self.file, flush=True)
        return json.loads(self.file.readline())


@contextlib.contextmanager
def server(*arguments):
    """The address of a server, which must end when its client is gone."""
    command = [ORCHESTRATOR, "serve", *map(str, arguments), "--at", "127.0.0.1:0", "--json", "--once"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        try:
            yield json.loads(process.stdout.readline())["address"]
        finally:
            try:
                process.wait(timeout=LIMIT_S)
            except subprocess.TimeoutExpired:
                process.kill()
                raise


class Servers(Made):
    def test_at_an_address_are_joined(self):
        flown = self.up(self.team)["position"]
        for fmu in self.both():
            with server(self.team) as address:
                with fmu.instance() as team:
                    team.start(address=address)
                    team.step(0.5)
                    self.assertTrue(numpy.array_equal(rows(team, 3)[0], flown[50]))

    def test_of_another_team_are_refused(self):
        other = self.folder / "other.toml"
        other.write_text(TEAM.replace('"team"', '"other"'))
        for fmu in self.both():
            with server(other) as address:
                with fmu.instance() as team:
                    with self.assertRaises(fmi.FmiError):
                        team.start(address=address)
                    self.assertEqual(team.words(),
                                     'the server has another team: "name" is "other", and "team" in this FMU')

    def test_that_are_not_there_are_errors(self):
        free = socket.create_server(("127.0.0.1", 0))
        port = free.getsockname()[1]
        free.close()
        for fmu in self.both():
            for values, words in (
                    ({"address": f"127.0.0.1:{port}"},
                     f"address: no server answers at 127.0.0.1:{port}: Connection refused"),
                    ({"address": "nobody"}, 'address: expected ADDRESS:PORT, got "nobody"'),
                    ({"address": "no host:1"}, 'address: no host or port has the name "no host:1"'),
                    ({"orchestrator": "/nowhere/orchestrator"},
                     'cannot start "/nowhere/orchestrator": No such file or directory; the parameter "orchestrator" names '
                     'the program, or "address" a server'),
                    ({"orchestrator": "/bin/false"}, "orchestrator serve: it ended without a word"),
                    ({"orchestrator": "/bin/echo"}, "orchestrator serve: serve ")):
                with fmu.instance() as team:
                    with self.assertRaises(fmi.FmiError) as caught:
                        team.start(**values)
                    self.assertEqual(caught.exception.status, fmi.ERROR)
                    self.assertTrue(team.words().startswith(words), (team.words(), words))

    def test_that_do_not_answer_are_waited_for_as_long_as_timeout_s_says(self):
        for fmu in self.both():
            with socket.create_server(("127.0.0.1", 0)) as silent:
                with fmu.instance() as team:
                    with self.assertRaises(fmi.FmiError) as caught:
                        team.start(address="127.0.0.1:%d" % silent.getsockname()[1], timeout_s=0.2)
                    self.assertEqual((caught.exception.status, team.words()),
                                     (fmi.FATAL, "the server has not answered within timeout_s = 0.2 s"))
                with fmu.instance() as team:
                    self.refused(f"fmi{fmu.version}Set{team.TYPES['Real'][0]}: timeout_s: expected a number in (0, 86400], "
                                 "got 0", team.set, {"timeout_s": 0.0})

    def test_that_end_before_anything_is_asked_are_started_again(self):
        for fmu in self.both("--set", "run.start_timeout_s=1"):
            with fmu.instance() as team:
                team.enter()
                [child] = children()
                handle = os.pidfd_open(int(child))
                self.assertTrue(select.select([handle], [], [], LIMIT_S)[0])  # it waits for a client for 2 s
                os.close(handle)
                team.call("ExitInitializationMode")
                self.assertFalse(team.step(0.1))

    def test_that_are_killed_end_the_fmu_with_words(self):
        for fmu in self.both():
            with fmu.instance() as team:
                team.start()
                team.step(0.1)
                [child] = children()
                os.kill(int(child), signal.SIGKILL)
                self.refused("the server has ended", team.step, 0.1, status=fmi.FATAL)
                self.assertEqual(team.messages[-1][:2], (fmi.FATAL, "logStatusFatal"))
                self.refused("the server has ended", team.call, "Reset", status=fmi.FATAL)
                self.assertEqual(children(), [])

    def test_end_with_the_tool_even_if_it_is_killed(self):
        fmu = self.fmu(2)
        del fmu
        code = ("import sys, fmi\nteam = fmi.Fmu(sys.argv[1], sys.argv[2]).instance()\nteam.start()\n"
                "print(open(f'/proc/self/task/{__import__(\"os\").getpid()}/children').read(), flush=True)\ninput()\n")
        with subprocess.Popen([sys.executable, "-c", code, self.folder / "1.fmu", self.folder / "tool"], text=True,
                              stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                              env={**os.environ, "PYTHONPATH": str(pathlib.Path(__file__).resolve().parent)}) as tool:
            served = int(tool.stdout.readline())
            handle = os.pidfd_open(served)
            tool.kill()
            tool.wait(timeout=LIMIT_S)
            ended, _, _ = select.select([handle], [], [], LIMIT_S)
            os.close(handle)
            self.assertTrue(ended)

    def test_whose_law_fails_end_the_episode_with_its_words(self):
        self.team.write_text(TEAM[:TEAM.index("[law]")] + '''[law]
name = "custom"
python = """
def control(t, me, neighbours):
    return (0, 0, 0) if t < 0.1 else 1 / 0
"""
''')
        for fmu in self.both():
            with fmu.instance() as team:
                team.start()
                with self.assertRaises(fmi.FmiError) as caught:
                    team.step(0.4)
                self.assertEqual(caught.exception.status, fmi.ERROR)
                self.assertIn("division by zero", team.words())


class Files(Made):
    def test_are_as_fmi_wants_them(self):
        for version, binary in ((2, "linux64"), (3, "x86_64-linux")):
            self.fmu(version)
            path = self.folder / f"{self.count}.fmu"
            with zipfile.ZipFile(path) as archive:
                self.assertIsNone(archive.testzip())
                entries = archive.infolist()
            got = {entry.filename for entry in entries}
            expected = {"modelDescription.xml", "sources/team_fmu.c", "resources/experiment.toml", "resources/variables.txt"}
            expected |= {"sources/buildDescription.xml"} if version == 3 else set()
            self.assertEqual({re.sub("binaries/aarch64-linux", f"binaries/{binary}", name) for name in got},
                             expected | {f"binaries/{binary}/team.so"})
            self.assertEqual(len(got), len(entries))
            for entry in entries:
                self.assertLessEqual(entry.extract_version, 20)
                self.assertIn(entry.compress_type, (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED))
                self.assertEqual((entry.extra, entry.external_attr, entry.flag_bits), (b"", 0, 0))
            self.assertNotIn(struct.pack("<I", 0x06064b50), path.read_bytes()[-1000:])  # no end in zip64 form
            with zipfile.ZipFile(path) as archive:
                self.assertEqual(archive.read("sources/team_fmu.c"), (ROOT / "orchestrator/fmu/team_fmu.c").read_bytes())

    def test_are_the_same_bytes_again_and_their_token_is_theirs(self):
        tokens = set()
        for version in (2, 3):
            fmu = self.fmu(version)
            self.fmu(version)
            first, second = (self.folder / f"{number}.fmu" for number in (self.count - 1, self.count))
            self.assertEqual(first.read_bytes(), second.read_bytes())
            tokens |= {fmu.token, self.fmu(version, "--seed", "2").token, self.fmu(version, "--ports", "1").token}
        self.assertEqual(len(tokens), 6)

    def test_fly_the_team_that_was_set_for_good(self):
        flown = self.up(self.team, "--set", "law.p_gain=0.9", "--seed", 3)["position"]
        for fmu in self.both("--set", "law.p_gain=0.9", "--seed", 3):
            self.assertEqual((fmu.variables["law.p_gain"].start, fmu.variables["seed"].start), ("0.9", "3"))
            with fmu.instance() as team:
                team.start()
                team.step(0.5)
                self.assertTrue(numpy.array_equal(rows(team, 3)[0], flown[50]))

    def test_descriptions_have_the_structure_of_fmi(self):
        for version in (2, 3):
            fmu = self.fmu(version, "--ports", "1")
            files = {"modelDescription.xml": f"fmi{version}.xsd"}
            files |= {"sources/buildDescription.xml": "fmi3_build.xsd"} if version == 3 else {}
            for file, schema in files.items():
                done = subprocess.run(["xmllint", "--noout", "--schema", pathlib.Path(__file__).parent / schema,
                                       fmu.folder / file], capture_output=True, text=True, timeout=LIMIT_S)
                self.assertEqual((done.returncode, done.stderr), (0, f"{fmu.folder / file} validates\n"))

    def test_descriptions_say_what_the_fmu_can(self):
        for fmu in self.both("--ports", "1"):
            state = "FMUstate" if fmu.version == 2 else "FMUState"
            for can in ("needsExecutionTool", "canHandleVariableCommunicationStepSize", f"canGetAndSet{state}",
                        f"canSerialize{state}"):
                self.assertEqual(fmu.interface.get(can), "true", can)
            experiment = fmu.description.find("DefaultExperiment")
            self.assertEqual((experiment.get("stopTime"), experiment.get("stepSize")), ("0.5", "0.01"))
            if fmu.version == 3:
                self.assertEqual(fmu.interface.get("fixedInternalStepSize"), "0.01")
            outputs = [variable for variable in fmu.variables.values() if variable.causality == "output"]
            structure = fmu.description.find("ModelStructure")
            if fmu.version == 2:
                order = list(fmu.variables.values())
                listed = [order[int(unknown.get("index")) - 1] for unknown in structure.find("Outputs")]
                initial = [order[int(unknown.get("index")) - 1] for unknown in structure.find("InitialUnknowns")]
            else:
                by_reference = {variable.reference: variable for variable in fmu.variables.values()}
                listed, initial = ([by_reference[int(unknown.get("valueReference"))] for unknown in structure.findall(tag)]
                                   for tag in ("Output", "InitialUnknown"))
            self.assertEqual(listed, outputs)
            self.assertEqual(initial, outputs)

    def test_sources_are_c_of_1999_for_any_tool(self):
        fmu = self.fmu(3)
        source = fmu.folder / "sources/team_fmu.c"
        built = self.folder / "built.so"
        for prefix in ("", "team_"):
            options = [f"-DFMI2_FUNCTION_PREFIX={prefix}", f"-DFMI3_FUNCTION_PREFIX={prefix}"] if prefix else []
            done = subprocess.run(["cc", "-std=c99", "-pedantic-errors", "-Wall", "-Wextra", "-Werror", "-fPIC", "-shared",
                                   "-fvisibility=hidden", *options, source, "-o", built], capture_output=True, text=True,
                                  timeout=LIMIT_S)
            self.assertEqual((done.returncode, done.stderr), (0, ""))
            symbols = subprocess.run(["nm", "-D", "--defined-only", built], capture_output=True, text=True, check=True,
                                     timeout=LIMIT_S).stdout.split()[2::3]
            self.assertTrue(all(symbol.startswith((f"{prefix}fmi2", f"{prefix}fmi3")) for symbol in symbols), symbols)
        needed = subprocess.run(["readelf", "-d", *fmu.folder.glob("binaries/*/team.so")], capture_output=True, text=True,
                                check=True, timeout=LIMIT_S).stdout
        self.assertEqual(set(re.findall(r"NEEDED.*\[(\S+)\]", needed)) - {"libc.so.6", "libm.so.6"}, set())


class Verb(Made):
    def test_says_what_it_has_made(self):
        done = make(self.team, "--out", self.folder / "a.fmu", "--ports", "2")
        self.assertRegex(done.stdout, r"a.fmu: team, 3 agents, as an FMU of FMI 2.0 with 3 inputs, \d+ outputs and \d+ tunable "
                                      r"parameters\n$")
        done = make(self.team, "--out", self.folder / "a.fmu", "--fmi", "3", "--json")
        about = json.loads(done.stdout)
        self.assertEqual((about["fmu"], about["fmi"], about["inputs"]), (str(self.folder / "a.fmu"), 3, 0))

    def test_refuses_what_it_cannot_make(self):
        out = self.folder / "a.fmu"
        for arguments, words in (
                ([self.team, "--out", self.folder / "a.zip"],
                 f"error: --out {self.folder}/a.zip: expected the name of a file that ends in .fmu\n"),
                ([self.team, "--out", self.folder / "no/a.fmu"],
                 f"error: --out {self.folder}/no/a.fmu: expected a file in a folder that exists\n"),
                ([self.team, "--out", out, "--seed", "3000000000"],
                 "error: seed: expected at most 2147483647, the largest integer of FMI 2, got 3000000000: give another, or "
                 "make the FMU with --fmi 3\n")):
            done = make(*arguments)
            self.assertEqual((done.returncode, done.stderr), (2, words))
        for arguments, words in (([self.team, "--out", out, "--ports", "9"], "9"),
                                 ([self.team, "--out", out, "--fmi", "1"], "--fmi"),
                                 ([self.team], "--out is required"),
                                 ([self.team, "--out", out, "--set", "law.p_gain=-1"], "law.p_gain: expected a number")):
            done = make(*arguments)
            self.assertEqual(done.returncode, 2)
            self.assertIn(words, done.stderr)
        self.assertFalse(out.exists())
        self.assertEqual(make(self.team, "--out", out, "--seed", "3000000000", "--fmi", "3").returncode, 0)


if __name__ == "__main__":
    unittest.main()

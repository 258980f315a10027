#!/usr/bin/python3
"""Steps teams over the socket of `orchestrator serve`, as docs/serve.md says, and compares with runs of `up`."""

import contextlib
import json
import os
import pathlib
import shutil
import signal
import socket
import struct
import subprocess
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]
ORCHESTRATOR = pathlib.Path(os.environ["MASCOT_BINARY_DIR"]) / "orchestrator"
LIMIT_S = 60
NO_CODE = ("set {}: expected numbers, true, false, or one of the key's names: texts and tables are given to "
           "`orchestrator serve --set`, not by clients")
TEAM = """[run]
name = "team"
duration_s = 0.5
[agents]
count = 3
position_m = [[0, 0, 1], [4, 0, 1], [0, 3, 1]]
[graph]
topology = "complete"
[law]
name = "consensus"
"""


class Client:
    """One connection, which has said hello."""

    def __init__(self, address, **hello):
        host, port = address.rsplit(":", 1)
        self.socket = socket.create_connection((host, int(port)), timeout=LIMIT_S)
        self.file = self.socket.makefile("rwb")
        self.is_binary = False
        self.about = self.ask("hello", protocol=1, **hello)
        self.is_binary = hello.get("form") == "binary"

    def send(self, kind, **fields):
        text = json.dumps({"request": kind, **fields}).encode()
        self.file.write(struct.pack("<IB", 1 + len(text), ord("J")) + text if self.is_binary else text + b"\n")
        self.file.flush()

    def receive(self):
        if not self.is_binary:
            return json.loads(self.file.readline())
        kind, content = self.frame()
        assert kind == "J", kind
        return json.loads(content)

    def frame(self):
        length, kind = struct.unpack("<IB", self.file.read(5))
        return chr(kind), self.file.read(length - 1)

    def ask(self, kind, **fields):
        self.send(kind, **fields)
        return self.receive()

    def step(self, ticks, *actions):
        """A step in the binary form: tick, flags, figures, and for each agent its numbers, whether it is lost, whom it heard."""
        self.file.write(struct.pack(f"<IBI{len(actions)}d", 5 + 8 * len(actions), ord("S"), ticks, *actions))
        self.file.flush()
        kind, content = self.frame()
        if kind == "J":
            return json.loads(content)
        tick, flags, agents, figures = struct.unpack_from("<qIII", content)
        at = 20
        values = struct.unpack_from(f"<{figures}d", content, at)
        at += 8 * figures
        team = []
        for _ in range(agents):
            numbers = struct.unpack_from("<13d", content, at)
            lost, heard = struct.unpack_from("<II", content, at + 104)
            team.append((numbers, lost, struct.unpack_from(f"<{heard}I", content, at + 112)))
            at += 112 + 4 * heard
        assert at == len(content), (at, len(content))
        return tick, flags, values, team

    def close(self):
        self.file.close()
        self.socket.close()


class Served(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory(prefix="mascot-serve-")))
        self.team = self.folder / "team.toml"
        self.team.write_text(TEAM)

    @contextlib.contextmanager
    def server(self, *arguments, once=True):
        """The address of a server, and its process, which must have ended in order when the clients are gone."""
        command = [ORCHESTRATOR, "serve", *map(str, arguments), "--at", "127.0.0.1:0", "--json"] + ["--once"] * once
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
            try:
                yield json.loads(process.stdout.readline())["address"], process
            finally:
                if not once:
                    process.send_signal(signal.SIGINT)
                try:
                    self.code = process.wait(timeout=LIMIT_S)
                except subprocess.TimeoutExpired:
                    process.kill()
                    raise

    @contextlib.contextmanager
    def client(self, *arguments, **hello):
        with self.server(*arguments) as (address, _):
            client = Client(address, **hello)
            try:
                yield client
            finally:
                client.ask("step", ticks=0)  # so that it is the one that steps, whose end ends the server
                client.close()

    def up(self, *arguments, engine="inprocess"):
        out = self.folder / f"up_{engine}"
        subprocess.run([ORCHESTRATOR, "up", *map(str, arguments), "--engine", engine, "--quiet", "--out", out], check=True,
                       timeout=LIMIT_S)
        return out


class Recordings(Served):
    def test_are_those_of_up_in_both_engines(self):
        with self.client(self.team, "--out", self.folder / "episodes", "--set", "output.save_plot=false") as client:
            last = client.ask("step", ticks=1000)
        self.assertTrue(last["over"])
        self.assertEqual((last["tick"], last["recording"]), (50, str(self.folder / "episodes/1")))
        for engine in ("inprocess", "dds"):
            run = self.up(self.team, "--set", "output.save_plot=false", engine=engine)
            for file in ("run.mcap", "states.npz"):
                self.assertEqual((run / file).read_bytes(), (self.folder / "episodes/1" / file).read_bytes(), file)

    def test_of_actions_are_verified(self):
        with self.client(self.team, "--ports", "1,3", "--out", self.folder / "episodes") as client:
            client.ask("step", actions=[[1, 0, 0], [0, -1, 0]], ticks=20)
            client.ask("set", set={"law.p_gain": 0.5})
            client.ask("step", actions={"3": [0.5, 0, 0]}, ticks=100)
        subprocess.run([ORCHESTRATOR, "verify", self.folder / "episodes/1"], check=True, timeout=LIMIT_S,
                       stdout=subprocess.DEVNULL)

    def test_every_episode_has_one(self):
        with self.client(self.team, "--out", self.folder / "episodes") as client:
            client.ask("step")
            client.ask("reset", seed=7)
            client.ask("step", ticks=1000)
        summaries = [json.loads((self.folder / f"episodes/{k}/summary.json").read_text()) for k in (1, 2)]
        self.assertEqual([summary["exit"] for summary in summaries], [0, 0])


class Steps(Served):
    def test_hello_says_what_there_is(self):
        with self.client(self.team, "--ports", "2") as client:
            about = client.about
        self.assertEqual((about["protocol"], about["agents"], about["ticks"], about["engine"]), (1, 3, 50, "inprocess"))
        self.assertEqual(about["ports"], [{"agent": 2, "numbers": 3, "wants": "acceleration", "unit": "m/s^2"}])
        units = {key["key"]: key["unit"] for key in about["keys"]}
        self.assertEqual((units["law.p_gain"], units["control.max_speed_m_per_s"], units["link.loss"]), ("1/s^2", "m/s", ""))
        self.assertEqual([figure["name"] for figure in about["figures"]], ["disagreement_m", "separation_m"])

    def test_state_is_that_of_the_file_at_first(self):
        with self.client(self.team) as client:
            state = client.ask("look", id="mine")
        self.assertEqual((state["answer"], state["id"], state["tick"], state["over"]), ("look", "mine", 0, False))
        self.assertEqual(state["p"], [[0, 0, 1], [4, 0, 1], [0, 3, 1]])
        self.assertEqual(state["attitude"], [[0, 0, 0, 1]] * 3)
        self.assertEqual(state["heard"], [[2, 3], [1, 3], [1, 2]])
        self.assertEqual(state["figures"]["separation_m"], 3)

    def test_actions_of_ports_move_agents_and_others_fly_by_their_law(self):
        with self.client(self.team, "--set", "agents.model='double_integrator'") as client:
            client.ask("reset", ports=[1])
            flat = client.ask("step", actions=[0.5, 0, 0], ticks=10)
            client.ask("reset")
            self.assertEqual(client.ask("step", actions=[[0.5, 0, 0]], ticks=10), flat)
            client.ask("reset")
            by_id = client.ask("step", actions={"1": [0.5, 0, 0]}, ticks=10)
            client.ask("reset", ports=[])
            by_law = client.ask("step", ticks=10)
        self.assertEqual(by_id, flat)
        self.assertAlmostEqual(flat["v"][0][0], 0.05, delta=1e-12)  # 10 ticks of 0.01 s
        self.assertEqual(flat["v"][0][1], 0)
        self.assertNotEqual(by_law["v"][0][1], 0)

    def test_velocities_are_actions_of_a_law_that_wants_them(self):
        self.team.write_text(TEAM.replace('"consensus"', '"actions"\noutput = "velocity"'))
        with self.client(self.team) as client:
            ports = client.about["ports"]
            state = client.ask("step", actions=[[1, 0, 0], None, [0, 0, 0]], ticks=50)
        self.assertEqual([(port["agent"], port["unit"]) for port in ports], [(1, "m/s"), (2, "m/s"), (3, "m/s")])
        self.assertGreater(state["v"][0][0], 0.1)

    def test_binary_form_has_the_numbers_of_json(self):
        with self.client(self.team, "--ports", "1,2") as client:
            states = [client.ask("step", actions=[[0.5, 0, 0], [0, 0.25, 0]], ticks=ticks) for ticks in (3, 4)]
        with self.client(self.team, "--ports", "1,2", form="binary") as client:
            binary = [client.step(3, 0.5, 0, 0, 0, 0.25, 0), client.step(4)]
        for state, (tick, flags, figures, team) in zip(states, binary):
            self.assertEqual((tick, flags, list(figures)), (state["tick"], 0, list(state["figures"].values())))
            for k, (numbers, lost, heard) in enumerate(team):
                self.assertEqual(list(numbers), state["p"][k] + state["v"][k] + state["attitude"][k] + state["w"][k])
                self.assertEqual((lost, list(heard)), (0, state["heard"][k]))

    def test_resets_with_seeds_and_values(self):
        self.team.write_text(TEAM.replace("position_m = [[0, 0, 1], [4, 0, 1], [0, 3, 1]]",
                                          "random = { min_m = [0, 0, 1], max_m = [9, 9, 3] }"))
        with self.client(self.team, "--seed", "3") as client:
            first = client.ask("look")["p"]
            other = client.ask("reset", seed=4)["p"]
            self.assertEqual(client.ask("reset")["p"], first)
            self.assertNotEqual(other, first)
            fast = client.ask("step", ticks=10)["v"]
            client.ask("reset", set={"law.p_gain": 0.001})
            slow = client.ask("step", ticks=10)["v"]
            self.assertNotEqual(fast, slow)
            client.ask("reset")  # what was set stays
            self.assertEqual(client.ask("step", ticks=10)["v"], slow)
            client.ask("reset", set={})
            self.assertEqual(client.ask("step", ticks=10)["v"], fast)

    def test_events_take_effect_at_the_next_tick(self):
        with self.client(self.team, "--set", "run.on_agent_loss='drop'") as client:
            client.ask("step", ticks=5)
            self.assertEqual(client.ask("set", set={"law.p_gain": 0.5}, agents=[1])["tick"], 6)
            self.assertEqual(client.ask("event", event={"fault": {"agent": 2, "kind": "kill"}})["tick"], 6)
            self.assertEqual(client.ask("step", ticks=5)["lost"], [2])

    def test_goto_sends_a_leader(self):
        self.team.write_text(TEAM.replace('"consensus"', '"waypoint"\nwaypoints_m = [[9, 0, 1]]'))
        with self.client(self.team) as client:
            self.assertEqual(client.ask("goto", agent=1, position_m=[-9, 0, 1]).get("tick"), 1)
            self.assertLess(client.ask("step", ticks=50)["v"][0][0], 0)

    def test_snapshots_come_back_to_the_same_bits(self):
        with self.client(self.team, "--ports", "1") as client:
            client.ask("step", actions=[1, 0, 0], ticks=7)
            number = client.ask("snapshot")["snapshot"]
            text = client.ask("snapshot", form="text")["text"]
            ahead = client.ask("step", actions=[0, 1, 0], ticks=7)
            self.assertEqual(client.ask("restore", snapshot=number)["tick"], 7)
            again = client.ask("step", actions=[0, 1, 0], ticks=7)
            self.assertEqual(client.ask("snapshot", form="text", snapshot=number)["text"], text)
            self.assertEqual(client.ask("snapshot", snapshot=number)["error"],
                             'a snapshot that is kept is given as "form": "text"')
            self.assertEqual(client.ask("forget", snapshot=number), {"answer": "forget"})
            self.assertEqual(client.ask("restore", snapshot=number)["error"], f"there is no snapshot {number}")
        self.assertEqual(again, ahead)
        with self.client(self.team) as client:  # another server of the same experiment
            self.assertEqual(client.ask("restore", text=text)["tick"], 7)
            self.assertEqual(client.ask("step", actions=[0, 1, 0], ticks=7)["p"], ahead["p"])
        with self.client(self.team, "--set", "law.beta=2.0") as client:
            self.assertEqual(client.ask("restore", text=text)["error"],
                             "expected a snapshot of the same file, with the same keys set, got one of another")

    def test_names_of_keys_may_be_set(self):
        with self.client(self.team) as client:
            self.assertNotIn("error", client.ask("reset", set={"law.axes": "xyz", "graph.topology": "ring"}))
            self.assertNotEqual(client.ask("step", ticks=20)["v"][0][0], 0)

    def test_texts_of_snapshots_bring_in_no_code(self):
        with self.client(self.team) as client:
            text = json.loads(client.ask("snapshot", form="text")["text"])
            text["set"] = {"law.python": "import os"}
            self.assertEqual(client.ask("restore", text=json.dumps(text))["error"], NO_CODE.format("law.python"))
            text["set"], text["ports"] = {}, [1, 1]
            self.assertEqual(client.ask("restore", text=json.dumps(text))["error"],
                             "expected a snapshot, got other text: a port twice")
            text["ports"] = [0]
            self.assertEqual(client.ask("restore", text=json.dumps(text))["error"],
                             "expected a snapshot, got other text: ports that are no agents")

    def test_so_many_snapshots_are_kept(self):
        with self.client(self.team) as client:
            self.assertEqual([client.ask("snapshot")["snapshot"] for _ in range(256)], list(range(1, 257)))
            self.assertEqual(client.ask("snapshot")["error"], "256 snapshots are kept: forget one first")


class OverDds(Served):
    """A team of processes is the same as one in the server's process, to the bit."""

    def session(self, engine, do, *arguments):
        """What `do` returns with a client, and the bytes of the recordings of its episodes."""
        out = self.folder / f"episodes_{engine}"
        with self.client(self.team, "--engine", engine, "--out", out, "--set", "output.save_plot=false", *arguments) as client:
            told = do(client)
        self.assertEqual(self.code, 0)
        return told, [(folder / "run.mcap").read_bytes() for folder in sorted(out.iterdir())]

    def both(self, do, *arguments):
        here, there = (self.session(engine, do, *arguments) for engine in ("inprocess", "dds"))
        self.assertEqual(here[0], there[0])
        self.assertEqual(len(here[1]), len(there[1]))
        for one, other in zip(here[1], there[1]):
            self.assertTrue(one == other, "run.mcap differs")
        return there[0]

    def states(self, client, *requests):
        """The answers to these requests; a state without the folder of its recording, whose name has the engine's."""
        answers = [client.ask(kind, **fields) for kind, fields in requests]
        for answer in answers:
            self.assertNotIn("error", answer)
            answer.pop("recording", None)
        return answers

    def test_hello_names_the_engine(self):
        with self.client(self.team, "--engine", "dds") as client:
            self.assertEqual(client.about["engine"], "dds")

    def test_by_their_laws(self):
        last = self.both(lambda client: self.states(client, ("look", {}), ("step", {}), ("step", {"ticks": 7}), ("look", {}),
                                                    ("step", {"ticks": 1000})))[-1]
        self.assertEqual((last["tick"], last["over"]), (50, True))

    def test_with_actions(self):
        def do(client):
            return self.states(client, ("step", {"actions": [[1, 0, 0], [0, -1, 0]], "ticks": 20}),
                               ("set", {"set": {"law.p_gain": 0.5}}), ("goto", {"agent": 2, "position_m": [1, 2, 3]}),
                               ("step", {"actions": {"3": [0.5, 0, 0]}}), ("reset", {"seed": 3, "ports": [2]}),
                               ("step", {"actions": [0, 0, 0.5], "ticks": 5}), ("step", {"ticks": 1000}))
        self.team.write_text(TEAM.replace('"consensus"', '"consensus"\nleader = 2'))
        states = self.both(do, "--ports", "1,3")
        self.assertEqual([states[1]["tick"], states[2]["tick"], states[3]["tick"], states[4]["tick"]], [21, 21, 21, 0])
        subprocess.run([ORCHESTRATOR, "verify", self.folder / "episodes_dds/1"], check=True, timeout=LIMIT_S,
                       stdout=subprocess.DEVNULL)

    def test_with_links_that_lose_and_messages_on_both_deliveries(self):
        self.team.write_text(TEAM.replace('"consensus"', '"actions"\nmessage = 2') +
                             "[link]\nloss = 0.5\ndelay_s = 0.02\n")
        def do(client):
            action = [0.1, 0.2, 0.3, 4.0, 5.0]
            return self.states(client, *[("step", {"actions": [action, None, action]})] * 12)
        for delivery in ("bundled", "topics"):
            heard = [state["heard"] for state in self.both(do, "--set", f"network.delivery='{delivery}'")]
            self.assertGreater(len({json.dumps(one) for one in heard}), 1, "links lose some")
            shutil.rmtree(self.folder / "episodes_dds")
            shutil.rmtree(self.folder / "episodes_inprocess")

    def test_in_which_agents_are_lost_and_come_back(self):
        def do(client):
            return self.states(client, ("step", {"ticks": 3}), ("event", {"event": {"fault": {"agent": 2, "kind": "kill"}}}),
                               ("step", {"ticks": 3}), ("event", {"event": {"restart": 2}}), ("step", {"ticks": 2}))
        states = self.both(do, "--set", "run.on_agent_loss='drop'", "--ports", "1")
        self.assertEqual([states[k]["lost"] for k in (0, 2, 4)], [[], [2], []])
        self.assertEqual(states[2]["heard"][1], [])

    def test_snapshots_come_back_in_either_engine(self):
        with self.client(self.team, "--ports", "1", "--engine", "dds") as client:
            client.ask("step", actions=[1, 0, 0], ticks=7)
            client.ask("set", set={"law.p_gain": 0.5})
            client.ask("step", ticks=2)
            number, text = client.ask("snapshot")["snapshot"], client.ask("snapshot", form="text")["text"]
            ahead = client.ask("step", actions=[0, 1, 0], ticks=7)
            self.assertEqual(client.ask("restore", snapshot=number)["tick"], 9)
            self.assertEqual(client.ask("step", actions=[0, 1, 0], ticks=7), ahead)
        with self.client(self.team) as client:
            self.assertEqual(client.ask("restore", text=text)["tick"], 9)
            self.assertEqual(client.ask("step", actions=[0, 1, 0], ticks=7), ahead)

    def test_nobody_is_late_while_the_client_thinks(self):
        timeout_s = 1
        with self.client(self.team, "--ports", "1", "--engine", "dds", "--set", f"run.agent_timeout_s={timeout_s}") as client:
            client.ask("step", actions=[1, 0, 0], ticks=7)
            thinks_until = time.monotonic() + 1.2 * timeout_s
            while time.monotonic() < thinks_until:
                self.up(self.team, "--force")
            self.assertEqual(client.ask("step", actions=[1, 0, 0])["tick"], 8)

    def test_law_that_fails_is_told_in_words(self):
        self.team.write_text(TEAM.replace('"consensus"', '''"custom"
python = """
def control(t, me, neighbours):
    return [0, 0, 1 / (3 - round(100 * t))]
"""'''))
        with self.client(self.team, "--engine", "dds") as client:
            self.assertIn("ZeroDivisionError", client.ask("step", ticks=10)["error"])
            state = client.ask("look")
            self.assertEqual((state["tick"], state["over"]), (3, True))
            self.assertIn("ZeroDivisionError", state["failure"])
            self.assertEqual(client.ask("step")["error"], "the episode is over: expected a reset")
            self.assertEqual(client.ask("event", event={"cut": [[1, 2]]})["error"], "event by hand: the episode is over")
            self.assertEqual(client.ask("reset")["failure"], "")

    def test_start_that_fails_is_told_in_words(self):
        self.team.write_text(TEAM + "[[hosts]]\nname = 'other'\nagents = '1'\nlaunch = ['false']\n")
        with self.client(self.team, "--engine", "dds") as client:
            self.assertIn("other", client.ask("look")["error"])
            self.assertIn("other", client.ask("step")["error"])

    def test_events_are_refused_in_the_words_of_one_process(self):
        def words(engine):
            with self.client(self.team, "--engine", engine) as client:
                return [client.ask("event", event=event).get("error") for event in (
                    {"set": {"law.p_gian": 1}}, {"cut": [[1, 9]]}, {"at_s": 1, "cut": [[1, 2]]}, {})]
        self.assertEqual(words("dds"), words("inprocess"))

    def test_what_it_cannot_fly_is_refused(self):
        for key, words in (("run.mode='realtime'", 'expected run.mode = "lockstep", got "realtime"'),
                           ("network.ros_view=true", "expected network.ros_view = false, got true")):
            done = subprocess.run([ORCHESTRATOR, "serve", self.team, "--engine", "dds", "--set", key], capture_output=True,
                                  text=True, timeout=LIMIT_S)
            self.assertEqual((done.returncode, done.stderr), (2, f"error: {self.team}: {words}\n"))

    def test_signal_ends_it_and_leaves_nothing(self):
        with self.server(self.team, "--engine", "dds", "--duration-s", "100000", once=False) as (address, process):
            client = Client(address)
            client.ask("step", ticks=2)
            children = pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children")
            started = [int(pid) for task in pathlib.Path(f"/proc/{process.pid}/task").iterdir()
                       for pid in (task / "children").read_text().split()]
            self.assertGreaterEqual(len(started), 4, children)
            client.send("step", ticks=1000000)
        self.assertEqual(self.code, 130)
        self.assertEqual([pid for pid in started if pathlib.Path(f"/proc/{pid}").exists()], [])
        client.close()


class Mistakes(Served):
    def test_are_told_in_words_and_change_nothing(self):
        cases = [
            (("stp", {}), 'expected a known "request", got "stp" (did you mean "step"?)'),
            (("step", {"tiks": 1}), 'step: unknown field "tiks" (did you mean "ticks"?)'),
            (("step", {"ticks": -1}), 'expected an integer in [0, 1000000] as "ticks", got -1'),
            (("step", {"actions": [[1, 2]]}), "actions: expected a list of 3 numbers for agent 1, got [1,2]"),
            (("step", {"actions": [[1, 2, "x"]]}), 'actions: expected a list of 3 numbers for agent 1, got [1,2,"x"]'),
            (("step", {"actions": []}), "actions: expected one for each of 1 ports, got 0"),
            (("step", {"actions": 5}), 'expected a list or an object as "actions"'),
            (("step", {"actions": {"2": [1, 2, 3]}}), "actions: agent 2 takes none; it would with `orchestrator serve --ports`, "
                                                      'or "ports" of a reset'),
            (("reset", {"set": {"law.p_gian": 1}}),
             'set law.p_gian = 1: law.p_gian: unknown key (did you mean "p_gain"?)'),
            (("reset", {"set": 1}), 'expected an object of keys and values as "set"'),
            (("reset", {"set": {"law.p_gain": None}}), NO_CODE.format("law.p_gain")),
            (("reset", {"set": {"law.python": "import os"}}), NO_CODE.format("law.python")),
            (("reset", {"set": {"law": {"name": "custom"}}}), NO_CODE.format("law")),
            (("reset", {"set": {"hosts": [{"launch": ["sh"]}]}}), NO_CODE.format("hosts")),
            (("reset", {"set": {"law.params": {"file": "x"}}}), NO_CODE.format("law.params")),
            (("reset", {"set": {"agents.starts_file": "/etc/passwd"}}), NO_CODE.format("agents.starts_file")),
            (("reset", {"set": {"run.seed = 1\nlaw.p_gain": 1}}),
             'set: expected keys such as law.p_gain, got "run.seed = 1\\nlaw.p_gain"'),
            (("event", {"event": {"set": {"law.p_gain": None}}}), "expected a value, got null"),
            (("reset", {"seed": -1}), 'expected an integer in [0, 9223372036854775807] as "seed", got -1'),
            (("reset", {"ports": [1, 1]}), 'expected a list of different agents as "ports"'),
            (("set", {"set": {"law.p_gain": -1}}), None),
            (("event", {}), 'expected an object as "event"'),
            (("snapshot", {"form": "x"}), 'expected "number" or "text" as "form"'),
            (("restore", {"snapshot": 9}), "there is no snapshot 9"),
            (("restore", {"text": "x"}), "expected a snapshot, got other text: text that is no JSON (byte 1)"),
            (("hello", {"protocol": 2}), 'expected an integer in [1, 1] as "protocol", got 2'),
            (("hello", {"protocol": 1, "form": "xml"}), 'expected "json" or "binary" as "form", got "xml"'),
        ]
        with self.client(self.team, "--ports", "1") as client:
            before = client.ask("step", ticks=3)
            for (kind, fields), words in cases:
                answer = client.ask(kind, id=5, **fields)
                self.assertEqual(answer["id"], 5)
                if words:
                    self.assertEqual(answer["error"], words)
                self.assertIn("error", answer)
            client.file.write(b"[1]\n{\n")
            client.file.flush()
            self.assertEqual(client.receive()["error"], "expected a request in JSON: expected an object, got another value")
            self.assertIn("expected a request in JSON: text that is no JSON", client.receive()["error"])
            after = client.ask("look")
            self.assertEqual((after["tick"], after["p"]), (before["tick"], before["p"]))
            client.ask("step", ticks=1000)
            self.assertEqual(client.ask("step")["error"], "the episode is over: expected a reset")

    def test_in_the_binary_form(self):
        with self.client(self.team, "--ports", "1", form="binary") as client:
            self.assertEqual(client.step(1, 1.0)["error"], "step: expected 4 bytes, or 28 with actions, got 12")
            self.assertEqual(client.ask("look")["tick"], 0)

    def test_ports_and_overrides_on_the_command_line_contradict_each_other(self):
        with self.client(self.team, "--set", "agents.override=[{id = 1}]") as client:
            self.assertEqual(client.ask("reset", ports=[1])["error"],
                             "ports: expected no --set of agents.override beside them, got agents.override")

    def test_of_the_command_line(self):
        def errors(*arguments):
            done = subprocess.run([ORCHESTRATOR, "serve", *map(str, arguments)], capture_output=True, text=True,
                                  timeout=LIMIT_S)
            self.assertEqual(done.returncode, 2)
            return done.stderr

        with socket.create_server(("127.0.0.1", 0)) as taken:
            port = taken.getsockname()[1]
            self.assertEqual(errors(self.team, "--at", f":{port}"),
                             f"error: --at: cannot listen at 127.0.0.1:{port}: Address already in use\n")
        self.assertIn("--at: expected ADDRESS:PORT", errors(self.team, "--at", "8770"))
        self.assertEqual(errors(self.team, "--ports", "9"), "error: ports: expected agents of the team, from 1 to 3, got 9\n")

    def test_law_that_fails_ends_the_episode_in_words(self):
        self.team.write_text(TEAM.replace('"consensus"', '''"custom"
python = """
def control(t, me, neighbours):
    return [0, 0, 1 / (3 - round(100 * t))]
"""'''))
        with self.client(self.team) as client:
            self.assertIn("ZeroDivisionError", client.ask("step", ticks=10)["error"])
            state = client.ask("look")
            self.assertEqual((state["tick"], state["over"]), (3, True))
            self.assertIn("ZeroDivisionError", state["failure"])
            self.assertEqual(client.ask("reset")["failure"], "")


class Strangers(Served):
    def answer_to(self, address, message):
        host, port = address.rsplit(":", 1)
        with socket.create_connection((host, int(port)), timeout=LIMIT_S) as stranger:
            stranger.sendall(message)
            return stranger.makefile("rb").read().decode()

    def test_who_does_not_say_hello_is_dropped(self):
        with self.server(self.team, once=False) as (address, _):
            self.assertEqual(self.answer_to(address, b"POST / HTTP/1.1\r\nHost: x\r\n\r\n{}\n"),
                             '{"error":"expected a request in JSON: text that is no JSON (byte 1)"}\n')
            self.assertEqual(self.answer_to(address, b'{"request": "step"}\n'),
                             '{"error":"expected {\\"request\\": \\"hello\\", \\"protocol\\": 1} first"}\n')
            self.assertEqual(self.answer_to(address, b"x" * 5000), '{"error":"expected a line of at most 4096 bytes"}\n')
            self.assertEqual(self.answer_to(address, b'{"request": "hello"}\n'),
                             '{"error":"expected an integer in [1, 1] as \\"protocol\\", got nothing"}\n')
        self.assertEqual(self.code, 130)

    def test_messages_have_a_limit_and_a_depth(self):
        with self.server(self.team, once=False) as (address, _):
            client = Client(address, form="binary")
            client.file.write(struct.pack("<IB", 1 << 30, ord("J")))
            client.file.flush()
            self.assertEqual(client.receive()["error"],
                             f"expected a frame of 1 to {16 << 20} bytes, got one of {1 << 30}")
            client.close()
            client = Client(address)
            client.file.write(b"[" * 100000 + b"\n")
            client.file.flush()
            self.assertIn("expected a request in JSON", client.receive()["error"])
            client.close()

    def test_one_client_steps_until_it_is_gone(self):
        with self.server(self.team, once=False) as (address, _):
            first, second = Client(address), Client(address)
            first.ask("step", ticks=4)
            me = "{}:{}".format(*first.socket.getsockname())
            self.assertEqual(second.ask("step")["error"], f"step: another client steps this team: {me}")
            self.assertEqual(second.ask("look")["tick"], 4)
            self.assertEqual(first.ask("close"), {"answer": "close"})
            self.assertEqual(first.file.read(), b"")
            self.assertEqual(second.ask("step")["tick"], 5)
            second.close()
            first.close()

    def test_as_many_as_may_be(self):
        with self.server(self.team, once=False) as (address, _):
            clients = [Client(address) for _ in range(16)]
            self.assertEqual(self.answer_to(address, b""), '{"error":"16 clients are connected, as many as may be"}\n')
            for client in clients:
                client.close()

    def test_who_does_not_read_makes_nobody_wait(self):
        with self.server(self.team, once=False) as (address, _):
            slow, other = Client(address), Client(address)
            slow.socket.settimeout(1)
            with contextlib.suppress(TimeoutError):  # until the kernel takes no more
                while True:
                    slow.socket.sendall(b'{"request": "look"}\n' * 10000)
            self.assertEqual(other.ask("step")["tick"], 1)
            slow.socket.close()
            other.close()

    def test_nobody_comes(self):
        with self.server(self.team, "--set", "run.start_timeout_s=0.1"):
            pass
        self.assertEqual(self.code, 0)

    def test_signal_ends_a_long_step(self):
        with self.server(self.team, "--duration-s", "100000", once=False) as (address, process):
            client = Client(address)
            client.send("step", ticks=1000000)
            self.assertIsNone(process.poll())
        self.assertEqual(self.code, 130)
        client.close()


if __name__ == "__main__":
    unittest.main()

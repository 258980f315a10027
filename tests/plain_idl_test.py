#!/usr/bin/python3
"""What is installed for programs that read a run over DDS: the plain IDL, whose types must be those of the wire,
profiles, which must say what the table of topics does, and the table of docs/matlab.md. That such programs read a run
is tested in tests/runs/plain_idl_test.cc."""

import os
import pathlib
import re
import subprocess
import tempfile
import unittest
import xml.etree.ElementTree as xml

ROOT = pathlib.Path(__file__).resolve().parent.parent
GENERATED = pathlib.Path(os.environ["MASCOT_BINARY_DIR"]).resolve() / "generated"
PROFILES = ROOT / "idl/profiles"
LIMIT_S = 60
FASTDDS = "{http://www.eprosima.com/XMLSchemas/fastRTPS_Profiles}"
OMG = "{http://www.omg.org/spec/DDS-XML}"


def types_in(*files):
    """The names with which generated code registers types."""
    text = "".join((GENERATED / file).read_text() for file in files)
    return sorted(re.findall(r'setName\("([^"]+)"\)', text))


def topics():
    """The rows of idl/topics.cc: {"state": {"per_agent": True, "type": "mascot_msgs/msg/AgentState", ...}, ...}."""
    rows = re.findall(r"\{(\.kind = TopicKind::k\w+,.*?)\}", (ROOT / "idl/topics.cc").read_text(), re.S)
    fields = [dict(re.findall(r"\.(\w+) = \"?([\w:/]+)\"?", row)) for row in rows]
    return {row["name"]: row for row in fields}


def profile_of(row):
    return "latest" if row.get("for_late_joiners") == "true" else "ticks"


def qos(reader, space, prefix=""):
    """Reliability, durability, history and depth of a reader's element, in the words of Fast DDS."""
    def one(path):
        return reader.find("/".join(space + step for step in path.split("/"))).text.removesuffix("_QOS")
    history = "topic/historyQos" if prefix else "history"
    return (one(f"{prefix}reliability/kind").removesuffix("_RELIABILITY"),
            one(f"{prefix}durability/kind").removesuffix("_DURABILITY"),
            one(f"{history}/kind").removesuffix("_HISTORY"), int(one(f"{history}/depth")))


class PlainIdl(unittest.TestCase):
    def test_its_types_have_the_names_of_the_wire(self):
        ours = types_in("mascotPubSubTypes.cxx", "view/viewPubSubTypes.cxx")
        self.assertIn("mascot_msgs::msg::dds_::AgentState_", ours)
        self.assertEqual(types_in("plain/mascotPubSubTypes.cxx"), ours)

    def test_its_fields_are_those_of_the_messages_of_ros(self):
        code = re.sub(r"//.*", "", (GENERATED / "plain/mascot.idl").read_text())
        structs = dict(re.findall(r"@final struct (\w+)_ \{(.*?)\};", code, re.S))
        for path in (ROOT / "idl/mascot_msgs/msg").glob("*.msg"):
            with self.subTest(message=path.stem):
                lines = [line.partition("#")[0].split() for line in path.read_text().splitlines()]
                fields = [words[1] for words in lines if len(words) == 2 and "=" not in words[1]]
                self.assertEqual(re.findall(r"(\w+)(?:\[\d+\])?;", structs[path.stem]), fields)

    def test_other_forms_of_idl_are_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            source = pathlib.Path(folder) / "x.idl"
            for text in ["\nmodule a { module msg {\n  struct B { long c; };\n}; };\n",
                         "\nmodule a {\nmodule msg {\n  @final struct B { long c; };\n}; };\n"]:
                source.write_text(text)
                done = subprocess.run([ROOT / "idl/make_plain_idl.py", pathlib.Path(folder) / "out.idl", source],
                                      capture_output=True, text=True, timeout=LIMIT_S)
                self.assertEqual(done.returncode, 1)
                self.assertIn("expected modules and structs as in idl/mascot.idl", done.stderr)


class Profiles(unittest.TestCase):
    def test_of_both_forms_are_those_of_the_table_of_topics(self):
        fast = {reader.get("profile_name").removeprefix("mascot_"): qos(reader, FASTDDS, "qos/")
                for reader in xml.parse(PROFILES / "fastdds.xml").iter(FASTDDS + "data_reader")}
        omg = {profile.get("name"): qos(profile.find(OMG + "datareader_qos"), OMG)
               for profile in xml.parse(PROFILES / "qos.xml").iter(OMG + "qos_profile")}
        depth = int(re.search(r"kHistoryDepth = (\d+)", (ROOT / "idl/topics.h").read_text())[1])
        expected = {"ticks": ("RELIABLE", "VOLATILE", "KEEP_LAST", depth),
                    "latest": ("RELIABLE", "TRANSIENT_LOCAL", "KEEP_LAST", 1)}
        self.assertEqual(fast, expected)
        self.assertEqual(omg, expected)
        latest = {name for name, row in topics().items() if profile_of(row) == "latest"}
        for file in ("fastdds.xml", "qos.xml"):
            words = " ".join((PROFILES / file).read_text().split())
            named = re.search(r'latest" for (\S+), (\S+) and (\S+), whose', words).groups()
            self.assertEqual({name.rpartition("/")[2] for name in named}, latest)

    def test_a_reader_that_is_killed_leaves_no_shared_memory(self):
        readers = list(xml.parse(PROFILES / "fastdds.xml").iter(FASTDDS + "data_reader"))
        self.assertEqual([reader.find(f".//{FASTDDS}data_sharing/{FASTDDS}kind").text for reader in readers],
                         ["OFF"] * len(readers))


class Page(unittest.TestCase):
    def test_its_topics_are_those_of_the_table(self):
        listed = re.findall(r"^\| `rt/(agent_<id>/)?(\w+)` \| `(\w+)::msg::dds_::(\w+)_` \| `(\w+)` \|",
                            (ROOT / "docs/matlab.md").read_text(), re.M)
        rows = topics()
        self.assertGreater(len(listed), 8)
        for agent, name, package, message, profile in listed:
            with self.subTest(topic=name):
                self.assertEqual(bool(agent), rows[name].get("per_agent") == "true")
                self.assertEqual(f"{package}/msg/{message}", rows[name]["type"])
                self.assertEqual(profile, profile_of(rows[name]))
        recorded = {name for name, row in rows.items() if row.get("is_recorded") == "true"}
        self.assertEqual(recorded - {name for _, name, *_ in listed}, set())


if __name__ == "__main__":
    unittest.main()

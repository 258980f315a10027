#!/usr/bin/python3
"""Writes the IDL for programs outside: make_plain_idl.py OUTPUT FILE.... fastddsgen -typeros2, with which MASCOT is
built, gives types the names that ROS 2 has on the wire: mascot_msgs::msg::dds_::AgentState_. Other generators know no
such option, so the names are written out here. FILE...: idl/mascot.idl, and the files that include it."""

import pathlib
import re
import sys

HEADER = """\
// The types of a run on DDS, with the names that they have on the wire: for generators that know nothing of ROS 2
// (fastddsgen without -typeros2, idlc, rtiddsgen, DDS Blockset). Made by idl/make_plain_idl.py. SI units; W is the world (x
// east, y north, z up), B the body (x forward, y left, z up). docs/matlab.md says which topic has which type.

"""


def plain(text):
    """The same types within a module dds_, and with an underscore after their names; without the text before."""
    text = text[text.index("\nmodule ") + 1:]
    text = re.sub(r"^(module \w+ \{ module msg \{)$", r"\1 module dds_ {", text, flags=re.M)
    text = re.sub(r"^\}; \};$", "}; }; };", text, flags=re.M)
    text = re.sub(r"(@final struct \w+)", r"\1_", text)
    return re.sub(r"\b(\w+::msg)::(\w+)", r"\1::dds_::\2_", text)


if __name__ == "__main__":
    output, *files = map(pathlib.Path, sys.argv[1:])
    parts = [plain(file.read_text()) for file in files]
    for part in parts:
        code = re.sub(r"//.*", "", part)
        if code.count("module dds_ {") != code.count("module msg {") or len(re.findall(r"struct \w+\b", code)) != len(
                re.findall(r"@final struct \w+_ \{", code)):
            sys.exit(f"{sys.argv[0]}: expected modules and structs as in idl/mascot.idl")
    output.write_text(HEADER + "\n".join(parts))

#!/usr/bin/python3
"""Writes the rows of the table in schemas.cc from the .msg files: make_schemas.py SOURCE_FOLDER OUTPUT TYPE..."""

import pathlib
import sys

sys.dont_write_bytecode = True
source, output, names = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3:]
sys.path.insert(0, str(source / "scripts"))

from type_hash import Messages  # noqa: E402

messages = Messages([source / "idl", source / "idl" / "ros_interfaces"])
rows = [f'{{"{name}", R"msg({messages.schema_text(name)})msg",\n "{messages.type_hash(name)}"}},\n' for name in names]
output.write_text("".join(rows), encoding="utf-8")

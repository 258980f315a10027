#!/usr/bin/python3
"""ROS 2 type hashes (RIHS01) and complete schema texts of .msg files, without ROS.

The hash is SHA-256 over a canonical JSON description of a type and all types it is made of, see REP-2011 and
REP-2016. ROS 2 (Iron and later) compares it at discovery and stores it in recordings. Comments, constants and
default values do not enter it; names, types and order of fields do.

    type_hash.py FOLDER... -- TYPE...      e.g. type_hash.py idl idl/ros_interfaces -- mascot_msgs/msg/AgentState

A FOLDER holds packages: <package>/msg/<Type>.msg.
"""

import hashlib
import json
import pathlib
import re
import sys

# type_description_interfaces/msg/FieldType
TYPE_IDS = {
    "int8": 2, "uint8": 3, "int16": 4, "uint16": 5, "int32": 6, "uint32": 7, "int64": 8, "uint64": 9,
    "float32": 10, "float64": 11, "char": 3, "bool": 15, "byte": 16, "string": 17, "wstring": 18,
}
NESTED_TYPE = 1
BOUNDED_STRING_OFFSET = 4  # string 17 -> 21, wstring 18 -> 22
ARRAY_OFFSET, BOUNDED_SEQUENCE_OFFSET, SEQUENCE_OFFSET = 48, 96, 144

FIELD = re.compile(r"^(?P<base>[\w/]+)(?:<=(?P<string_bound>\d+))?(?P<array>\[(?P<bounded><=)?(?P<extent>\d*)\])?$")
CONSTANT = re.compile(r"^\S+\s+\w+\s*=")
# The field that rosidl adds to a message without fields.
EMPTY = {"name": "structure_needs_at_least_one_member",
         "type": {"type_id": 3, "capacity": 0, "string_capacity": 0, "nested_type_name": ""}}


class Messages:
    """The .msg files below some folders. Types are named package/msg/Type."""

    def __init__(self, folders):
        self.folders = [pathlib.Path(folder) for folder in folders]

    def text(self, name):
        for folder in self.folders:
            path = folder / f"{name}.msg"
            if path.is_file():
                return path.read_text(encoding="utf-8")
        raise SystemExit(f"error: no {name}.msg below any of {', '.join(map(str, self.folders))}")

    def fields(self, name):
        """The fields of one type, as REP-2016 describes them."""
        package = name.split("/")[0]
        fields = []
        for line in self.text(name).splitlines():
            line = line.split("#")[0].strip()
            if line and not CONSTANT.match(line):
                type_text, field_name = line.split()[:2]
                fields.append({"name": field_name, "type": field_type(package, type_text)})
        return fields or [EMPTY]

    def dependencies(self, name):
        """All types that `name` contains, without itself, breadth first."""
        found, todo = [], [name]
        while todo:
            for field in self.fields(todo.pop(0)):
                nested = field["type"]["nested_type_name"]
                if nested and nested not in found:
                    found.append(nested)
                    todo.append(nested)
        return found

    def type_hash(self, name):
        def describe(type_name):
            return {"type_name": type_name, "fields": self.fields(type_name)}

        description = {
            "type_description": describe(name),
            "referenced_type_descriptions": [describe(other) for other in sorted(self.dependencies(name))],
        }
        canonical = json.dumps(description, ensure_ascii=True, allow_nan=False, separators=(", ", ": "))
        return "RIHS01_" + hashlib.sha256(canonical.encode()).hexdigest()

    def schema_text(self, name):
        """The ros2msg schema: the text of the type, then that of each dependency after a line of 80 '='."""
        text = self.text(name)
        for other in self.dependencies(name):
            text += "=" * 80 + "\nMSG: " + other.replace("/msg/", "/") + "\n" + self.text(other)
        return text


def field_type(package, text):
    match = FIELD.match(text)
    if not match:
        raise SystemExit(f"error: cannot read the field type '{text}'")
    base, extent = match["base"], match["extent"]
    nested = ""
    if base in TYPE_IDS:
        type_id = TYPE_IDS[base] + (BOUNDED_STRING_OFFSET if match["string_bound"] else 0)
    else:
        type_id = NESTED_TYPE
        parts = base.split("/")
        nested = f"{parts[0] if len(parts) > 1 else package}/msg/{parts[-1]}"
    if match["array"]:
        type_id += (BOUNDED_SEQUENCE_OFFSET if match["bounded"] else ARRAY_OFFSET) if extent else SEQUENCE_OFFSET
    return {"type_id": type_id, "capacity": int(extent or 0), "string_capacity": int(match["string_bound"] or 0),
            "nested_type_name": nested}


def main():
    if "--" not in sys.argv[2:-1]:
        raise SystemExit(__doc__)
    split = sys.argv.index("--")
    messages = Messages(sys.argv[1:split])
    for name in sys.argv[split + 1:]:
        print(name, messages.type_hash(name))


if __name__ == "__main__":
    main()

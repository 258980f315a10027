#!/usr/bin/python3
"""Writes the definition of SourcesText() (orchestrator/engines/dds/hosts/same_bits.h): sources_text.py ROOT OUTPUT."""

import hashlib
import pathlib
import sys

FOLDERS = ["agent", "base", "bus", "cmake", "experiment", "idl", "orchestrator", "physics_server", "system", "vehicle"]
KINDS = {".cc", ".cmake", ".h", ".idl", ".msg", ".py"}


def main():
    root, output = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    files = [root / "CMakeLists.txt"]
    for folder in FOLDERS:
        files += [path for path in (root / folder).rglob("*") if path.suffix in KINDS and path.is_file()]
    digest = hashlib.sha256()
    for path in sorted(files):
        content = path.read_bytes()
        digest.update(f"{path.relative_to(root)} {len(content)}\n".encode() + content)
    output.write_text('#include "orchestrator/engines/dds/hosts/same_bits.h"\n\n'
                      f'std::string mascot::SourcesText() {{ return "{digest.hexdigest()}"; }}\n')
    words = [str(path).replace(" ", "\\ ") for path in files]
    pathlib.Path(f"{output}.d").write_text(f"{str(output).replace(' ', chr(92) + ' ')}: " + " ".join(words) + "\n")


main()

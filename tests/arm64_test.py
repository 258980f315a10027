#!/usr/bin/python3
"""The arithmetic of agents, on aarch64 by qemu and on this machine: the same bits (docs/arm64.md). Takes the packages of
`scripts/setup --test`, and Debian's packages for arm64, which it fetches."""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
HERE = pathlib.Path(os.environ.get("MASCOT_BINARY_DIR", ROOT / "build/release"))
NEEDED = {"aarch64-linux-gnu-g++": "g++-aarch64-linux-gnu", "qemu-aarch64-static": "qemu-user-static"}
SKIPPED = 77  # SKIP_RETURN_CODE of CMakeLists.txt
NOT_FETCHED = 3  # exit code of scripts/arm64
LIMIT_S = 540


def arm64(*words):
    return subprocess.run([ROOT / "scripts/arm64", *words], capture_output=True, text=True, timeout=LIMIT_S)


def skip(why):
    print(f"skipped: {why}")
    sys.exit(SKIPPED)


class Bits(unittest.TestCase):
    def test_are_the_same_on_aarch64(self):
        ours = subprocess.run([HERE / "bits"], capture_output=True, text=True, check=True, timeout=LIMIT_S).stdout
        theirs = arm64("bits")
        self.assertEqual(theirs.returncode, 0, theirs.stderr)
        self.assertEqual(len(ours.splitlines()), 9)
        self.assertEqual(theirs.stdout, ours)


class OperationsThatRoundOnce(unittest.TestCase):
    def test_are_found_where_they_are(self):
        with tempfile.TemporaryDirectory() as folder:
            source, program = pathlib.Path(folder) / "fused.cc", pathlib.Path(folder) / "fused.o"
            source.write_text("double Sum(double a, double b, double c) { return a * b + c; }\n")
            for options, expected in {"": ["fmadd"], "-ffp-contract=off": []}.items():
                subprocess.run(["aarch64-linux-gnu-g++", "-O2", *options.split(), "-c", source, "-o", program], check=True,
                               timeout=LIMIT_S)
                found = [line.split()[1] for line in arm64("fused", program).stdout.splitlines()]
                self.assertEqual(found, expected, options)


if __name__ == "__main__":
    missing = [package for program, package in NEEDED.items() if shutil.which(program) is None]
    if missing:
        skip(f"{' and '.join(missing)} not there; `scripts/setup --test` installs what the tests need")
    if arm64("sysroot", "--bits").returncode == NOT_FETCHED:
        skip("Debian's packages for arm64 cannot be fetched (scripts/arm64 sysroot says why)")
    unittest.main()

"""What the tests of the module mascot share: importing it from the build tree, small experiments, folders."""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest
import warnings

sys.dont_write_bytecode = True
BINARIES = pathlib.Path(os.environ["MASCOT_BINARY_DIR"])
SOURCES = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(BINARIES / "python"))
warnings.simplefilter("error")

import mascot  # noqa: E402

LEADERLESS = str(SOURCES / "configs/leaderless.toml")


def orchestrator(*words, code=0):
    """Runs `orchestrator`, which must end with this exit code; returns what it printed."""
    done = subprocess.run([BINARIES / "orchestrator", *map(str, words)], text=True, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, timeout=120, check=False)
    assert done.returncode == code, done.stdout
    return done.stdout


class TestCase(unittest.TestCase):
    """A test with a folder of its own, which is the current one."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder.name)

    def write(self, text, name="team.toml"):
        pathlib.Path(name).write_text(text)
        return name

#!/usr/bin/python3
"""Types every command of docs/tour.md, in order, and compares what it prints with what the page says.

tests/tour_test.py            with the programs of MASCOT_BINARY_DIR: all but what needs root, the commands in NOT_HERE
tests/tour_test.py --install  really all, on a host that may be changed; scripts/fresh does so on a fresh Debian
tests/tour_test.py --draw     likewise, and puts the pictures that came out into docs/pictures/tour

A block ```console holds commands behind "$ " and what they print: "..." alone on a line stands for any lines, within a line
for anything. A command must succeed unless the next one is `echo $?`. A block titled "first terminal" may end with a
command that goes on: what it prints must begin as the page says, and it must succeed before the next untitled block. In a
block titled "other host", numbers are those that the first terminal has printed. Other blocks with a title are saved as a
file of this name.
"""

import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/tour.md"
NOT_HERE = ("scripts/package", "sudo apt-get install ")
PICTURES = {"paths.png": "first/paths.png", "beta.png": "beta.png", "figure.png": "figures/disagreement.png"}
INSTALL = "--install" in sys.argv
LIMIT_S = 3600 if INSTALL else 200  # of a command; building the package takes long
DRAW = "--draw" in sys.argv


def blocks(page):
    """(section, language, title, text) of each fenced block of a page of Markdown."""
    section = ""
    for heading, language, title, text in re.findall(
            r'^## ([^\n]*)$|^```(\w+)(?: title="(.*?)")?\n(.*?)^```$', page, re.M | re.S):
        section = heading or section
        if language:
            yield section, language, title, text


def commands(text):
    """[command, output] of each command of a block."""
    found = []
    for line in text.splitlines(keepends=True):
        if line.startswith("$ "):
            found.append([line[2:].rstrip("\n"), ""])
        else:
            found[-1][1] += line
    return found


def fits(output, wanted, whole=True):
    """Whether an output is, or begins as, the page wants it."""
    pattern = "".join(
        r"(?:.*\n)*?" if line == "...\n" else ".*?".join(map(re.escape, line.rstrip("\n").split("..."))) + r" *\n"
        for line in wanted.splitlines(keepends=True))
    return bool((re.fullmatch if whole else re.match)(pattern, output))


class Hosts:
    """Two network namespaces that reach each other, or none where none may be made. Use it by `with`."""

    def __init__(self):
        self.names = []

    def __enter__(self):
        if subprocess.run(["unshare", "--mount", "--net", "true"], capture_output=True, timeout=LIMIT_S).returncode == 0 and shutil.which("ip"):
            self.names = [f"mascot-tour-{side}{os.getpid()}" for side in "ab"]
            for name in self.names:
                self.ip("netns", "add", name)
            self.ip("-n", self.names[0], "link", "add", "veth0", "type", "veth", "peer", "name", "veth0", "netns", self.names[1])
            for k, name in enumerate(self.names):
                self.ip("-n", name, "addr", "add", f"10.78.0.{k + 1}/24", "dev", "veth0")
                self.ip("-n", name, "link", "set", "veth0", "up")
                self.ip("-n", name, "link", "set", "lo", "up")
                self.ip("-n", name, "route", "add", "239.0.0.0/8", "dev", "veth0")
        return self

    def __exit__(self, *error):
        for name in self.names:
            self.ip("netns", "del", name)

    def on(self, k):
        """The words before a command on host k."""
        return ["ip", "netns", "exec", self.names[k]] if self.names else []

    @staticmethod
    def ip(*words):
        subprocess.run(["ip", *words], check=True, timeout=LIMIT_S)


class Terminal:
    """Types commands, one after another, in a shell with a folder of its own."""

    def __init__(self, folder, environment):
        self.folder, self.environment = folder, environment
        self.code = 0
        self.running = None

    def start(self, command, before=()):
        self.command = command
        self.output_file = tempfile.NamedTemporaryFile(mode="w+", prefix="mascot-tour-")
        self.where = tempfile.NamedTemporaryFile(mode="r", prefix="mascot-tour-")
        script = f'(exit {self.code})\n{command}\ncode=$?\npwd >"$0"\nexit $code'
        self.running = subprocess.Popen([*before, "bash", "-c", script, self.where.name], cwd=self.folder,
                                        env=self.environment, stdin=subprocess.DEVNULL, stdout=self.output_file,
                                        stderr=subprocess.STDOUT, start_new_session=True)

    def output(self):
        return pathlib.Path(self.output_file.name).read_text()

    def wait(self):
        """What the command has printed, once it has ended."""
        self.code = self.running.wait(LIMIT_S)
        self.running = None
        self.folder = pathlib.Path(self.where.read().strip())
        return self.output()

    def close(self):
        if self.running:
            os.killpg(self.running.pid, signal.SIGKILL)
            self.running.wait(LIMIT_S)


class Matching(unittest.TestCase):
    def test_three_dots_stand_for_lines_and_within_a_line(self):
        for output, wanted in [("a\n", "a\n"), ("a\nb\nc\n", "a\n...\nc\n"), ("a\nc\n", "a\n...\nc\n"), ("t = 4 s\n", "t = ... s\n"),
                               ("a\nb\n", "...\n"), ("", "")]:
            self.assertTrue(fits(output, wanted), (output, wanted))

    def test_what_differs_is_found(self):
        for output, wanted in [("a\n", "b\n"), ("a\nb\n", "a\n"), ("a\n", "a\nb\n"), ("a\nb\n", "...\nc\n"), ("t = 4 m\n", "t = ... s\n"),
                               ("axb\n", "a.b\n"), ("", "a\n")]:
            self.assertFalse(fits(output, wanted), (output, wanted))

    def test_what_goes_on_is_compared_as_far_as_it_is_told(self):
        self.assertTrue(fits("a\nb\nc\n", "a\nb\n", whole=False))
        self.assertFalse(fits("a\nb\n", "b\n", whole=False))


class Tour(unittest.TestCase):
    def setUp(self):
        self.home = pathlib.Path.home() if INSTALL else pathlib.Path(self.enterContext(tempfile.TemporaryDirectory(prefix="mascot-tour-")))
        path = os.environ["PATH"] if INSTALL else f'{os.environ["MASCOT_BINARY_DIR"]}:{os.environ["PATH"]}'
        self.environment = dict(os.environ, HOME=str(self.home), PATH=path)
        self.terminals = {title: Terminal(ROOT, self.environment) for title in ("", "first terminal")}
        self.hosts = self.enterContext(Hosts())
        for terminal in self.terminals.values():
            self.addCleanup(terminal.close)

    def show(self, command, output, wanted):
        self.fail(f"$ {command}\n--- the page says\n{wanted}--- it printed\n{output}---")

    def finish(self):
        """Waits for what still goes on in the first terminal."""
        first = self.terminals["first terminal"]
        if first.running:
            output = first.wait()
            self.assertEqual(first.code, 0, f"$ {first.command}\n{output}")

    def type(self, terminal, command, wanted, following):
        if not INSTALL and command.startswith(NOT_HERE):
            return
        terminal.start(command)
        output = terminal.wait()
        if not fits(output, wanted):
            self.show(command, output, wanted)
        if following != "echo $?":
            self.assertEqual(terminal.code, 0, f"$ {command}\n{output}")

    def type_and_go_on(self, command, wanted, before):
        first = self.terminals["first terminal"]
        first.folder = self.terminals[""].folder
        first.start(command, before)
        by = time.monotonic() + LIMIT_S
        while not fits(first.output(), wanted, whole=False):
            if first.running.poll() is not None or time.monotonic() > by:
                self.show(command, first.output(), wanted)
            time.sleep(0.02)

    def type_on_other_host(self, command):
        shown = re.search(re.sub(r"\d+", r"\\d+", command), self.terminals["first terminal"].output())
        self.assertTrue(shown, f"the first terminal has not said: {command}")
        other = Terminal(self.terminals[""].folder, self.environment)
        self.addCleanup(other.close)
        other.start(shown[0], self.hosts.on(1))
        output = other.wait()
        self.assertEqual(other.code, 0, f"$ {shown[0]}\n{output}")

    def test_every_command_does_what_the_page_says(self):
        here = self.terminals[""]
        typed = 0
        for section, language, title, text in blocks(PAGE.read_text()):
            if language != "console":
                self.assertTrue(title, f"a block of {language} has no name to be saved as")
                (here.folder / title).write_text(text)
                continue
            told = commands(text)
            typed += len(told)
            if title == "other host":
                for command, _ in told:
                    self.type_on_other_host(command)
            elif title == "first terminal":
                (command, wanted), = told
                self.type_and_go_on(command, wanted, self.hosts.on(0) if section == "Two hosts" else [])
            else:
                if not title:
                    self.finish()
                for (command, wanted), following in zip(told, [command for command, _ in told[1:]] + [None]):
                    self.type(here, command, wanted, following)
        self.assertGreater(typed, 25)
        self.compare_pictures(here.folder)

    def compare_pictures(self, folder):
        """The pictures of the page are those that came out, but for what another font library does."""
        import matplotlib.image
        import numpy as np
        for name, made in PICTURES.items():
            shown = PAGE.parent / "pictures/tour" / name
            if DRAW:
                shown.parent.mkdir(parents=True, exist_ok=True)
                shutil.copy(folder / made, shown)
            a, b = (matplotlib.image.imread(path) for path in (shown, folder / made))
            self.assertEqual(a.shape, b.shape, name)
            self.assertLess(np.abs(a - b).mean(), 0.01, f"{name} is not {made}: tests/tour_test.py --draw makes it again")


if __name__ == "__main__":
    unittest.main(argv=[word for word in sys.argv if word not in ("--install", "--draw")])

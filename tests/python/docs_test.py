#!/usr/bin/python3
"""Runs the code of docs/python.md, from top to bottom: blocks ```python in one namespace, and of blocks ```sh the commands of
`orchestrator`. The folder has the files that the page names."""

import contextlib
import io
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import traceback
import unittest

from support import BINARIES, SOURCES, TestCase, mascot

PAGE = SOURCES / "docs/python.md"
FILES = ("leaderless.toml", "policy.toml", "policy.onnx")
LIMIT_S = 100  # of a command


def blocks(text):
    """(line, language, code) of each fenced block of a page of Markdown: the line of the page at which the code begins."""
    return [(text.count("\n", 0, block.start(2)) + 1, block[1], block[2])
            for block in re.finditer(r"^```(\w*)[^\n]*\n(.*?)^```$", text, re.M | re.S)]


def commands(code):
    """(line of the block, words) of each command of `orchestrator` in a block of a shell."""
    return [(k, shlex.split(line, comments=True)) for k, line in enumerate(code.splitlines())
            if line.startswith("orchestrator ")]


def run_page(text, path):
    """Runs what a page says, in the current folder. Raises AssertionError, with the line of the page, for what fails."""
    namespace = {"__name__": "page"}
    for line, language, code in blocks(text):
        if language == "python":
            run_python(line, code, path, namespace)
        elif language == "sh":
            for k, words in commands(code):
                run_command(line + k, words, path)


def run_python(line, code, path, namespace):
    try:
        with contextlib.redirect_stdout(io.StringIO()):
            exec(compile("\n" * (line - 1) + code, str(path), "exec"), namespace)  # tracebacks name lines of the page
    except Exception as error:
        ours = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == str(path)]
        raise AssertionError(f"{path}:{ours[-1] if ours else line}: this block fails: {error!r}") from error


def run_command(line, words, path):
    environment = {**os.environ, "PATH": f"{BINARIES}:{os.environ['PATH']}"}
    done = subprocess.run(words, env=environment, text=True, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, timeout=LIMIT_S, check=False)
    if done.returncode != 0:
        raise AssertionError(f"{path}:{line}: exit code {done.returncode} of {shlex.join(words)}:\n{done.stdout}")


class Page(TestCase):
    TEXT = PAGE.read_text()

    def setUp(self):
        super().setUp()
        os.environ["MPLBACKEND"] = "Agg"
        os.environ["MPLCONFIGDIR"] = os.getcwd() + "/matplotlib"
        for name in FILES:
            shutil.copy(SOURCES / "configs" / name, name)

    def test_its_code_runs_from_top_to_bottom(self):
        languages = [language for _, language, _ in blocks(self.TEXT)]
        self.assertGreater(languages.count("python"), 15)
        self.assertGreater(sum(len(commands(code)) for _, language, code in blocks(self.TEXT) if language == "sh"), 3)
        run_page(self.TEXT, PAGE)

    def test_it_names_all_that_the_module_has(self):
        for name in mascot.__all__:
            self.assertIn(f"mascot.{name}", self.TEXT)
        for kind in (mascot.ParallelEnv, mascot.VectorEnv, mascot.Run):
            for name, thing in vars(kind).items():
                if not name.startswith("_") and (callable(thing) or isinstance(thing, property)) and name != "close_extras":
                    self.assertRegex(self.TEXT, rf"\b{name}\b")

    def test_it_names_the_files_that_it_needs(self):
        for name in FILES:
            self.assertIn(f"`{name}`", self.TEXT.partition("\n## ")[0])


class WhatFails(TestCase):
    """Is named by its line in the page."""

    def expect(self, text, words):
        with self.assertRaises(AssertionError) as caught:
            run_page(text, "page.md")
        self.assertIn(words, str(caught.exception))

    def test_a_block_of_python(self):
        page = "A page.\n\n```python\nx = 1\n```\n\n```console\n$ exit 1\n```\n\n```python\n\nassert x == 2\n```\n"
        self.expect(page, "page.md:13: this block fails: AssertionError()")
        self.expect("```python\nimport warnings\nwarnings.warn('old')\n```\n", "page.md:3: this block fails: UserWarning('old')")
        self.expect("# x\n```python\ny = (\n```\n", "page.md:3: this block fails: SyntaxError")

    def test_a_command(self):
        self.expect("```sh\nexport A=1\norchestrator info nothing  # no such run\n```\n",
                    "page.md:3: exit code 2 of orchestrator info nothing:\n")

    def test_what_runs_leaves_no_word(self):
        run_page("```python\nx = 1\n```\n```python\nimport pathlib\npathlib.Path('x').write_text(str(x))\n```\n```toml\nno = code\n```\n", "page.md")
        self.assertEqual(pathlib.Path("x").read_text(), "1")


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/python3
"""Does the exercises of docs/exercises.md as a student would: types the command below each question with the right answer,
which must end with exit code 0, and with each wrong one, which must end with exit code 1 and say what was measured.

An exercise is a section whose heading begins with a number. Its question has one command, with ANSWER in it; its solution, in
<details>, says "Answer: **x**" and "Wrong: **y**", once or more. Other commands of the solution must succeed. Runs leave out
their pictures, which take longer than the flights.
"""

import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/exercises.md"
FILES = ROOT / "configs/exercises"
LIMIT_S = 60  # of a command; ctest ends the test after 300 s, without a word


class Exercise:
    def __init__(self, title, text):
        self.title = title
        self.question, _, self.solution = text.partition("<details")
        self.answers = re.findall(r"Answer: \*\*([\d.]+)\*\*", self.solution)
        self.wrong = re.findall(r"Wrong: \*\*([\d.]+)\*\*", self.solution)


def exercises(page):
    sections = re.split(r"^## ", page, flags=re.M)[1:]
    return [Exercise(*section.split("\n", 1)) for section in sections if re.match(r"\d+\. ", section)]


def commands(text):
    return [line[2:] for block in re.findall(r"^```console\n(.*?)^```$", text, re.M | re.S) for line in block.splitlines()
            if line.startswith("$ ")]


class Reading(unittest.TestCase):
    def test_finds_questions_answers_and_commands(self):
        found = exercises("# Exercises\n\n## Before\n\nx\n\n## 1. One\n\nHow?\n\n```console\n$ a ANSWER\n```\n\n<details>\n\n"
                          "Answer: **1.5** (m). Wrong: **2**, so. Wrong: **3**.\n\n```console\n$ b\n```\n\n</details>\n\n## After\n")
        self.assertEqual([one.title for one in found], ["1. One"])
        self.assertEqual(commands(found[0].question), ["a ANSWER"])
        self.assertEqual(commands(found[0].solution), ["b"])
        self.assertEqual((found[0].answers, found[0].wrong), (["1.5"], ["2", "3"]))


class Exercises(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        scratch = cls.enterClassContext(tempfile.TemporaryDirectory(prefix="mascot-exercises-"))
        cls.folder = pathlib.Path(shutil.copytree(FILES, pathlib.Path(scratch) / "exercises"))
        cls.environment = dict(os.environ, PATH=f'{os.environ["MASCOT_BINARY_DIR"]}:{os.environ["PATH"]}')
        cls.page = exercises(PAGE.read_text())

    def type(self, command):
        done = subprocess.run(f"{command} --set output.save_plot=false", shell=True, cwd=self.folder, env=self.environment,
                              capture_output=True, text=True, timeout=LIMIT_S)
        return done.returncode, done.stdout + done.stderr

    def test_each_has_one_command_one_answer_and_a_wrong_one(self):
        self.assertEqual([one.title.split(".")[0] for one in self.page], [str(k + 1) for k in range(len(self.page))])
        self.assertGreaterEqual(len(self.page), 8)
        for one in self.page:
            asked = commands(one.question)
            self.assertEqual(len(asked), 1, one.title)
            self.assertEqual(asked[0].count("ANSWER"), 1, one.title)
            self.assertEqual(len(one.answers), 1, one.title)
            self.assertGreaterEqual(len(one.wrong), 1, one.title)

    def test_right_answers_are_accepted_without_a_word(self):
        for one in self.page:
            for answer in one.answers:
                command = commands(one.question)[0].replace("ANSWER", answer)
                self.assertEqual(self.type(command), (0, ""), f"{one.title}\n$ {command}")

    def test_wrong_answers_are_refused_with_what_was_measured(self):
        for one in self.page:
            for answer in one.wrong:
                command = commands(one.question)[0].replace("ANSWER", answer)
                code, output = self.type(command)
                self.assertEqual(code, 1, f"{one.title}\n$ {command}\n{output}")
                self.assertRegex(output, r"^error: --assert [\w.]+ \S+ \S+: (it is|the run has no value of it|theory predicts no value of it)", one.title)

    def test_other_commands_of_the_solutions_do_what_they_say(self):
        others = [(one.title, command) for one in self.page for command in commands(one.solution)]
        self.assertGreaterEqual(len(others), 3)
        for title, command in others:
            self.assertEqual(self.type(command), (0, ""), f"{title}\n$ {command}")

    def test_files_are_those_that_the_page_names(self):
        named = set(re.findall(r"\.\./configs/exercises/(\w+\.toml)", PAGE.read_text()))
        self.assertEqual(named, {path.name for path in FILES.iterdir()})

    def test_the_error_that_the_page_shows_is_that_of_a_wrong_answer(self):
        shown = re.search(r"^    (error: --assert .*)$", PAGE.read_text(), re.M)[1]
        told = [self.type(commands(one.question)[0].replace("ANSWER", one.wrong[0]))[1] for one in self.page[:2]]
        self.assertIn(f"{shown}\n", told)


if __name__ == "__main__":
    unittest.main()

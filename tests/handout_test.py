#!/usr/bin/python3
"""The handout of all laws, made by scripts/handout: two pages of A4 with every law that `orchestrator laws` lists. How it
writes formulas that are in plain text."""

import importlib.machinery
import importlib.util
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
LIMIT_S = 240  # of a command; ctest ends the test after 300 s, without a word
sys.dont_write_bytecode = True  # the folder of the scripts may be read-only
sys.path.insert(0, str(ROOT / "scripts"))


def script(name):
    """A script of our own, as a module."""
    loader = importlib.machinery.SourceFileLoader(name, str(ROOT / "scripts" / name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(name, loader))
    loader.exec_module(module)
    return module


def output_of(*words):
    return subprocess.run(words, check=True, capture_output=True, text=True, timeout=LIMIT_S).stdout


class Handout(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        orchestrator = pathlib.Path(os.environ["MASCOT_BINARY_DIR"]) / "orchestrator"
        cls.pdf = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory())) / "laws.pdf"
        made = output_of(ROOT / "scripts/handout", cls.pdf, "--orchestrator", orchestrator)
        assert made == f"{cls.pdf}\n", made
        cls.laws = json.loads(output_of(orchestrator, "laws", "--json"))

    def test_has_two_pages_of_a4(self):
        told = output_of("pdfinfo", self.pdf)
        self.assertRegex(told, r"(?m)^Pages: +2$")
        self.assertRegex(told, r"(?m)^Page size: .*\(A4\)$")

    def test_has_every_law_with_what_belongs_to_it(self):
        text = output_of("pdftotext", "-raw", self.pdf, "-").replace("\f", "\n")
        places = [re.search(rf"^{law['name']}\b", text, re.M) for law in self.laws]
        self.assertGreater(len(places), 20)
        for law, place in zip(self.laws, places):
            self.assertTrue(place, f"{law['name']} is not on it")
        starts = [place.start() for place in places]
        self.assertEqual(starts, sorted(starts), "in the order of the table")
        for law, start, end in zip(self.laws, starts, [*starts[1:], len(text)]):
            section = text[start:end]
            for part in ("Graph", "Theory", "Paper"):
                self.assertRegex(section, rf"(?m)^{part}", law["name"])
            self.assertIn(law["source"].split()[0], section, law["name"])
            for key in law["parameters"]:
                if key["symbol"] or key["required"]:
                    self.assertRegex(section, rf"\b{key['name']}\b", law["name"])

    def test_has_all_letters_in_it(self):
        for font in output_of("pdffonts", self.pdf).splitlines()[2:]:
            self.assertRegex(font, r" yes (yes|no) +(yes|no) +\d+ +\d+$", "embedded")

    def test_has_nothing_at_the_edges_of_the_paper(self):
        pixels = subprocess.run(["pdftoppm", "-gray", "-r", "50", self.pdf], check=True, capture_output=True,
                                timeout=LIMIT_S).stdout
        pages = re.findall(rb"P5\n(\d+) (\d+)\n255\n", pixels)
        self.assertEqual(len(pages), 2)
        start = 0
        for width, height in (map(int, page) for page in pages):
            start = pixels.index(b"255\n", start) + 4
            rows = [pixels[start + row * width:start + (row + 1) * width] for row in range(height)]
            start += width * height
            edge = 14  # pixels: 7 mm
            self.assertTrue(all(min(row) > 250 for row in [*rows[:edge], *rows[-edge:]]))
            self.assertTrue(all(min(row[:edge] + row[-edge:]) > 250 for row in rows))


class Formulas(unittest.TestCase):
    def test_of_plain_text_are_set_in_type(self):
        in_type = script("handout").in_type
        for plain, typeset in [
                ("stable for lambda_2 >= 1", "stable for <i>&lambda;</i><sub>2</sub> ≥ 1"),
                ("exp(-4 gain d^2 t)", "exp(−4 K <i>d</i><sup>2</sup> <i>t</i>)"),
                ("the gain", "the gain"),
                ("L_FF^-1 M v_L", "<i>L</i><sub>FF</sub><sup>−1</sup> <i>M</i> <i>v</i><sub><i>L</i></sub>"),
                ("V^((1-alpha)/2) / x", "<i>V</i><sup>(1−<i>&alpha;</i>)/2</sup> / <i>x</i>"),
                ("|z| < a regular N-gon", "|<i>z</i>| &lt; a regular <i>N</i>-gon"),
                ("the followers' places, x'' = 0", "the followers’ places, <i>x</i><sup>′′</sup> = 0"),
                ("(2F+1)-robust, 3 s", "(2<i>F</i>+1)-robust, 3 s"),
                ("graph.range_m - margin_m", "<code>graph.range_m</code> − <code>margin_m</code>"),
                ("sum_j a_ij", "Σ<sub><i>j</i></sub> <i>a</i><sub><i>ij</i></sub>")]:
            self.assertEqual(in_type(plain, {"gain": "K"}), typeset)


if __name__ == "__main__":
    unittest.main()

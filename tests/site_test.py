#!/usr/bin/python3
"""The documentation as a site, built by scripts/site: all links lead somewhere, nothing comes from other hosts. Code that
pages quote is that of its file, and the files and tests that they name are there."""

import html.parser
import pathlib
import re
import subprocess
import tempfile
import unittest
import urllib.parse

ROOT = pathlib.Path(__file__).resolve().parent.parent
LIMIT_S = 240  # of a command; ctest ends the test after 300 s, without a word


class Page(html.parser.HTMLParser):
    """What a page links to, what it loads, and what in it may be linked to."""

    def __init__(self, text):
        super().__init__()
        self.links, self.loads, self.places = [], [], set()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        attributes = dict(attributes)
        self.places.update(attributes[key] for key in ("id", "name") if key in attributes)
        if tag == "a" and "href" in attributes:
            self.links.append(attributes["href"])
        if tag == "link" and attributes.get("rel") != "canonical":
            self.loads.append(attributes["href"])
        if "src" in attributes:
            self.loads.append(attributes["src"])


class Site:
    def __init__(self, folder):
        self.pages = {path: Page(path.read_text()) for path in sorted(folder.rglob("*.html"))}

    def broken(self):
        """(page, link) of the links to this site that lead nowhere."""
        found = []
        for path, page in self.pages.items():
            for link in page.links + page.loads:
                parts = urllib.parse.urlsplit(link)
                if parts.scheme or parts.netloc or path.name == "404.html":
                    continue
                target = (path.parent / urllib.parse.unquote(parts.path)).resolve() if parts.path else path
                target = target / "index.html" if parts.path.endswith("/") or parts.path == "." else target
                place = urllib.parse.unquote(parts.fragment)
                if not target.is_file() or place and target in self.pages and place not in self.pages[target].places:
                    found.append((path.name, link))
        return found

    def from_elsewhere(self):
        """(page, address) of what pages load from other hosts."""
        return [(path.name, load) for path, page in self.pages.items() for load in page.loads
                if urllib.parse.urlsplit(load).netloc]


class Checks(unittest.TestCase):
    def test_find_what_is_wrong(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "index.html").write_text(
                '<h1 id="top">x</h1><a href="#top"></a><a href="two.html#here"></a><a href="two.html#there"></a>'
                '<a href="no.html"></a><img src="no.png"><script src="https://example.org/x.js"></script>'
                '<a href="https://example.org">may be</a>')
            (folder / "two.html").write_text('<p id="here">')
            site = Site(folder)
            self.assertEqual(site.broken(), [("index.html", link) for link in ("two.html#there", "no.html", "no.png")])
            self.assertEqual(site.from_elsewhere(), [("index.html", "https://example.org/x.js")])


def quotations(text):
    """(file, lines) of the code that a page quotes: a block below a line that ends with "From `FILE`:"; "..." leaves out."""
    found = []
    for file, block in re.findall(r"From\s+`([^`]+)`:\n\n```\w+\n(.*?)^```$", text, re.M | re.S):
        found += [(file, piece.strip("\n")) for piece in re.split(r"^ *\.\.\.\n", block, flags=re.M)]
    return found


class Quotations(unittest.TestCase):
    def test_are_what_the_file_says(self):
        found = quotations((ROOT / "CONTRIBUTING.md").read_text())
        self.assertGreater(len(found), 5)
        for file, piece in found:
            unindented = lambda text: "\n".join(line.strip() for line in text.splitlines())
            self.assertIn(unindented(piece), unindented((ROOT / file).read_text()), file)

    def test_are_found_piece_by_piece(self):
        page = "so. From\n`a/b.cc`:\n\n```cpp\nint a;\n...\n  int b;\n```\n\nFrom there:\n\n```cpp\nint c;\n```\n"
        self.assertEqual(quotations(page), [("a/b.cc", "int a;"), ("a/b.cc", "  int b;")])


def paths(text):
    """The files and folders of the source tree that a page names between backticks, alone or to begin a command."""
    rooms = "agent|base|bench|bus|cmake|configs|docs|experiment|idl|orchestrator|physics_server|scripts|system|tests"
    return re.findall(rf"`((?:{rooms})/[\w./-]*\w/?)(?=[` ])", text)


def selections(text):
    """The regular expressions of `ctest -R` that a page names, each alternative by itself."""
    found = re.findall(r"ctest (?:--test-dir \S+ |-V )*-R (?:'([^']+)'|([^\s`]+))", text)
    return [one for quoted, bare in found for one in (quoted or bare).replace("\\|", "|").split("|")]


def tests_of_this_tree():
    """Names as ctest has them, but for the parameters of a test."""
    found = set(re.findall(r"add_test\(NAME (\w+)", (ROOT / "CMakeLists.txt").read_text()))
    for path in (ROOT / "tests").rglob("*.cc"):
        text = path.read_text()
        prefixes = {suite: prefix for prefix, suite in re.findall(r"INSTANTIATE_TEST_SUITE_P\(\s*(\w+),\s*(\w+)", text)}
        for suite, name in re.findall(r"^TEST(?:_F|_P)?\(\s*(\w+),\s*(\w+)\)", text, re.M):
            found.add(f"{prefixes[suite]}/{suite}.{name}" if suite in prefixes else f"{suite}.{name}")
    return found


class Names(unittest.TestCase):
    PAGES = [*(ROOT / "docs").glob("*.md"), ROOT / "README.md", ROOT / "CONTRIBUTING.md"]

    def test_of_files_are_those_of_the_tree(self):
        named = {(page.name, path) for page in self.PAGES for path in paths(page.read_text())}
        self.assertGreater(len(named), 200)
        self.assertEqual({(page, path) for page, path in named if not (ROOT / path).exists()}, set())

    def test_of_tests_are_those_of_the_tree(self):
        tests = tests_of_this_tree()
        named = {(page.name, one) for page in self.PAGES for one in selections(page.read_text())}
        self.assertGreater(len(named), 100)
        self.assertEqual({(page, one) for page, one in named if not any(re.search(one, test) for test in tests)}, set())

    def test_are_found(self):
        page = ("`tests/a_test.py Errors`, `bus/b.cc`, `bus/`, `experiment/*.cc`, `agent/laws/<law>.cc`; "
                "`ctest -R 'A.B\\|^C'`, `ctest -V -R D`")
        self.assertEqual(paths(page), ["tests/a_test.py", "bus/b.cc"])
        self.assertEqual(selections(page), ["A.B", "^C", "D"])


class Documentation(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory())).resolve()
        built = subprocess.run([ROOT / "scripts/site", cls.folder], capture_output=True, text=True, timeout=LIMIT_S)
        assert built.returncode == 0, built.stdout + built.stderr
        assert built.stdout == f"{cls.folder}/index.html\n", built.stdout
        cls.site = Site(cls.folder)

    def test_every_link_leads_somewhere(self):
        self.assertGreater(sum(len(page.links) for page in self.site.pages.values()), 1000)
        self.assertEqual(self.site.broken(), [])

    def test_nothing_is_loaded_from_other_hosts(self):
        self.assertEqual(self.site.from_elsewhere(), [])

    def test_every_page_is_shown_and_in_the_navigation(self):
        start = self.folder / "index.html"
        linked = {(start.parent / urllib.parse.urlsplit(link).path).resolve() for link in self.site.pages[start].links}
        pages = [*(ROOT / "docs").glob("*.md"), ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md"]
        self.assertGreater(len(pages), 15)
        for page in pages:
            self.assertIn(self.folder / page.relative_to(ROOT).with_suffix(".html"), linked)


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/python3
"""The documentation as a site, built by scripts/site: all links lead somewhere, nothing comes from other hosts, all equations
are set in type. Code that pages quote is that of its file, and the files and tests that they name are there."""

import html.parser
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest
import urllib.parse

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.dont_write_bytecode = True  # the folder of the scripts may be read-only
sys.path.insert(0, str(ROOT / "scripts"))
import equations
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
        self.styles = {path: re.findall(r"""(?:url\(|@import )["']?([^"')]+)""", path.read_text())
                       for path in sorted(folder.rglob("*.css"))}

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
        found += [(path.name, load) for path, loads in self.styles.items() for load in loads
                  if not load.startswith("data:") and not (path.parent / load.split("#")[0].split("?")[0]).is_file()]
        return found

    def from_elsewhere(self):
        """(page, address) of what pages and their styles load from other hosts."""
        loads = {path: page.loads for path, page in self.pages.items()} | self.styles
        return [(path.name, load) for path in loads for load in loads[path] if urllib.parse.urlsplit(load).netloc]


class Checks(unittest.TestCase):
    def test_find_what_is_wrong(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "index.html").write_text(
                '<h1 id="top">x</h1><a href="#top"></a><a href="two.html#here"></a><a href="two.html#there"></a>'
                '<a href="no.html"></a><img src="no.png"><script src="https://example.org/x.js"></script>'
                '<a href="https://example.org">may be</a>')
            (folder / "two.html").write_text('<p id="here">')
            (folder / "a.css").write_text("a { b: url(a.css), url('no.woff') } c { d: url(//example.org/e) }")
            site = Site(folder)
            self.assertEqual(site.broken(), [("index.html", link) for link in ("two.html#there", "no.html", "no.png")] +
                             [("a.css", load) for load in ("no.woff", "//example.org/e")])
            self.assertEqual(site.from_elsewhere(), [("index.html", "https://example.org/x.js"), ("a.css", "//example.org/e")])


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


def sections(page, heading):
    """{identifier: HTML} of the sections of a page, which begin with such headings."""
    parts = re.split(rf'<{heading} id="([^"]+)">', page)
    return dict(zip(parts[1::2], parts[2::2]))


class Equations(unittest.TestCase):
    def test_are_set_in_type_where_markdown_left_them(self):
        page = equations.with_equations('<pre class="math"><code>x &lt; \\alpha_1</code></pre><p>if $<code>y^2</code>$ and <code>z</code>')
        self.assertEqual(page.count('class="katex-display '), 1)
        self.assertEqual(page.count('class="katex"'), 2)
        self.assertIn('<annotation encoding="application/x-tex">x &lt; \\alpha_1</annotation>', page)
        self.assertTrue(page.endswith("and <code>z</code>"))
        self.assertEqual(equations.with_equations("<p>no $ here</p>"), "<p>no $ here</p>")

    def test_with_an_unknown_macro_are_refused(self):
        for tex in (r"a + \nomacro", r"\frac{1}{2", "é"):
            with self.assertRaises(equations.BadEquation):
                equations.typeset([("x", False), (tex, True)])

    def test_with_an_unknown_macro_end_the_build(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            (folder / "docs").mkdir()
            (folder / "docs/index.md").write_text("# One\n\n```math\na + \\nomacro\n```\n")
            (folder / "mkdocs.yml").write_text(
                f"INHERIT: {ROOT}/mkdocs.yml\ndocs_dir: docs\nsite_dir: site\nhooks: [{ROOT}/scripts/equations.py]\n"
                "extra_css: []\nnav: [index.md]\n")
            built = subprocess.run(["mkdocs", "build"], cwd=folder, capture_output=True, text=True, timeout=LIMIT_S)
            self.assertNotEqual(built.returncode, 0)
            self.assertIn("index.md: KaTeX parse error: Undefined control sequence: \\nomacro", built.stdout + built.stderr)


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

    def test_every_law_has_its_equation_set_in_type(self):
        laws = re.findall(r"^\| \[`(\w+)`\]\(#", (ROOT / "docs/laws.md").read_text(), re.M)
        self.assertGreater(len(laws), 20)
        shown = sections((self.folder / "docs/laws.html").read_text(), "h3")
        for law in laws:
            self.assertTrue('class="katex-display ' in shown[law], f"{law} has no equation")
        overview = shown["all-laws-on-one-page"]
        first_cells = r'<td><a href="#(\w+)">\w+</a></td>\s*<td><span (?:style="[^"]*"><span )?class="katex">'
        self.assertEqual(sorted(re.findall(first_cells, overview)), sorted(laws))

    def test_no_equation_is_left_as_code(self):
        for path in self.site.pages:
            left = re.search(r'class="math"|\$<code>|</code>\$|katex-error', path.read_text())
            self.assertFalse(left, f"{path.name}: {left and left[0]}")

    def test_every_page_is_shown_and_in_the_navigation(self):
        start = self.folder / "index.html"
        linked = {(start.parent / urllib.parse.urlsplit(link).path).resolve() for link in self.site.pages[start].links}
        pages = [*(ROOT / "docs").glob("*.md"), ROOT / "CONTRIBUTING.md", ROOT / "CHANGELOG.md"]
        self.assertGreater(len(pages), 15)
        for page in pages:
            self.assertIn(self.folder / page.relative_to(ROOT).with_suffix(".html"), linked)


if __name__ == "__main__":
    unittest.main()

#!/usr/bin/python3
"""What a package holds beside programs: completion for shells, manual pages, the package of ROS 2. All of it must tell of
the same verbs, options and version as the programs, and the files that scripts/package has made must be complete."""

import gzip
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = pathlib.Path(os.environ["MASCOT_BINARY_DIR"]).resolve()
PROGRAM = BUILD / "orchestrator"
LIMIT_S = 120  # of a command
COMPLETION = ROOT / "scripts/completion"


def output_of(*command, **options):
    return subprocess.run([str(word) for word in command], capture_output=True, text=True, check=True, timeout=LIMIT_S,
                          **options).stdout


def names(text, section):
    """Of the rows of a section of a help: {"-h,--help": "Print this ..."}, what stands behind a name included."""
    rows = re.search(rf"^{section}:\n((?: .*\n?)*)", text, re.M)
    return dict(re.findall(r"^  (\S+) *(.*)", rows[1], re.M)) if rows else {}


class Helps:
    """What the program tells of itself, asked once."""

    def __init__(self):
        self.verbs = names(output_of(PROGRAM, "--help"), "Subcommands")
        self.helps = {verb: output_of(PROGRAM, verb, "--help") for verb in self.verbs}
        self.options = {verb: set(",".join(names(text, "Options")).split(",")) for verb, text in self.helps.items()}


HELPS = Helps()
LAWS = {line for line in output_of(PROGRAM, "laws").splitlines() if re.match(r"\w+$", line)}


class Readme(unittest.TestCase):
    def test_its_first_experiment_gives_the_summary_that_it_shows(self):
        page = (ROOT / "README.md").read_text().partition("## A first experiment")[2].partition("\n## ")[0]
        blocks = re.findall(r"^```(\w*)\n(.*?)^```$", page, re.M | re.S)
        experiment = next(block for language, block in blocks if language == "toml")
        shown = next(block for _, block in blocks if "predicted" in block)
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "first.toml"
            path.write_text(experiment)
            output_of(PROGRAM, "check", path)
            printed = output_of(PROGRAM, "up", path, "--engine", "inprocess", "--set", "output.save_plot=false",
                                "--out", pathlib.Path(folder) / "first")
        rounded = lambda text: re.sub(r"\S+ m off", "... m off", text)  # what rounding leaves
        self.assertIn(rounded(shown), rounded(printed))


def options_of(text):
    """Of the first column of tables of Markdown: {"--at": "ADDRESS:PORT", ...}."""
    rows = re.findall(r"^\| `(--[a-z-]+) ?((?:[^`])*)` \|", text, re.M)
    return {name: value.replace("\\|", "|") for name, value in rows}


def typed_in(text):
    """The commands of `orchestrator` in a page of Markdown, each as a list of words: in blocks, and between backticks."""
    blocks = re.findall(r"^```(\w*)[^\n]*\n(.*?)^```$", text, re.M | re.S)
    lines = [line for language, block in blocks if language in ("", "console", "bash", "sh")
             for line in block.splitlines() if not line.startswith("  ")]  # drawings are indented
    lines += [line for line in re.findall(r"`([^`\n]+)`", re.sub(r"^```.*?^```$", "", text, flags=re.M | re.S))]
    commands = [command for line in lines
                for command in re.findall(r"(?:^|[ /(\"'])orchestrator (?! )((?:[^|;#`&]|(?<! )\|)+)", line)]
    return [command.replace("\\|", "|").split() for command in commands]


class CommandLine(unittest.TestCase):
    """docs/command_line.md has every verb and every option, and no page names one that is not there."""

    PAGE = (ROOT / "docs/command_line.md").read_text()

    def sections(self):
        found = re.findall(r"^### ([a-z ]+)\n(.*?)(?=^##|\Z)", self.PAGE, re.M | re.S)
        self.assertEqual(len(dict(found)), len(found), "a verb has two sections")
        return dict(found)

    def helps(self):
        """{verb: {option: value, ...}, ...}, as the program tells it; -h and --help, which all have, left out."""
        texts = {**HELPS.helps, "sweep merge": output_of(PROGRAM, "sweep", "merge", "--help")}
        return {verb: {name for name in ",".join(names(text, "Options")).split(",") if name not in ("-h", "--help")}
                for verb, text in texts.items()}

    def test_it_has_each_verb_and_no_other(self):
        self.assertEqual(set(self.sections()), set(self.helps()))
        self.assertEqual(set(re.findall(r"\]\(#([a-z-]+)\)", self.PAGE)), {verb.replace(" ", "-") for verb in self.helps()})

    def test_it_has_each_option_of_a_verb_and_no_other(self):
        self.assertGreater(sum(len(options) for options in self.helps().values()), 60)
        for verb, options in self.helps().items():
            with self.subTest(verb=verb):
                self.assertEqual(set(options_of(self.sections()[verb])), options)

    def test_it_has_the_choices_of_an_option(self):
        for verb, text in {**HELPS.helps, "sweep merge": output_of(PROGRAM, "sweep", "merge", "--help")}.items():
            for name, choices in re.findall(r"^  (--[a-z-]+) \w+:\{(.*?)\}", text, re.M):
                with self.subTest(verb=verb, option=name):
                    row = re.search(rf"^\| `{name}\b.*", self.sections()[verb], re.M)[0]
                    for choice in choices.split(","):
                        self.assertRegex(row, rf"\b{choice}\b")

    def test_it_has_what_may_be_sent_to_a_run(self):
        usage = re.search(r"words WHAT \.\.\. +(.*)", HELPS.helps["send"])[1]
        requests = re.findall(r"^\| ((?:`[^`]+`(?:, )?)+) \|", self.sections()["send"], re.M)
        shown = [request for row in requests for request in re.findall(r"`([^`]+)`", row) if not request.startswith("--")]
        self.assertEqual(set(shown), set(usage.split(" | ")))

    def test_it_has_the_options_of_the_programs_that_a_run_starts(self):
        section = self.PAGE.partition("## The programs that a run starts")[2]
        told = set().union(*(names(output_of(BUILD / program, "--help"), "Options") for program in ("agent", "physics_server", "vehicle")))
        self.assertEqual(set(options_of(section)), told - {"-h,--help"})

    def test_pages_name_no_verb_and_no_option_that_is_not_there(self):
        helps = self.helps()
        pages = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").glob("*.md"))]
        commands = [(page.name, words) for page in pages for words in typed_in(page.read_text())]
        self.assertGreater(len(commands), 100)
        for page, words in commands:
            with self.subTest(page=page, command=" ".join(words)):
                verb = " ".join(words[:2]) if " ".join(words[:2]) in helps else words[0]
                if verb in ("--help", "--version", "help", "VERB"):
                    continue
                self.assertIn(verb.rstrip(","), {*helps, "..."})
                ours = re.sub(r"(--slurm-option)[ =]\S+", r"\1", " ".join(words))  # what follows is an option of sbatch
                named = set(re.findall(r"(?<![^ \[(|])--[a-z][a-z-]*", ours))
                self.assertLessEqual(named, {*helps.get(verb, ()), "--help"})

    def test_such_a_name_would_be_found(self):
        text = "```\n$ orchestrator up a.toml --vieuw  # no --such\n```\n`orchestrator plott RUN --size column\\|page` here\n"
        self.assertEqual(typed_in(text), [["up", "a.toml", "--vieuw"], ["plott", "RUN", "--size", "column|page"]])
        self.assertEqual(typed_in("```sh\norchestrator ps --jsom\n```\n"), [["ps", "--jsom"]])
        between = "```toml\na = 1\n```\nEach orchestrator makes one.\n```\n$ orchestrator ps\n```\n"
        self.assertEqual(typed_in(between), [["ps"]])
        self.assertEqual(options_of("| `--size screen\\|column` | x |\n| `--json` | y |\n"), {"--size": "screen|column", "--json": ""})


class Completion:
    """What a shell offers for the last of some words, as a set. Subclasses say how to ask it."""

    def ask(self, questions, folder):
        raise NotImplementedError

    def offered(self, *words):
        return self.ask([words], ROOT)[0]

    def test_verbs_are_those_of_the_program(self):
        self.assertGreater(len(HELPS.verbs), 10)
        self.assertEqual(self.offered(""), set(HELPS.verbs))
        self.assertEqual(self.offered("help", ""), set(HELPS.verbs))

    def test_options_are_those_of_the_verb(self):
        answers = self.ask([(verb, "--") for verb in HELPS.verbs], ROOT)
        for verb, answer in zip(HELPS.verbs, answers):
            with self.subTest(verb=verb):
                self.assertIn("--help", answer)
                self.assertEqual(answer | {"-h"}, HELPS.options[verb])

    def test_values_of_an_option_are_those_that_its_help_lists(self):
        self.assertEqual(self.offered("up", "--engine", ""), {"dds", "inprocess"})
        self.assertEqual(self.offered("export", "--format", ""), {"npz", "csv", "mat"})
        self.assertEqual(self.offered("export", "--force", "--format", ""), {"npz", "csv", "mat"})

    def test_laws_are_those_of_the_program(self):
        self.assertGreater(len(LAWS), 10)
        self.assertEqual(self.offered("laws", ""), LAWS)

    def test_what_may_be_sent_to_a_run(self):
        self.assertLess({"pause", "resume", "goto", "set"}, self.offered("send", ""))
        self.assertEqual(self.offered("send", "pause", ""), set())

    def test_a_value_that_nobody_lists_gets_no_offer(self):
        self.assertEqual(self.offered("up", "--seed", ""), set())


class Bash(Completion, unittest.TestCase):
    SCRIPT = """
        . "$1"; shift
        program=$1; shift
        while [ $# -gt 0 ]; do
          COMP_WORDS=("$program" "${@:2:$1}") COMP_CWORD=$1; shift "$(($1 + 1))"
          _orchestrator "$program" "${COMP_WORDS[COMP_CWORD]}" "${COMP_WORDS[COMP_CWORD - 1]}"
          printf '%s\\n' "${COMPREPLY[@]}" --------
        done"""

    def ask(self, questions, folder):
        words = [word for question in questions for word in (len(question), *question)]
        text = output_of("bash", "--norc", "-c", self.SCRIPT, "bash", COMPLETION / "orchestrator.bash", PROGRAM, *words, cwd=folder)
        return [set(answer.split("\n")) - {""} for answer in text.split("--------\n")[:-1]]

    def test_a_value_behind_an_equals_sign_which_bash_takes_for_a_word(self):
        self.assertEqual(self.offered("up", "--engine", "="), {"dds", "inprocess"})
        self.assertEqual(self.offered("up", "--engine", "=", "in"), {"inprocess"})

    def test_a_value_that_may_be_left_out_is_none(self):
        self.assertEqual(self.offered("up", "--view", "--fo"), {"--force"})

    def test_a_folder_that_begins_with_a_tilde(self):
        self.assertEqual(output_of("bash", "-c", f". '{COMPLETION}/orchestrator.bash'; COMP_WORDS=(x v) COMP_CWORD=1;"
                                   "_orchestrator '~/orchestrator' veri x; echo ${COMPREPLY[@]}",
                                   env={"HOME": str(BUILD), "PATH": os.environ["PATH"]}), "verify\n")

    def test_files_by_what_an_argument_is(self):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            for file in ["my run.toml", "run.mcap", "notes.txt"]:
                (folder / file).touch()
            (folder / "a run").mkdir()
            questions = [("check", ""), ("info", ""), ("recover", ""), ("up", "--out", ""), ("plot", "a"), ("up", "my")]
            self.assertEqual(self.ask(questions, folder),
                             [{"my run.toml", "a run"}, {"run.mcap", "a run"},
                              {"my run.toml", "run.mcap", "notes.txt", "a run"}, {"a run"}, {"a run"}, {"my run.toml"}])


@unittest.skipUnless(shutil.which("zsh"), "there is no zsh")
class Zsh(Completion, unittest.TestCase):
    # Stands in for zsh's own functions, which draw on the terminal: prints what they are given.
    SCRIPT = """
        completion=$1; program=$2; shift 2
        compadd() { print -rl -- "${(@P)argv[-1]}" }
        _describe() { print -rl -- "${(@)${(@P)argv[-1]}%%:*}" }
        _files() { print -r -- "files $*" }
        _message() { }
        compset() { }
        while (( $# )); do
          words=("$program" "${@[2,$1+1]}") CURRENT=$(($1 + 1)); shift $CURRENT
          PREFIX=$words[-1]
          . "$completion"
          print -r -- --------
        done"""

    def ask(self, questions, folder):
        words = [word for question in questions for word in (len(question), *question)]
        text = output_of("zsh", "-f", "-c", self.SCRIPT, "zsh", COMPLETION / "_orchestrator", PROGRAM, *words, cwd=folder)
        return [set(answer.split("\n")) - {""} for answer in text.split("--------\n")[:-1]]

    def test_files_by_what_an_argument_is(self):
        self.assertEqual(self.ask([("check", ""), ("info", ""), ("up", "--out", "")], ROOT),
                         [{"files -g *.toml"}, {"files -g *.mcap(-.)"}, {"files -/"}])

    def test_a_value_behind_an_equals_sign(self):
        self.assertEqual(self.offered("up", "--engine="), {"dds", "inprocess"})


class Version(unittest.TestCase):
    VERSION = re.search(r"project\(mascot VERSION (\S+)", (ROOT / "CMakeLists.txt").read_text())[1]

    def test_the_program_tells_it(self):
        self.assertEqual(output_of(PROGRAM, "--version"), f"mascot {self.VERSION}\n")

    def test_the_package_of_ros_has_it(self):
        self.assertIn(f"<version>{self.VERSION}</version>", (ROOT / "idl/mascot_msgs/package.xml").read_text())

    def test_the_changelog_speaks_of_it(self):
        newest = re.search(r"^## (\d\S*)", (ROOT / "CHANGELOG.md").read_text(), re.M)[1]
        self.assertEqual(newest, self.VERSION)


def is_newer(path):
    """Whether it was made of the program that there is now."""
    return path.exists() and path.stat().st_mtime >= PROGRAM.stat().st_mtime


@unittest.skipUnless(is_newer(BUILD / "man/physics_server.1.gz"),
                     "there are no manual pages of this build: cmake --build build/release --target man_pages")
class ManualPages(unittest.TestCase):
    def test_there_is_one_of_each_verb_and_program(self):
        pages = {path.name for path in (BUILD / "man").iterdir()}
        self.assertEqual(pages, {f"{name}.1.gz" for name in ["orchestrator", "agent", "physics_server", "vehicle",
                                                              *(f"orchestrator-{verb}" for verb in HELPS.verbs)]} |
                         {"mascot.toml.5.gz"})

    def test_that_of_experiment_files_has_every_key(self):
        text = gzip.decompress((BUILD / "man/mascot.toml.5.gz").read_bytes()).decode().replace("\\-", "-")
        self.assertIn(".SH NAME\nmascot.toml - an experiment of decentralised control\n", text)
        keys = subprocess.run([PROGRAM, "keys", "--names"], check=True, capture_output=True, text=True, timeout=60).stdout.split()
        self.assertGreater(len(keys), 200)
        for key in keys:
            self.assertIn(f"\n.B {key}\n", text)

    def test_they_tell_what_whatis_looks_for_and_all_options(self):
        for verb, summary in HELPS.verbs.items():
            with self.subTest(verb=verb):
                text = gzip.decompress((BUILD / f"man/orchestrator-{verb}.1.gz").read_bytes()).decode().replace("\\-", "-")
                self.assertIn(f".SH NAME\norchestrator-{verb} - {summary}\n", text)
                for option in HELPS.options[verb]:
                    self.assertRegex(text, rf"(?m)^(\\fB)?{option}|,{option}")


def files_in(path):
    """The file itself, or all in a folder but what was built there."""
    if path.is_file():
        return [path]
    return [file for file in path.rglob("*") if file.is_file() and "build" not in file.relative_to(path).parts]


def packaged_files():
    """What scripts/package puts into the package: programs, manual pages, and what install() names in the tree."""
    makers = [ROOT / "CMakeLists.txt", ROOT / "cmake/package.cmake"]
    words = " ".join(re.findall(r"install\((?:FILES|PROGRAMS|DIRECTORY) ([^)]*?)\s+DESTINATION",
                                "".join(maker.read_text() for maker in makers))).split()
    named = [ROOT / word for word in words if "$" not in word]
    programs = [BUILD / name for name in ("orchestrator", "agent", "physics_server", "vehicle", "team_fmu.so")]
    return [file for path in (*makers, *programs, BUILD / "man", *named) for file in files_in(path)]


def why_old(package, files):
    """Why a package is not one of these files as they are; "": it is. A file that was moved or copied is new, too."""
    made = package.stat().st_mtime
    newer = next((file for file in files if max(file.stat().st_mtime, file.stat().st_ctime) > made), None)
    return f"{newer} is newer than {package}" if newer else ""


class Age(unittest.TestCase):
    def test_a_package_is_old_if_any_file_in_it_is_newer(self):
        with tempfile.TemporaryDirectory() as scratch:
            page, package = pathlib.Path(scratch, "page.js"), pathlib.Path(scratch, "a.deb")
            page.touch()
            package.touch()
            changed = page.stat().st_ctime
            os.utime(page, (0, 0))  # as of a file that was moved here
            os.utime(package, (0, changed - 1))
            self.assertEqual(why_old(package, [page]), f"{page} is newer than {package}")
            os.utime(package, (0, changed + 1))
            self.assertEqual(why_old(package, [page]), "")

    def test_all_that_is_installed_counts(self):
        counted = {path.relative_to(ROOT).as_posix() for path in packaged_files() if path.is_relative_to(ROOT)}
        self.assertLess({"README.md", "docs/sweep.md", "scripts/plot.py", "scripts/run_folder.py", "configs/leaderless.toml",
                         "orchestrator/live/page/index.html", "scripts/completion/_orchestrator", "agent/laws/plugin/plugin.h",
                         "docs/mascot.schema.json", "cmake/package.cmake"}, counted)
        self.assertIn(PROGRAM, packaged_files())


class Control(unittest.TestCase):
    def test_its_relations_to_other_packages_are_written_as_dpkg_reads_them(self):
        text = (BUILD / "CPackConfig.cmake").read_text()
        relations = re.findall(r'set\(CPACK_DEBIAN_(UNSPECIFIED|PYTHON)_PACKAGE_(DEPENDS|RECOMMENDS|SUGGESTS) "(.*)"\)', text)
        self.assertEqual(sorted(relation[:2] for relation in relations),
                         [(package, field) for package in ["PYTHON", "UNSPECIFIED"]
                          for field in ["DEPENDS", "RECOMMENDS", "SUGGESTS"]])
        one = r"[a-z0-9][a-z0-9+.-]+( \([<>=]+ [0-9.-]+\))?"
        for *field, names in relations:
            with self.subTest(field=field):
                self.assertRegex(names, rf"^{one}(, {one})*$")


PACKAGES = sorted((ROOT / "build/package").glob("mascot_*.deb")) + sorted((ROOT / "build/package").glob("python3-mascot_*.deb"))
NO_PACKAGE = why_old(PACKAGES[0], packaged_files()) if len(PACKAGES) == 2 else "they are not there"


@unittest.skipIf(NO_PACKAGE, f"no package of this build and tree (scripts/package makes it): {NO_PACKAGE}")
class Package(unittest.TestCase):
    def test_it_has_what_users_look_for(self):
        files = set(re.findall(r" \./(\S+)", output_of("dpkg-deb", "--contents", PACKAGES[0])))
        there = lambda folder, paths: {f"{folder}/{path}" for path in paths}
        tree = lambda start, pattern: [path.relative_to(ROOT / start).as_posix() for path in (ROOT / start).rglob(pattern)]
        for expected in [
                there("usr/bin", ["orchestrator", "agent", "physics_server", "vehicle"]),
                there("usr/share/mascot/configs", [*tree("configs", "*.toml"), *tree("configs", "*.onnx"), *tree("configs", "*.m")]),
                there("usr/share/mascot/page", tree("orchestrator/live/page", "*.*")),
                there("usr/share/mascot/idl", ["mascot.idl", "fastdds.xml", "qos.xml"]),
                there("usr/share/mascot/matlab", tree("matlab", "*.m")),
                there("usr/lib/mascot", ["team_fmu.so"]),
                there("usr/share/mascot", ["team_fmu.c"]),
                there("usr/share/mascot_msgs", ["package.xml", "CMakeLists.txt", *tree("idl/mascot_msgs", "*.msg")]),
                there("usr/share/man/man1", (path.name for path in (BUILD / "man").glob("*"))),
                there("usr/share/doc/mascot", ["README.md", "CHANGELOG.md", "copyright", "configs"]),
                there("usr/share/doc/mascot/docs", (path.name for path in (ROOT / "docs").glob("*.md"))),
                there("usr/share", ["bash-completion/completions/orchestrator", "zsh/vendor-completions/_orchestrator"])]:
            self.assertEqual(expected - files, set())

    def test_what_it_depends_on_is_computed_and_told(self):
        depends, recommends = (output_of("dpkg-deb", "--field", PACKAGES[0], field) for field in ["Depends", "Recommends"])
        for name in ["libfastrtps2.9", "libbullet3.24", "libpython3.11", "python3-numpy", "libjs-three", "libjs-dygraphs"]:
            self.assertRegex(depends, rf"\b{re.escape(name)}\b")
        self.assertIn("python3-matplotlib", recommends)
        self.assertIn("python3-optuna", recommends)

    def test_the_module_of_python_is_a_package_of_its_own(self):
        files = set(re.findall(r" \./(\S+)", output_of("dpkg-deb", "--contents", PACKAGES[1])))
        folder = "usr/lib/python3/dist-packages/mascot"
        names = {path.name for path in (ROOT / "python/mascot").iterdir() if path.suffix in (".py", ".typed")}
        self.assertEqual({file for file in files if not file.endswith("/")},
                         {f"{folder}/{name}" for name in names | {path.name for path in (BUILD / "python/mascot").glob("*.so")}})
        depends = output_of("dpkg-deb", "--field", PACKAGES[1], "Depends")
        for name in ["libbullet3.24", "python3-numpy", "python3 (>= 3.11)", "python3 (<< 3.12)"]:
            self.assertIn(name, depends)
        self.assertNotIn("libpython", depends)  # the module is inside of an interpreter


if __name__ == "__main__":
    unittest.main()

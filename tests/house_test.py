#!/usr/bin/python3
"""The tree against docs/architecture.md: rooms use what its tables say, and nothing else. The name of a law or a model
stands in its own files and rows only. The physics server links neither laws nor Python. What the document names is where
it says."""

import collections
import fnmatch
import keyword
import os
import pathlib
import re
import subprocess
import tempfile
import tokenize
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
LIMIT_S = 240  # of a command; ctest ends the test after 300 s, without a word
DOCUMENT = "docs/architecture.md"
FOLDERS = ["base", "system", "experiment", "idl", "bus", "agent", "physics_server", "vehicle", "python", "orchestrator"]
CPP = {".h", ".hpp", ".cc", ".cpp", ".inc"}

Room = collections.namedtuple("Room", "line floor name patterns library may_use")
Header = collections.namedtuple("Header", "line patterns where")
Ban = collections.namedtuple("Ban", "line rooms never")
Include = collections.namedtuple("Include", "path line name")


# --- the tables -----------------------------------------------------------------------------------------


def table(text, *headings):
    """Line number and cells, by heading, of each row of the table that has these headings."""
    rows, names = [], None
    for number, line in enumerate(text.splitlines(), 1):
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if not line.startswith("|"):
            names = None
        elif set(headings) <= set(cells):
            names = cells
        elif names and not set(line) <= set("|-: "):
            rows.append((number, dict(zip(names, cells))))
    if not rows:
        raise ValueError(f"{DOCUMENT}: expected a table with the columns {', '.join(headings)}, got none")
    return rows


def quoted(cell):
    return re.findall(r"`([^`]+)`", cell)


class House:
    """What the tables of the document say."""

    def __init__(self, text):
        self.rooms = [
            Room(line, int(row["floor"]), quoted(row["room"])[0], quoted(row["files"]), quoted(row["library"])[0],
                 quoted(row["may use"]))
            for line, row in table(text, "floor", "room", "files", "library", "may use")
        ]
        self.headers = [Header(line, quoted(row["header"]), quoted(row["who may include it"]))
                        for line, row in table(text, "header", "who may include it")]
        self.bans = [Ban(line, quoted(row["rooms"]), quoted(row["never reach"]))
                     for line, row in table(text, "rooms", "never reach")]
        self.by_name = {room.name: room for room in self.rooms}

    def rooms_of(self, path):
        """Names of the rooms that claim a file, by what names it best: its own name, else a pattern, else its folder,
        else the folder around that. One, unless the table is wrong."""
        claims = [(rank(pattern), room.name) for room in self.rooms for pattern in room.patterns if fits(path, pattern)]
        best = max(claims, default=(None,))[0]
        return sorted({name for claim, name in claims if claim == best})

    def way(self, start, end):
        """The rooms from one to another along arrows of the table; none: there is no way."""
        ways, reached = [[start]], {start}
        for way in ways:
            if way[-1] == end:
                return way
            for used in self.by_name[way[-1]].may_use if way[-1] in self.by_name else []:
                if used not in reached:
                    reached.add(used)
                    ways.append([*way, used])
        return []


def rank(pattern):
    return (0, pattern.count("/")) if pattern.endswith("/") else (1 if "*" in pattern else 2, 0)


def fits(path, pattern):
    if pattern.endswith("/"):
        return path.startswith(pattern)
    return pattern.count("/") == path.count("/") and fnmatch.fnmatchcase(path, pattern)


# --- rooms and includes ---------------------------------------------------------------------------------


def sources(root, folders, suffixes):
    return [path.relative_to(root).as_posix() for folder in folders for path in sorted((root / folder).rglob("*"))
            if path.suffix in suffixes and path.is_file()]


def includes(root, paths):
    for path in paths:
        for number, line in enumerate((root / path).read_text().splitlines(), 1):
            if found := re.match(r'\s*#\s*include\s*[<"]([^>"]+)[>"]', line):
                yield Include(path, number, found[1])


def faults_of_rooms(root, house):
    """Faults of the table and of the includes that go from room to room."""
    paths = sources(root, FOLDERS, CPP)
    rooms = {path: house.rooms_of(path) for path in paths}
    for path, claims in rooms.items():
        if len(claims) != 1:
            yield f"{path}:1: is in {'two rooms: ' + ', '.join(claims) if claims else 'no room'} ({DOCUMENT})"
    ridden = set()
    for include in includes(root, paths):
        if include.name not in rooms or len(rooms[include.path]) != 1 or len(rooms[include.name]) != 1:
            continue
        (user,), (used,) = rooms[include.path], rooms[include.name]
        ridden.add((user, used))
        if user != used and used not in house.by_name[user].may_use:
            yield f"{include.path}:{include.line}: includes {include.name}: {user} may not use {used} ({DOCUMENT})"
    for room in house.rooms:
        for pattern in room.patterns:
            if not any(fits(path, pattern) for path in paths):
                yield f"{DOCUMENT}:{room.line}: {room.name}: there is no file {pattern}"
        if [room.name] not in rooms.values():
            yield f"{DOCUMENT}:{room.line}: {room.name}: no file is in this room"
        for used in room.may_use:
            if used not in house.by_name:
                yield f"{DOCUMENT}:{room.line}: {room.name} may use {used}: there is no such room"
            elif house.by_name[used].floor >= room.floor:
                yield f"{DOCUMENT}:{room.line}: {room.name} may use {used}, which is not on a lower floor"
            elif (room.name, used) not in ridden:
                yield f"{DOCUMENT}:{room.line}: {room.name} may use {used}, but no include does"


def faults_of_headers(root, house):
    """Faults of includes of what is not ours, and of the table about them. Standard C++ headers have no dot: all may."""
    paths = sources(root, FOLDERS, CPP)
    used = set()
    for include in includes(root, paths):
        if include.name in paths or "." not in include.name and "/" not in include.name:
            continue
        at = f"{include.path}:{include.line}: includes {include.name}"
        is_about = lambda row: any(fnmatch.fnmatchcase(include.name, pattern) for pattern in row.patterns)
        row = next(filter(is_about, house.headers), None)
        if row is None:
            yield f"{at}: it is not ours, and in no row of the table of headers ({DOCUMENT})"
            continue
        claims = house.rooms_of(include.path)
        used |= {(row.line, name) for name in [include.path, *claims]}
        if row.where and not {include.path, *claims} & set(row.where):
            yield f"{at}: only {', '.join(row.where)} may ({DOCUMENT}:{row.line})"
    for row in house.headers:
        for name in row.where:
            if (row.line, name) not in used:
                yield f"{DOCUMENT}:{row.line}: {name} may include {', '.join(row.patterns)}, but does not"


def faults_of_bans(house):
    """Arrows that the table may not have, whatever rides on them."""
    for ban in house.bans:
        for name in [*ban.rooms, *ban.never]:
            if name not in house.by_name:
                yield f"{DOCUMENT}:{ban.line}: {name}: there is no such room"
        for start in ban.rooms:
            for end in ban.never:
                if way := house.way(start, end):
                    yield f"{DOCUMENT}:{ban.line}: {start} must never reach {end}, and does: {' -> '.join(way)}"


def faults_of_libraries(cmake, house):
    """Faults of the column of libraries."""
    built = {f"mascot_{name}" for name in re.findall(r"^\s*mascot_room\((\w+)", cmake, re.M)}
    programs = set(re.findall(r"^\s*add_executable\((\w+)", cmake, re.M))
    listed = {room.library for room in house.rooms}
    for room in house.rooms:
        if room.library not in built | programs:
            yield f"{DOCUMENT}:{room.line}: {room.name}: CMakeLists.txt makes no {room.library}"
    yield from (f"CMakeLists.txt: {name} is in no row of {DOCUMENT}" for name in sorted(built - listed))


# --- pieces of laws -------------------------------------------------------------------------------------

LAWS = "agent/laws"
SHARED = f"{LAWS}/parts"
FOR_USERS = {"agent/laws/plugin/plugin.h", "agent/laws/plugin/plugin_params.h"}  # installed


def faults_of_pieces(root):
    """Pieces of one law that others use, and pieces in the folder of what laws share that only one law uses."""
    paths = sources(root, FOLDERS, CPP)
    users = collections.defaultdict(set)
    for include in includes(root, paths):
        home, folder = [os.path.dirname(path) for path in (include.name, include.path)]
        if os.path.splitext(include.name)[0] != os.path.splitext(include.path)[0]:
            users[include.name].add(folder)
        if include.name in paths and is_inside(home, LAWS) and folder != home and include.name not in FOR_USERS \
                and not is_inside(home, SHARED, or_itself=True):
            yield (f"{include.path}:{include.line}: includes {include.name}, a piece of another law: what laws share is in "
                   f"{SHARED}/")
    for path in paths:
        folders = users[path]
        if os.path.dirname(path) == SHARED and path.endswith(".h") and len(folders) == 1 and is_inside(*folders, LAWS) \
                and folders != {SHARED}:
            yield f"{path}:1: only {min(folders)}/ uses it: it belongs there"


def is_inside(folder, parent, or_itself=False):
    return folder.startswith(f"{parent}/") or or_itself and folder == parent


# --- names of laws and models ---------------------------------------------------------------------------


def names_in_rows(root, path):
    return re.findall(r'\.name = "(\w+)"', (root / path).read_text())


def files_of_laws(root):
    """The file of each law, by the law's name: it ends with the function that returns the law's row."""
    return {name: path.relative_to(root).as_posix() for path in sorted((root / LAWS).rglob("*.cc"))
            for name in re.findall(r'return \{\.name = "(\w+)"', path.read_text())}


CPP_TOKEN = re.compile(r"""//[^\n]* | /\*.*?\*/                                # comments
                         | R"(?P<mark>[^(\s"]*)\((?P<raw>.*?)\)(?P=mark)"      # raw strings
                         | "(?P<text>(?:\\.|[^"\\\n])*)"
                         | \b\d[\w.']* | '(?:\\.|[^'\\\n])+'                   # 1'000 is a number, 'a' a character
                         """, re.S | re.X)


def cpp_literals(text):
    """Line and text of each string literal, and whether it is a key: what json["consensus"] is asked for."""
    for found in CPP_TOKEN.finditer(text):
        literal = found["raw"] if found["raw"] is not None else found["text"]
        if literal is not None:
            is_key = re.search(r"[\w\])]\s*\[\s*$", text[: found.start()]) and re.match(r"\s*\]", text[found.end():])
            yield text.count("\n", 0, found.start()) + 1, literal, bool(is_key)


def python_literals(path):
    """Likewise; a key is also what summary.get("consensus") is asked for."""
    skipped = {tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT}
    with tokenize.open(path) as file:
        tokens = [token for token in tokenize.generate_tokens(file.readline) if token.type not in skipped]
    words = ["", "", *(token.string for token in tokens), ""]
    for i, token in enumerate(tokens):
        if token.type == tokenize.STRING:
            before, around = words[i], (words[i + 1], words[i + 3])
            is_subscript = around == ("[", "]") and re.fullmatch(r"\w+|\)|\]", before) and not keyword.iskeyword(before)
            is_key = bool(is_subscript) or (before, around[0]) == ("get", "(")
            yield token.start[0], re.sub(r"^\w*", "", token.string), is_key


def faults_of_names(root):
    """String literals that are the name of a law or a model, outside its own files and rows."""
    homes = {name: [path, path.removesuffix("cc") + "h"] for name, path in files_of_laws(root).items()}
    for name in names_in_rows(root, "experiment/model_traits.cc"):
        homes[name] = ["experiment/model_traits.cc", "agent/controllers.cc", "physics_server/models.cc",
                       f"agent/controllers/{name}.cc", f"physics_server/models/{name}.cc"]
    for path in sources(root, [*FOLDERS, "scripts"], CPP | {".py"}):
        literals = python_literals(root / path) if path.endswith(".py") else cpp_literals((root / path).read_text())
        for line, text, is_key in literals:
            name = text.strip("\\\"'")
            if name in homes and not is_key and not any(fits(path, home) for home in homes[name]):
                yield f"{path}:{line}: \"{name}\": ask the row of the law or model, in {homes[name][0]}"


# --- what a program is made of --------------------------------------------------------------------------


def output_of(*command):
    return subprocess.run([str(word) for word in command], capture_output=True, text=True, check=True,
                          timeout=LIMIT_S).stdout


def functions_of(path, kinds):
    """Functions of a program or library, by their letters in nm: T can be called from elsewhere, t cannot. The linker makes
    t of what a library hides from other programs (CXX_VISIBILITY_PRESET)."""
    functions = set(re.findall(rf"^[0-9a-f]+ [{kinds}] (.+)$", output_of("nm", "-C", "--defined-only", path), re.M))
    if not functions:
        raise ValueError(f"{path}: expected functions, got none: stripped?")
    return functions


def faults_of_linking(program, libraries):
    if "libpython" in output_of("ldd", program):
        yield f"{program.name} links Python"
    for library in libraries:
        if shared := functions_of(program, "Tt") & functions_of(library, "T"):
            yield f"{program.name} holds {len(shared)} functions of {library.name}, such as {min(shared)}"


def shared_functions(path):
    """Functions of an object of which the linker takes one for the whole program, out of whichever object."""
    return re.findall(r"^[0-9a-f]+ [WVuw] (.+)$", output_of("nm", "-C", "--defined-only", path), re.M)


# --- text from outside ------------------------------------------------------------------------------------

JSON_READER = "orchestrator/formats/outside_json.cc"
READS_JSON = re.compile(r"\b\w*[Jj]son\s*::\s*(?:parse|accept|sax_parse|from_\w+)\b|\"_json\b|>>\s*\w*json\b")


def faults_of_json(root):
    """Places where text becomes JSON elsewhere than where the limits are."""
    for path in sources(root, FOLDERS, CPP):
        for number, line in enumerate((root / path).read_text().splitlines(), 1):
            if path != JSON_READER and READS_JSON.search(line.split("//")[0]):
                yield f"{path}:{number}: JSON is read by ReadJson(), which has limits ({JSON_READER})"


# --- the operating system ---------------------------------------------------------------------------------

# What is asked of the operating system in one place each, for all: the call, where, and what others use.
ONE_PLACE = [
    (r"(?<![\w.>])(?:v?fork|posix_spawnp?|popen|system|execl[pe]?|execv\w*)\s*\(", ["system/spawn.cc", "bus/leave.cc"],
     "programs are started by Spawn() and Fork() (system/spawn.h)"),
    (r"\bpipe2?\s*\(", ["system/descriptor.cc"], "pipes are made by MakePipe() (system/descriptor.h)"),
    (r"\bwait(?:pid|id|3|4)\s*\(|(?<![\w.>])kill(?:pg)?\s*\(", ["system/child_process.cc", "system/descendants.cc"],
     "a child process is owned by a ChildProcess (system/child_process.h)"),
    (r"\bPR_SET_PDEATHSIG\b", ["system/spawn.cc", "agent/user_code/law_at_work.cc"],
     "a process dies with another by DieWith() (system/spawn.h)"),
    (r"(?<![\w.>])_[eE]xit\s*\(", ["agent/user_code/law_at_work.cc"], "a process is ended at once by EndNow() (system/end_now.h)"),
    (r"==\s*SIG_IGN\b", ["system/stop_signal.cc"], "IsIgnored() tells (system/stop_signal.h)"),
    (r"\bofstream\b|\bbasic_file_sink\w*", [],
     "files are written by what checks each write: WholeFile, OutputFile, LogFile, LeftFile"),
]


def faults_of_calls(root):
    """Calls of the operating system elsewhere than where they are made for all."""
    for path in sources(root, FOLDERS, CPP):
        text = re.sub(r"//[^\n]*", "", (root / path).read_text())
        if path == "agent/python/guard.cc":  # Python's words
            continue
        for number, line in enumerate(text.splitlines(), 1):
            for call, places, words in ONE_PLACE:
                if path not in places and re.search(call, re.sub(r'"(?:\\.|[^"\\])*"', '""', line)):
                    yield f"{path}:{number}: {words}"


# --- where things are ------------------------------------------------------------------------------------

OURS = [*FOLDERS, "tests", "scripts", "cmake", "docs", "configs"]
IS_PATH = re.compile(r"[\w.*<>/-]+(?:/|\.(?:cc|h|inc|py|mjs|idl|cmake|yml))")
NAME = re.compile(r"[A-Za-z_]\w*(?:::\w+)*(?:\.\.\.)?")


def files_of(root, words, near=None):
    """The files that a path in the document is of. `near`: a path before it, whose folder a bare name may be in."""
    pattern = re.sub(r"<\w+>", "*", words)
    folders = [""] if pattern.split("/")[0] in OURS or near is None else [f"{folder}/" for folder in parents(near)] + [""]
    for folder in folders:
        if found := sorted(path for path in root.glob(folder + pattern.rstrip("/"))):
            return found
    if "/" not in pattern:
        return [path for folder in OURS for path in sorted((root / folder).rglob(pattern))]
    return []


def parents(path):
    """The folder of a path, and those around it: the nearest first."""
    folders = path.rstrip("/").split("/")[:-1] if not path.endswith("/") else path.rstrip("/").split("/")
    return ["/".join(folders[:count]) for count in range(len(folders), 0, -1)]


def text_of(paths):
    """What stands in files, their headers and sources, and in all files of folders."""
    all_files = set()
    for path in paths:
        if path.is_dir():
            all_files |= {file for file in path.rglob("*") if file.suffix in CPP | {".py"}}
        else:
            all_files |= {path, *(path.with_suffix(suffix) for suffix in CPP if path.with_suffix(suffix).exists())}
    return "\n".join(file.read_text(errors="replace") for file in sorted(all_files))


USES = {"and", "case", "co_return", "co_yield", "delete", "else", "goto", "in", "new", "not", "or", "return", "throw"}


def is_made_in(name, paths):
    """Whether files define or declare a name, and not only use it: a type or a keyword stands before it, or its class."""
    text = re.sub(r"//[^\n]*|/\*.*?\*/", "", text_of(paths), flags=re.S)
    *scopes, last = name.split("::")
    last = re.escape(last.removesuffix("...")) + (r"\w*" if last.endswith("...") else r"\b")
    scope = rf"(?:{scopes[-1]}::)?" if scopes else r"(?:\w+::)*"
    made = re.finditer(rf"(?P<before>[\w>&*\]]+)(?:[\s*&]+|\s*\(\*){scope}{last}|^{last} =", text, re.M)
    return any(found["before"] not in USES for found in made) and all(re.search(rf"\b{part}\b", text) for part in scopes)


def paths_in(words):
    return [word for word in quoted(words) if IS_PATH.fullmatch(word) and not word.startswith("/")]


def names_in(words):
    return [word for word in quoted(words) if NAME.fullmatch(word) and not IS_PATH.fullmatch(word)]


def found_by(root, cell):
    """For each group of paths in a cell, divided by semicolons: what is there of it."""
    near, groups = None, []
    for group in cell.split(";"):
        groups.append([])
        for words in paths_in(group):
            groups[-1] += files_of(root, words, near)
            near = words if "/" in words else near
    return groups


def faults_of_paths(root, text):
    """Paths in the document of which there is nothing. Headers of others are not ours to find."""
    of_others = {number for number, row in table(text, "header", "who may include it")}
    for number, line in enumerate(text.splitlines(), 1):
        near = None
        if number in of_others:
            continue
        for words in paths_in(line):
            if not files_of(root, words, near):
                yield f"{DOCUMENT}:{number}: there is no {words}"
            near = words if "/" in words else near


def faults_of_whereabouts(root, text):
    """Names that are not in the file that the document names with them: in the table of where to look, and as
    `file` `Name`, `Name` in `file`, `Name` (`file`), (`Name`, `file`) elsewhere."""
    for number, row in table(text, "what", "file", "name"):
        groups, names = found_by(root, row["file"]), row["name"].split(";")
        if len(groups) != len(names):
            groups, names = [sum(groups, [])], [row["name"]]
        for paths, words in zip(groups, names):
            for name in names_in(words):
                if not is_made_in(name, paths):
                    yield f"{DOCUMENT}:{number}: {name} is not in {row['file']}"
    path, name = r"`(?P<path>[\w/<>-]+\.(?:cc|h|py))`", r"`(?P<name>\w+(?:::\w+)*)`"
    for pair in (f"{path} {name}", f"{name} in {path}", f"{name} \\({path}\\)", f"\\({name}, {path}\\)"):
        for found in re.finditer(pair.replace(" ", r"\s+"), text):
            if not is_made_in(found["name"], files_of(root, found["path"])):
                yield f"{DOCUMENT}:{text.count(chr(10), 0, found.start()) + 1}: {found['name']} is not in {found['path']}"


# --- this tree ------------------------------------------------------------------------------------------


class HouseTest(unittest.TestCase):
    maxDiff = None

    def check(self, faults, expected=()):
        self.assertEqual("\n".join(faults), "\n".join(expected))


class ThisTree(HouseTest):
    def setUp(self):
        self.house = House((ROOT / DOCUMENT).read_text())

    def test_rooms_use_what_the_table_says(self):
        self.check(faults_of_rooms(ROOT, self.house))

    def test_headers_of_others_stay_where_they_belong(self):
        self.check(faults_of_headers(ROOT, self.house))

    def test_maths_never_reaches_the_wire_nor_the_wire_maths(self):
        self.check(faults_of_bans(self.house))

    def test_each_room_is_a_library(self):
        self.check(faults_of_libraries((ROOT / "CMakeLists.txt").read_text(), self.house))

    def test_laws_and_models_are_named_in_their_own_places_only(self):
        self.assertGreater(len(files_of_laws(ROOT)), 1)
        self.assertGreater(len(names_in_rows(ROOT, "experiment/model_traits.cc")), 1)
        self.check(faults_of_names(ROOT))

    def test_clang_tidy_reads_the_headers_of_all_rooms(self):
        headers = re.search(r"^HeaderFilterRegex: '(.*)'$", (ROOT / ".clang-tidy").read_text(), re.M)[1]
        folders = {path.split("/")[0] for path in sources(ROOT, [*FOLDERS, "bench", "tests"], {".h"})}
        self.assertEqual({folder for folder in folders if not re.search(headers, f"/{folder}/a/b.h")}, set())

    def test_a_piece_of_a_law_stays_in_its_folder(self):
        self.check(faults_of_pieces(ROOT))

    def test_the_operating_system_is_asked_in_one_place(self):
        for _, places, _ in ONE_PLACE:
            for place in places:
                self.assertTrue((ROOT / place).exists(), place)
        self.check(faults_of_calls(ROOT))

    def test_what_the_document_names_is_where_it_says(self):
        text = (ROOT / DOCUMENT).read_text()
        self.check([*faults_of_paths(ROOT, text), *faults_of_whereabouts(ROOT, text)])

    def test_the_ros_package_lists_each_of_its_messages(self):
        package = ROOT / "idl/mascot_msgs"
        listed = re.findall(r"^  (msg/\w+\.msg)$", (package / "CMakeLists.txt").read_text(), re.M)
        self.assertEqual(listed, sorted(path.relative_to(package).as_posix() for path in package.rglob("*.msg")))

    def test_json_from_outside_is_read_in_one_place(self):
        self.assertTrue((ROOT / JSON_READER).exists())
        self.check(faults_of_json(ROOT))


# Functions of libm that give the same bits on every processor: exact, or rounded as IEEE 754 says, or made of such.
SAME_EVERYWHERE = {"cabs", "ceil", "csqrt", "fabs", "floor", "fmod", "frexp", "ldexp", "llround", "lround", "modf", "nextafter",
                   "remainder", "rint", "round", "scalbn", "sqrt", "trunc"}
# Complex functions, for theory alone: their last bit may depend on the processor.
OF_THEORY = {"carg", "cexp"}


def names_of_libm(*options):
    """Names of functions in the output of nm, without versions: "sin@GLIBC_2.2.5" is "sin". Not those of variables."""
    words = (line.split() for line in output_of("nm", "-D", *options).splitlines())
    return {word[-1].split("@")[0] for word in words if len(word) > 1 and word[-2] not in "BDRV"}


def taken_from_libm(path, libm):
    return names_of_libm("--undefined-only", path) & libm


@unittest.skipUnless("MASCOT_BINARY_DIR" in os.environ, "MASCOT_BINARY_DIR does not say where the programs are")
class Programs(HouseTest):
    def setUp(self):
        self.folder = pathlib.Path(os.environ["MASCOT_BINARY_DIR"])
        self.libraries = [self.folder / f"libmascot_{room}.a" for room in ["laws", "python", "agent"]]

    def test_the_physics_server_links_neither_laws_nor_python(self):
        self.check(faults_of_linking(self.folder / "physics_server", self.libraries))

    def test_programs_run_without_avx(self):
        objects = sorted(self.folder.glob("CMakeFiles/mascot_*.dir/**/*.cc.o"))
        self.assertTrue(any(shared_functions(path) for path in objects))
        for_avx = [path for path in objects if path.name.endswith("_avx.cc.o")]
        self.assertTrue(for_avx)
        self.assertEqual([(path.name, shared_functions(path)) for path in for_avx if shared_functions(path)], [])

    def test_programs_take_no_function_from_libm_whose_bits_depend_on_the_processor(self):
        libm = names_of_libm("--defined-only", re.search(r"libm\.so\.6 => (\S+)", output_of("ldd", self.folder / "agent"))[1])
        self.assertIn("sin", libm)
        for program in ["agent", "physics_server", "orchestrator"]:
            allowed = SAME_EVERYWHERE | (OF_THEORY if program == "orchestrator" else set())
            self.assertEqual(taken_from_libm(self.folder / program, libm) - allowed, set(), program)

    def test_programs_give_bullet_what_it_would_take_from_libm(self):
        program = self.folder / "physics_server"
        libraries = re.findall(r"=> (\S*(?:Bullet|LinearMath)\S*)", output_of("ldd", program))
        self.assertGreaterEqual(len(libraries), 3)
        libm = names_of_libm("--defined-only", re.search(r"libm\.so\.6 => (\S+)", output_of("ldd", program))[1])
        given = names_of_libm("--defined-only", program)
        for library in libraries:
            self.assertEqual(taken_from_libm(library, libm) - SAME_EVERYWHERE - given, set(), library)

    def test_what_links_them_is_found_out(self):
        linked, laws, python, agent = faults_of_linking(self.folder / "agent", self.libraries)
        self.assertEqual(linked, "agent links Python")
        self.assertRegex(laws, r"^agent holds \d+ functions of libmascot_laws\.a, such as (mascot::|_)")
        self.assertRegex(python, r"^agent holds \d+ functions of libmascot_python\.a, such as mascot::")
        self.assertRegex(agent, r"^agent holds \d+ functions of libmascot_agent\.a, such as mascot::")


# --- planted trees: every rule seen broken --------------------------------------------------------------

DOCUMENT_OF_PLANTED = """
| floor | room | files | library | may use | what |
|---|---|---|---|---|---|
| 0 | `base` | `experiment/` | `mascot_base` | | a |
| 1 | `wire` | `bus/` | `mascot_wire` | `base` | b |
| 1 | `law` | `agent/laws/`, `agent/laws/chase/` | `mascot_law` | `base` | c |
| 2 | `agent` | `agent/` | `mascot_agent` | `base`, `law` | d |
| 3 | `process` | `agent/main.cc` | `program` | `agent`, `wire` | e |

| header | who may include it |
|---|---|
| `Eigen/*` | every room |
| `fastdds/*` | `wire` |
| `zlib.h` | `experiment/a.cc` |

| rooms | never reach |
|---|---|
| `law`, `agent` | `wire` |
"""
FILES = {
    "experiment/a.h": "#pragma once\n#include <vector>\n",
    "experiment/a.cc": '#include "experiment/a.h"\n#include <zlib.h>\n#include <Eigen/Core>\n',
    "bus/bus.h": '#include <fastdds/x.hpp>\n#include "experiment/a.h"\n',
    "agent/laws/law.h": '#include "experiment/a.h"\n',
    "agent/laws/laws.cc": 'Row Chase, Flee;  // "chase"\n',
    "agent/laws/chase/chase.cc": '#include "agent/laws/law.h"\nreturn {.name = "chase"};\n',
    "agent/laws/flee/flee.cc": 'return {.name = "flee"};\n',
    "agent/agent.h": '#include "agent/laws/law.h"\n#include "experiment/a.h"\n//   #include "bus/bus.h"\n',
    "agent/main.cc": '#include "agent/agent.h"\n#include "bus/bus.h"\nint n = 1\'000; char c = \'"\';\n',
    "agent/controllers.cc": '{"ball", MakeBall}\n',
    "experiment/model_traits.cc": '{.name = "ball"}, {.name = "cart"}\n',
    "physics_server/models.cc": '{"ball", MakeBall}\n',
    "physics_server/models/cart.cc": 'auto name = "cart";\n',
    "scripts/plot.py": 'chase = summary["chase"], summary.get("flee", {})  # "ball"\n',
}


class Planted(HouseTest):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.root = pathlib.Path(scratch.name)

    def plant(self, files=None, replace=("", ""), without=()):
        """A tree with these files besides or instead of the sound ones, and what its document says."""
        rooms = {path: text for path, text in FILES.items() if not path.startswith("physics_server")}
        for path, text in (rooms | (files or {})).items():
            if path not in without:
                (self.root / path).parent.mkdir(parents=True, exist_ok=True)
                (self.root / path).write_text(text)
        self.assertIn(replace[0], DOCUMENT_OF_PLANTED)
        return House(DOCUMENT_OF_PLANTED.replace(*replace) if replace[0] else DOCUMENT_OF_PLANTED)


class Rooms(Planted):
    def broken(self, *faults, **how):
        house = self.plant(**how)
        self.check(faults_of_rooms(self.root, house), faults)

    def test_a_sound_tree_has_no_faults(self):
        self.broken()

    def test_an_include_of_a_room_that_may_not_be_used(self):
        self.broken("agent/laws/chase/chase.cc:2: includes bus/bus.h: law may not use wire (docs/architecture.md)",
                    files={"agent/laws/chase/chase.cc": '#include "agent/laws/law.h"\n  #  include "bus/bus.h"\n'})

    def test_an_include_that_runs_up(self):
        self.broken("experiment/b.h:1: includes bus/bus.h: base may not use wire (docs/architecture.md)",
                    files={"experiment/b.h": "#include <bus/bus.h>\n"})

    def test_an_arrow_that_is_not_to_a_lower_floor(self):
        self.broken("docs/architecture.md:4: base may use wire, which is not on a lower floor",
                    files={"experiment/b.h": '#include "bus/bus.h"\n'},
                    replace=("`mascot_base` | |", "`mascot_base` | `wire` |"))

    def test_an_arrow_to_no_room(self):
        self.broken("docs/architecture.md:5: wire may use cellar: there is no such room",
                    replace=("`mascot_wire` | `base`", "`mascot_wire` | `base`, `cellar`"))

    def test_an_arrow_that_no_include_rides_on(self):
        self.broken("docs/architecture.md:8: process may use base, but no include does",
                    replace=("`program` | `agent`", "`program` | `base`, `agent`"))

    def test_a_file_in_no_room(self):
        self.broken("orchestrator/main.cc:1: is in no room (docs/architecture.md)", files={"orchestrator/main.cc": ""})

    def test_a_file_in_two_rooms(self):
        self.broken("agent/laws/chase/chase.cc:1: is in two rooms: agent, law (docs/architecture.md)",
                    replace=("| `agent/` |", "| `agent/`, `agent/laws/chase/` |"))

    def test_a_room_without_files(self):
        self.broken("docs/architecture.md:9: attic: there is no file physics_server/",
                    "docs/architecture.md:9: attic: no file is in this room",
                    replace=("| e |\n", "| e |\n| 4 | `attic` | `physics_server/` | `x` | | f |\n"))

    def test_a_pattern_without_files(self):
        self.broken("docs/architecture.md:5: wire: there is no file bus/wire.*",
                    replace=("`bus/`", "`bus/`, `bus/wire.*`"))

    def test_a_document_without_the_table(self):
        with self.assertRaisesRegex(ValueError, "expected a table with the columns header, who may .*, got none"):
            self.plant(replace=("| header |", "| head |"))


class Headers(Planted):
    def broken(self, *faults, **how):
        house = self.plant(**how)
        self.check(faults_of_headers(self.root, house), faults)

    def test_a_sound_tree_has_no_faults(self):
        self.broken()

    def test_a_header_in_a_room_where_it_does_not_belong(self):
        self.broken("agent/laws/law.h:2: includes fastdds/x.hpp: only wire may (docs/architecture.md:13)",
                    files={"agent/laws/law.h": '#include "experiment/a.h"\n#include <fastdds/x.hpp>\n'})

    def test_a_header_in_another_file_than_the_one_that_may(self):
        self.broken("experiment/b.cc:1: includes zlib.h: only experiment/a.cc may (docs/architecture.md:14)",
                    files={"experiment/b.cc": "#include <zlib.h>\n"})

    def test_a_header_that_nobody_has_heard_of(self):
        self.broken("agent/laws/law.h:1: includes boost/any.hpp: it is not ours, and in no row of the table of headers "
                    "(docs/architecture.md)", files={"agent/laws/law.h": "#include <boost/any.hpp>\n"})

    def test_a_permission_that_nobody_uses(self):
        self.broken("docs/architecture.md:13: law may include fastdds/*, but does not",
                    replace=("| `wire` |\n| `zlib", "| `wire`, `law` |\n| `zlib"))


class BansAndLibraries(Planted):
    CMAKE = ("mascot_room(base experiment\n  SOURCES a.cc)\nmascot_room(wire bus)\nmascot_room(law agent)\n"
             "mascot_room(agent agent)\nadd_executable(program agent/main.cc)\n")

    def test_a_sound_tree_has_no_faults(self):
        self.check(faults_of_bans(self.plant()))
        self.check(faults_of_libraries(self.CMAKE, self.plant()))

    def test_a_way_that_may_not_be_even_through_others(self):
        self.check(faults_of_bans(self.plant(replace=("`mascot_law` | `base`", "`mascot_law` | `base`, `wire`"))),
                   ["docs/architecture.md:18: law must never reach wire, and does: law -> wire",
                    "docs/architecture.md:18: agent must never reach wire, and does: agent -> law -> wire"])

    def test_a_ban_on_no_room(self):
        self.check(faults_of_bans(self.plant(replace=("| `law`, `agent` | `wire`", "| `lore`, `agent` | `wire`"))),
                   ["docs/architecture.md:18: lore: there is no such room"])

    def test_a_library_that_is_not_made(self):
        self.check(faults_of_libraries(self.CMAKE, self.plant(replace=("`mascot_wire`", "`mascot_bus`"))),
                   ["docs/architecture.md:5: wire: CMakeLists.txt makes no mascot_bus",
                    "CMakeLists.txt: mascot_wire is in no row of docs/architecture.md"])


class Names(Planted):
    def broken(self, files, *faults):
        self.plant(FILES | files)
        self.check(faults_of_names(self.root), faults)

    def test_a_sound_tree_has_no_faults(self):
        self.broken({})

    def test_a_law_named_by_the_agent(self):
        self.broken({"agent/agent.cc": '// "flee"\nint n = 1\'000;\nif (law.name == "chase") n = 2;  /* "flee" */\n'},
                    'agent/agent.cc:3: "chase": ask the row of the law or model, in agent/laws/chase/chase.cc')

    def test_a_law_named_by_another_law(self):
        self.broken({"agent/laws/flee/flee.cc": 'return {.name = "flee"};\nauto other = R"(chase)";\n'},
                    'agent/laws/flee/flee.cc:2: "chase": ask the row of the law or model, in agent/laws/chase/chase.cc')

    def test_a_model_named_as_a_toml_value(self):
        self.broken({"experiment/agents.cc": 'auto fallback = "\\"ball\\"";\n'},
                    'experiment/agents.cc:1: "ball": ask the row of the law or model, in experiment/model_traits.cc')

    def test_a_model_named_by_another_model(self):
        self.broken({"physics_server/models/cart.cc": 'auto own = "cart";\nauto other = "ball";\n'},
                    'physics_server/models/cart.cc:2: "ball": ask the row of the law or model, '
                    'in experiment/model_traits.cc')

    def test_a_key_of_json_is_no_name(self):
        self.broken({"orchestrator/summary.cc": 'json["chase"] = 1;\nin(json)["flee"] = 2;\n'})

    def test_a_list_of_names_is_no_key(self):
        self.broken({"orchestrator/a.cc": 'auto f = ["chase"] {};\n',
                     "scripts/plot.py": 'if law in ["chase"]:\n    x = {"flee": 1}\n'},
                    'orchestrator/a.cc:1: "chase": ask the row of the law or model, in agent/laws/chase/chase.cc',
                    'scripts/plot.py:1: "chase": ask the row of the law or model, in agent/laws/chase/chase.cc',
                    'scripts/plot.py:2: "flee": ask the row of the law or model, in agent/laws/flee/flee.cc')

    def test_a_law_named_by_a_script(self):
        self.broken({"scripts/plot.py": 'if law == "chase":  # "flee"\n    pass\n'},
                    'scripts/plot.py:1: "chase": ask the row of the law or model, in agent/laws/chase/chase.cc')


class Pieces(Planted):
    SOUND = {"agent/laws/chase/path.h": "", "agent/laws/chase/path.cc": '#include "agent/laws/chase/path.h"\n',
             "agent/laws/parts/near.h": "", "agent/laws/parts/far.h": '#include "agent/laws/parts/near.h"\n',
             "agent/laws/chase/chase.cc": '#include "agent/laws/chase/path.h"\n#include "agent/laws/parts/far.h"\n',
             "agent/laws/flee/flee.cc": '#include "agent/laws/parts/far.h"\n',
             "agent/laws/plugin/plugin.h": "", "agent/user.cc": '#include "agent/laws/plugin/plugin.h"\n'}

    def broken(self, files, *faults):
        self.plant(FILES | self.SOUND | files)
        self.check(faults_of_pieces(self.root), faults)

    def test_a_sound_tree_has_no_faults(self):
        self.broken({})

    def test_a_piece_that_another_law_uses(self):
        self.broken({"agent/laws/flee/turn.cc": '\n#include "agent/laws/chase/path.h"\n'},
                    "agent/laws/flee/turn.cc:2: includes agent/laws/chase/path.h, a piece of another law: what laws share "
                    "is in agent/laws/parts/")

    def test_a_piece_that_is_used_from_outside(self):
        self.broken({"orchestrator/a.cc": '#include "agent/laws/chase/path.h"\n'},
                    "orchestrator/a.cc:1: includes agent/laws/chase/path.h, a piece of another law: what laws share is in "
                    "agent/laws/parts/")

    def test_a_piece_that_is_shared_with_nobody(self):
        self.broken({"agent/laws/flee/flee.cc": ""}, "agent/laws/parts/far.h:1: only agent/laws/chase/ uses it: it belongs there")


class Whereabouts(Planted):
    TABLE = "| header | who may include it |\n|---|---|\n| `zlib.h` | `law` |\n\n| what | file | name |\n|---|---|---|\n"

    def broken(self, text, *faults):
        self.plant({"agent/laws/chase.h": "class Chase {};\nvoid Flee();\n", "agent/laws/chase.cc": "// none\n",
                    "agent/agent.cc": "void Agent::Want() {\n  Go(Flee());  // class Chase\n  return Flee();\n}\n", "tests/agent/want_test.cc": "bool Wanted();\n"})
        self.check([*faults_of_paths(self.root, self.TABLE + text), *faults_of_whereabouts(self.root, self.TABLE + text)],
                   [f"{DOCUMENT}:{fault}" for fault in faults])

    def test_a_sound_document_has_no_faults(self):
        self.broken("| a | `agent/laws/<law>.cc`; `agent/agent.cc` | `Chase`, `Fl...`; `Agent::Want` |\n"
                    "| b | `agent/laws/chase.cc`, `chase.h` | `Flee` |\n| c | `agent/` | |\n\n"
                    "`agent/agent.cc` `Agent::Want`, `Flee` in `agent/laws/chase.cc`, `Chase`\n(`agent/laws/chase.h`), "
                    "a test (`Wanted`, `tests/agent/want_test.cc`), held by `want_test.cc`, `run.mcap`, `/agent_1/state`\n")

    def test_a_path_of_nothing(self):
        self.broken("| a | `agent/laws/chase.cc`, `flea.cc` | `Chase` |\n\n`agent/main/` and `tests/flee_test.cc`\n",
                    "7: there is no flea.cc", "9: there is no agent/main/", "9: there is no tests/flee_test.cc")

    def test_a_name_that_stands_elsewhere(self):
        self.broken("| a | `agent/agent.cc`; `agent/laws/chase.cc` | `Chase`; `Flee` |\n\n`agent/agent.cc` `Agent::Flee`, which it uses\n"
                    "`Want` in `agent/laws/chase.cc`, `Chase` (`agent/agent.cc`), (`Wan`,\n`agent/agent.cc`)\n",
                    "7: Chase is not in `agent/agent.cc`; `agent/laws/chase.cc`", "9: Agent::Flee is not in agent/agent.cc",
                    "10: Want is not in agent/laws/chase.cc", "10: Chase is not in agent/agent.cc",
                    "10: Wan is not in agent/agent.cc")


class Calls(Planted):
    def broken(self, files, *faults):
        self.plant(FILES | files)
        self.check(faults_of_calls(self.root), faults)

    def test_a_sound_tree_has_no_faults(self):
        self.broken({"system/spawn.cc": "const pid_t number = fork();\n",
                     "bus/a.cc": "// fork()\nFork(work);\ncalls.fork();\nthrow Error(\"fork() failed\");\nprocess.kill(1);\n"
                                 "std::ifstream file(path);\nskill(3);\nsystem_clock::now();\n"})

    def test_every_call(self):
        lines = ["if (fork() == 0) return;", "posix_spawnp(&pid, path, 0, 0, argv, environ);", 'FILE* p = popen("ls", "r");',
                 "::pipe2(ends, O_CLOEXEC);", "waitpid(pid, &status, 0);", "::kill(pid, SIGKILL);",
                 "prctl(PR_SET_PDEATHSIG, SIGKILL);", "_exit(128 + signal);", "return action.sa_handler == SIG_IGN;", "std::ofstream file(path);"]
        words = [0, 0, 0, 1, 2, 2, 3, 4, 5, 6]
        self.broken({"agent/b.cc": "\n".join(lines) + "\n"},
                    *(f"agent/b.cc:{number}: {ONE_PLACE[row][2]}" for number, row in enumerate(words, 1)))


class JsonOfOthers(Planted):
    def broken(self, files, *lines):
        self.plant(FILES | files)
        self.check(faults_of_json(self.root), [f"{line}: JSON is read by ReadJson(), which has limits ({JSON_READER})"
                                               for line in lines])

    def test_a_sound_tree_has_no_faults(self):
        self.broken({JSON_READER: "return Json::parse(text);\n",
                     "orchestrator/a.cc": "// Json::parse\nauto json = ReadJson<Json>(text);\nJson::parser_callback_t f;\n"})

    def test_every_way_in(self):
        self.broken({"orchestrator/a.cc": "auto a = nlohmann::json::parse(text);\nbool b = Json::accept(text);\n"
                                          "Json::sax_parse(text, &sax);\nauto d = ordered_json::from_cbor(bytes);\n"
                                          "auto e = \"{}\"_json;\nfile >> json;\nauto g = Foxglove::Json::parse(t);\n"},
                    *(f"orchestrator/a.cc:{line}" for line in range(1, 8)))


if __name__ == "__main__":
    unittest.main()

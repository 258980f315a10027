// Modules that a law in Python imports and that stand beside it: their texts travel with the experiment, and each law
// has objects of its own of them.
#include "agent/python/internal.h"

namespace mascot {
namespace {

constexpr const char* kModules = R"(
import ast, builtins, linecache, os, sys, types


def imported(text, package):
    """The dotted names that `text`, a module of `package`, imports, wherever in it that is."""
    try:
        tree = ast.parse(text)
    except (SyntaxError, ValueError):
        return  # running the text will say so
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = absolute(node.module or "", package, node.level)
            yield base
            yield from (f"{base}.{alias.name}" for alias in node.names)


def absolute(name, package, level):
    """The absolute name of module `name`, imported in `package` with `level` leading dots."""
    if level == 0:
        return name
    base = package.rsplit(".", level - 1)[0]
    return f"{base}.{name}".strip(".")


def paths(name):
    """Where module `name` may be, from the folder of the law: a package or a file."""
    stem = name.replace(".", "/")
    return f"{stem}/__init__.py", f"{stem}.py"


def package_of(name, path):
    return name if path.endswith("/__init__.py") else name.rpartition(".")[0]


def prefixes(name):
    parts = name.split(".")
    return [".".join(parts[: n + 1]) for n in range(len(parts))]


def beside(text, folder):
    """The texts of the modules in `folder` that `text` imports, itself or through each other, by their paths there."""
    texts = {}

    def visit(text, package):
        for name in imported(text, package):
            for prefix in prefixes(name):
                found = [path for path in paths(prefix) if os.path.isfile(os.path.join(folder, path))]
                if not found or prefix in sys.builtin_module_names:
                    break
                if found[0] not in texts:
                    with open(os.path.join(folder, found[0]), encoding="utf-8-sig") as file:
                        texts[found[0]] = file.read()
                    visit(texts[found[0]], package_of(prefix, found[0]))

    visit(text, "")
    return texts


class Importer:
    """What __import__ is for one law: finds the modules beside it first, then those of Python."""

    def __init__(self, texts, data):
        self.texts = texts
        self.data = data
        self.modules = {}
        self.builtins = dict(vars(builtins), __import__=self)

    def __call__(self, name, globals=None, locals=None, fromlist=(), level=0):
        full = absolute(name, (globals or {}).get("__package__") or "", level)
        if not self.path(full.partition(".")[0]):
            return builtins.__import__(name, globals, locals, fromlist, level)
        loaded = [self.load(prefix) for prefix in prefixes(full)]
        for attribute in fromlist or ():
            if not hasattr(loaded[-1], attribute) and self.path(f"{full}.{attribute}"):
                self.load(f"{full}.{attribute}")
        return loaded[-1] if fromlist else loaded[0]

    def path(self, name):
        return next((path for path in paths(name) if path in self.texts), None)

    def load(self, name):
        if name in self.modules:
            return self.modules[name]
        path = self.path(name)
        if path is None:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)
        text = self.texts[path]
        module = self.modules[name] = types.ModuleType(name)
        module.__dict__.update(
            __file__=path, __package__=package_of(name, path), __builtins__=self.builtins, DATA=self.data
        )
        linecache.cache[path] = len(text), None, text.splitlines(True), path
        try:
            exec(compile(text, path, "exec"), module.__dict__)
        except BaseException:
            del self.modules[name]
            raise
        above, _, own = name.rpartition(".")
        if above:
            setattr(self.modules[above], own, module)
        return module
)";

/// The functions of kModules; needs the GIL.
py::dict Functions() {
  py::dict space;
  py::exec(kModules, space);
  return space;
}

}  // namespace

PythonModules ModulesBeside(const std::string& text, const std::string& folder) {
  const PythonLock lock;
  try {
    return Functions()["beside"](text, folder).cast<PythonModules>();
  } catch (py::error_already_set& error) {
    throw Explain(error, "");
  }
}

py::object BuiltinsOf(const PythonModules& modules, const py::object& data) {
  if (modules.empty()) return py::module_::import("builtins");
  return Functions()["Importer"](modules, data).attr("builtins");
}

}  // namespace mascot

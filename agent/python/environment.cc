// The virtual environment that a user has activated, whose packages Python code may import.
#include "agent/python/environment.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "agent/python/internal.h"
#include "base/utf8.h"

namespace mascot {
namespace {

namespace fs = std::filesystem;

const std::string kVersion = std::to_string(PY_MAJOR_VERSION) + "." + std::to_string(PY_MINOR_VERSION);

std::string Trimmed(const std::string& text) {
  const auto begin = text.find_first_not_of(" \t\r");
  return begin == std::string::npos ? "" : text.substr(begin, text.find_last_not_of(" \t\r") + 1 - begin);
}

/// "3.11" of "3.11.2.final.0".
std::string MinorVersion(const std::string& version) {
  const auto first = version.find('.');
  return first == std::string::npos ? version : version.substr(0, version.find('.', first + 1));
}

/// The Python of an environment, "3.11", as its pyvenv.cfg says; empty: it does not.
std::string VersionOf(const fs::path& folder) {
  std::ifstream config(folder / "pyvenv.cfg");  // a line: "version = 3.11.2", or "version_info = 3.11.2.final.0"
  for (std::string line; std::getline(config, line);) {
    const auto equals = line.find('=');
    const std::string key = Trimmed(line.substr(0, equals));
    if (equals != std::string::npos && (key == "version" || key == "version_info"))
      return MinorVersion(Trimmed(line.substr(equals + 1)));
  }
  return "";
}

}  // namespace

VirtualEnvironment FindVirtualEnvironment() {
  const char* given = std::getenv("VIRTUAL_ENV");  // NOLINT(concurrency-mt-unsafe): nothing sets variables
  VirtualEnvironment environment{.folder = given == nullptr ? "" : given, .packages = {}, .why_not = {}};
  if (environment.folder.empty()) return environment;
  std::error_code error;
  const fs::path folder = fs::absolute(environment.folder, error);
  const fs::path packages = folder / "lib" / ("python" + kVersion) / "site-packages";
  const std::string version = VersionOf(folder);
  if (!fs::exists(folder / "pyvenv.cfg", error))
    environment.why_not = "has no pyvenv.cfg, and is no virtual environment";
  else if (!version.empty() && version != kVersion)
    environment.why_not = "is of Python " + Plain(version) + ", but code of users runs in Python " + kVersion +
                          ": `/usr/bin/python3 -m venv` makes one of that";
  else if (!fs::is_directory(packages, error))
    environment.why_not = "has no lib/python" + kVersion + "/site-packages, for the Python in which code of users runs";
  else
    environment.packages = packages.string();
  return environment;
}

// The packages come before Debian's, as in the environment itself, but behind Python's own modules. NumPy stays the one
// for which this program was compiled, and whose bits it knows: it is loaded before. Files *.pth count: packages that
// are installed to be edited are found by them.
void UseVirtualEnvironment() {
  const VirtualEnvironment environment = FindVirtualEnvironment();
  if (environment.packages.empty()) return;
  py::dict space;
  space["folder"] = py::module_::import("os").attr("fsdecode")(py::bytes(environment.packages));
  py::exec(R"python(
import site, sys

try:
    import numpy
except ImportError:  # what needs it will say so
    pass
before = list(sys.path)
site.addsitedir(folder)
added = [path for path in sys.path if path not in before]
place = next((k for k, path in enumerate(before) if path.endswith("-packages")), len(before))
sys.path[:] = before[:place] + added + before[place:]
)python",
           space);
}

PythonNote NoteOf(const VirtualEnvironment& environment) {
  if (environment.folder.empty()) return {};
  if (environment.packages.empty())
    return {
        .used = "",
        .warning = "VIRTUAL_ENV: its packages are not used: " + Plain(environment.folder) + " " + environment.why_not};
  std::error_code error;
  const bool has_numpy = fs::exists(fs::path(environment.packages) / "numpy", error);
  return {.used = "packages of the virtual environment " + Plain(environment.folder) + " (Python " + kVersion + ")" +
                  (has_numpy ? ", but the system's NumPy" : ""),
          .warning = ""};
}

PythonNote NoteOfPython() { return PythonHasStarted() ? NoteOf(FindVirtualEnvironment()) : PythonNote(); }

}  // namespace mascot

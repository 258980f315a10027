#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "system/stop_signal.h"

namespace mascot {

/// Path of the file or folder `name`: installed with this program in ../share/mascot, or else in `folder` of the source
/// tree that the program was built from. Throws std::runtime_error if it is in neither.
std::filesystem::path FindShared(const std::string& name, const std::string& folder);

/// A path as a word of a command line that no program takes for an option: "./-x" for "-x".
std::string AsWord(const std::filesystem::path& path);

/// Runs a program, found by PATH, on our terminal. Returns its exit code, or 128 + the signal that ended it. A signal
/// that `stop` receives meanwhile ends the program (SIGTERM); then 128 + that signal is returned. Throws
/// std::runtime_error if the program cannot be started, or if it cannot be told how it ended.
int RunProgram(const std::vector<std::string>& words, StopSignal& stop);

/// The words that run the Python script `script` of scripts/ (installed or in the source tree), by the system's Python.
/// Throws std::runtime_error if the script is missing.
std::vector<std::string> ScriptWords(const std::string& script);

/// Runs the Python script `script` of scripts/ (installed or in the source tree) with `arguments`. Returns its exit
/// code as RunProgram() does. Throws std::runtime_error if the script is missing or cannot be started.
int RunScript(const std::string& script, const std::vector<std::string>& arguments, StopSignal& stop);

}  // namespace mascot

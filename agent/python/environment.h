#pragma once

#include <string>

namespace mascot {

/// The virtual environment that the variable VIRTUAL_ENV names, as an activated one does.
struct VirtualEnvironment {
  std::string folder;    ///< empty: the variable is not set, or empty
  std::string packages;  ///< the folder of its packages; empty: our Python does not use them
  std::string why_not;   ///< why it does not, for a warning
};
VirtualEnvironment FindVirtualEnvironment();

/// What is to be told of the packages that Python code finds; one text at most, none if there is nothing to tell.
struct PythonNote {
  std::string used, warning;
};
PythonNote NoteOf(const VirtualEnvironment& environment);
/// As NoteOf(), of the environment of this process; nothing if Python has not been started in it.
PythonNote NoteOfPython();

}  // namespace mascot

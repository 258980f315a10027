#pragma once

// Where the sources and the programs under test are.

#include <string>

namespace mascot::test {

// Functions, not macros: the command lines of tests contain no path, and ccache finds what another clone has compiled.

/// The folder of the sources, without a slash at its end.
const std::string& SourceFolder();
/// The folder that was built into.
const std::string& BuildFolder();

}  // namespace mascot::test

#pragma once

#include <string>

namespace mascot {

/// A program on a host of a run.
struct ProgramBuild {
  std::string text;       ///< BuildText()
  std::string sources;    ///< SourcesText(); empty: unknown
  std::string processor;  ///< ProcessorText(); empty: unknown
};

/// The SHA-256 of all sources from which this program was compiled, in hexadecimal digits. It is the same on all
/// processors.
std::string SourcesText();
/// The kind of processor that this program is for, as `uname -m` has it: "x86_64", "aarch64". Any other: "other".
std::string ProcessorText();

/// Why agents of the program `theirs` may not fly in a run whose physics server and recorder are of the program `ours`,
/// as the rest of a sentence that begins with "host lab1"; empty: they may. One run has one program, or programs of the
/// same sources for processors that are known to decide with the same bits.
std::string WhyNotTogether(const ProgramBuild& ours, const ProgramBuild& theirs);

}  // namespace mascot

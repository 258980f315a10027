#pragma once

#include <string_view>

namespace mascot {

/// Opens /dev/null for each of stdin, stdout and stderr that is closed. Otherwise the next file that the program opens
/// would get that descriptor, and prints would go into it. Call it first in main.
void OpenStandardStreams();

/// From now on, all text that is printed to std::cout and std::cerr is safe for a terminal and a log (Plain(),
/// base/utf8.h), wherever it comes from: names, reasons and paths come from files and from other processes.
/// JSON that is printed stays the same JSON.
void FitStandardStreams();

/// Whether stdin is a terminal, at which somebody may answer.
bool IsInputATerminal();

/// Prints to std::cerr without the change of FitStandardStreams(): colours, cursor movements and text that is safe
/// already.
void PrintToTerminal(std::string_view bytes);

/// Writes out what was printed to std::cout. Throws std::runtime_error if some of it could not be written. This part is
/// then given up: a second call does not throw again. A pipe whose reader has gone (`| head`) is not a failure: the
/// reader has seen enough.
void FlushStandardOutput();

}  // namespace mascot

#pragma once

#include <string_view>

namespace mascot {

/// Opens /dev/null for each of stdin, stdout and stderr that is closed. Otherwise the next file that the program opens
/// would get that descriptor, and prints would go into it. To be called first in main.
void OpenStandardStreams();

/// From now on all that is printed to std::cout and std::cerr is fit for a terminal and a log (Plain(),
/// base/utf8.h), whoever wrote the words: names, reasons and paths come from files and from other processes.
/// JSON that is printed stays the same JSON.
void FitStandardStreams();

/// Prints to std::cerr past FitStandardStreams(): colours, cursor movements and text that is fit already.
void PrintToTerminal(std::string_view bytes);

/// Writes out what was printed to std::cout. Throws std::runtime_error if any of it could not be written, which is then
/// given up: a second call does not throw again. A pipe whose reader has gone (`| head`) is no failure: whoever read
/// has seen enough.
void FlushStandardOutput();

}  // namespace mascot

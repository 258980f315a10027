#pragma once

namespace mascot {

/// Opens /dev/null for each of stdin, stdout and stderr that is closed. Otherwise the next file that the program opens
/// would get that descriptor, and prints would go into it. To be called first in main.
void OpenStandardStreams();

/// Writes out what was printed to std::cout. Throws std::runtime_error if any of it could not be written, which is then
/// given up: a second call does not throw again. A pipe whose reader has gone (`| head`) is no failure: whoever read
/// has seen enough.
void FlushStandardOutput();

}  // namespace mascot

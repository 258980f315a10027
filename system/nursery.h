#pragma once

#include <string>
#include <vector>

namespace mascot {

// Many copies of one program, made by fork() in a process that does nothing else: the program is loaded and relocated
// once, and copies with the same virtual addresses share what the processor has learnt of their branches. The process
// that makes them has no thread, no secret and no DDS entity. When it has ended, the copies are children of the process
// that started it, which has adopted its descendants (AdoptDescendants).

/// The first argument of a program that is to make copies of itself. The second is blank: the copies write their own
/// command lines there, for ps(1).
inline constexpr const char* kNursery = "--nursery";

/// A copy to be made.
struct Copy {
  std::vector<std::string> words;  ///< its command line: the program and its arguments
  int output = -1;                 ///< descriptor for its standard output and errors
};

/// What the process is told on its standard input. `numbers`: the descriptor to which it writes their process ids, all
/// at once, a line each.
std::string NurseryOrder(const std::vector<Copy>& copies, int numbers);
/// A second argument that is long enough for these copies.
std::string NurseryRoom(const std::vector<Copy>& copies);

/// To be called first in main(). If this process is to make copies, it does, and ends. In each copy it returns the
/// copy's command line, in a process group of its own, once that is a child of the process that started this one. In
/// any other process it returns the command line that the process has.
std::vector<std::string> WordsOrCopies(int argc, char** argv);

}  // namespace mascot

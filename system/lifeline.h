#pragma once

#include <sys/types.h>

#include "system/descriptor.h"

namespace mascot {

/// A pipe by which the kernel kills a child when this process ends, by SIGKILL too, and whatever the child does then.
/// Unlike DieWith(), it does not matter whether the thread that started the child has ended.
class Lifeline {
 public:
  /// Throws std::system_error.
  Lifeline() : pipe_(MakePipe()) {}

  /// The descriptor that the child is to be given (Program::shared), and to keep open.
  int shared() const { return pipe_.reads.number(); }
  /// From now on the child dies with this process, and with this object. To be called once. Throws std::system_error.
  void Tie(pid_t child);

 private:
  Pipe pipe_;
};

}  // namespace mascot

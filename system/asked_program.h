#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "system/child_process.h"
#include "system/descriptor.h"

namespace mascot {

/// Another program that is asked one question: it reads a text on its standard input, and writes its answer to a file
/// that has no name, whose descriptor is its last argument. What it prints is dropped. It is killed with this object.
class AskedProgram {
 public:
  /// Starts it. Throws std::system_error, or what Spawn() throws.
  AskedProgram(std::vector<std::string> words, std::string_view question);

  struct Answer {
    std::string text;
    std::string end;  ///< how the program ended, if it failed: "was killed by signal 11 (Segmentation fault)"
  };
  /// Waits for its end. To be called once.
  Answer Wait();

 private:
  Descriptor answer_;
  ChildProcess process_;
};

}  // namespace mascot

#pragma once

#include <stdexcept>

namespace mascot {

/// What is wrong with an FMU, or went wrong in it, in words that fit behind its name and a colon.
class FmuError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace mascot

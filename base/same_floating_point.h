#pragma once

#include <cfenv>

namespace mascot {

/// While an object of this class lives, its thread computes as our programs do: rounds to nearest, and keeps numbers
/// that are close to 0. In the process of somebody else, a library may have chosen otherwise.
class SameFloatingPoint {
 public:
  SameFloatingPoint() {
    std::fegetenv(&before_);
    std::fesetenv(FE_DFL_ENV);
  }
  ~SameFloatingPoint() { std::fesetenv(&before_); }
  SameFloatingPoint(const SameFloatingPoint&) = delete;
  SameFloatingPoint& operator=(const SameFloatingPoint&) = delete;

 private:
  std::fenv_t before_{};
};

}  // namespace mascot

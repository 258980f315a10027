#pragma once

#include <memory>
#include <string>
#include <vector>

namespace mascot {

/// Watches the random generators that all Python code of a process shares: those of the modules random and
/// numpy.random.
class SharedRandom {
 public:
  SharedRandom();
  ~SharedRandom();
  SharedRandom(const SharedRandom&) = delete;
  SharedRandom& operator=(const SharedRandom&) = delete;

  /// The modules whose generators have drawn a number, or were seeded, since this object was made.
  std::vector<std::string> Used() const;

 private:
  struct States;
  std::unique_ptr<States> states_;
};

}  // namespace mascot

#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace mascot {

/// The numbers of things that are computed several at once, in lanes (base/lanes.h): by block of as many things as
/// there are lanes, then field, then lane.
class LaneNumbers {
 public:
  /// All numbers are 0. There are as many things as fill the blocks.
  LaneNumbers(std::size_t things, int fields, int lanes)
      : fields_(static_cast<std::size_t>(fields)),
        lanes_(static_cast<std::size_t>(lanes)),
        blocks_((things + lanes_ - 1) / lanes_),
        numbers_(blocks_ * fields_ * lanes_) {}

  double& At(std::size_t thing, int field) { return numbers_[Place(thing, field)]; }
  double At(std::size_t thing, int field) const { return numbers_[Place(thing, field)]; }
  std::size_t lanes() const { return lanes_; }
  std::size_t blocks() const { return blocks_; }
  double* Block(std::size_t number) { return numbers_.data() + number * fields_ * lanes_; }

 private:
  std::size_t Place(std::size_t thing, int field) const {
    return (thing / lanes_ * fields_ + static_cast<std::size_t>(field)) * lanes_ + thing % lanes_;
  }

  std::size_t fields_, lanes_, blocks_;
  std::vector<double> numbers_;
};

/// The first kernel that has at most `max_lanes` lanes, or the last one if none has so few. `kernels`: those that this
/// processor can run, the one with most `lanes` first.
template <class Kernel>
Kernel KernelWith(const std::vector<Kernel>& kernels, int max_lanes) {
  const auto kernel = std::ranges::find_if(kernels, [max_lanes](const Kernel& one) { return one.lanes <= max_lanes; });
  return kernel == kernels.end() ? kernels.back() : *kernel;
}

/// The number of lanes of each kernel.
template <class Kernel>
std::vector<int> LanesOf(const std::vector<Kernel>& kernels) {
  std::vector<int> lanes;
  for (const Kernel& kernel : kernels) lanes.push_back(kernel.lanes);
  return lanes;
}

}  // namespace mascot

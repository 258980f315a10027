#include "physics_server/lanes/rotor_bodies.h"

#include <algorithm>
#include <initializer_list>

namespace mascot {
namespace {

/// Those that this processor can run, the one with most lanes first.
std::vector<RotorKernel> Kernels() {
  std::vector<RotorKernel> kernels;
#ifdef MASCOT_AVX
  if (__builtin_cpu_supports("avx")) kernels.push_back(RotorsByAvx());
#endif
  kernels.push_back(RotorsByDefault());
  return kernels;
}

RotorKernel KernelWith(int max_lanes) {
  const std::vector<RotorKernel> kernels = Kernels();
  const auto kernel =
      std::ranges::find_if(kernels, [max_lanes](const RotorKernel& one) { return one.lanes <= max_lanes; });
  return kernel == kernels.end() ? kernels.back() : *kernel;
}

}  // namespace

RotorBodies::RotorBodies(std::size_t bodies, int max_lanes) : bodies_(bodies) {
  const RotorKernel kernel = KernelWith(max_lanes);
  lanes_ = static_cast<std::size_t>(kernel.lanes);
  fly_ = kernel.fly;
  const std::size_t blocks = (bodies + lanes_ - 1) / lanes_;
  numbers_.resize(blocks * RotorField::kCount * lanes_);
  is_flown_.resize(bodies);
  flown_.resize(blocks);
  for (std::size_t i = 0; i < blocks * lanes_; ++i)  // also those that only fill up the last block
    for (const int field :
         std::initializer_list<int>{RotorField::kR, RotorField::kR + 4, RotorField::kR + 8, RotorField::kInertia,
                                    RotorField::kInertia + 1, RotorField::kInertia + 2})
      At(i, field) = 1;
}

void RotorBodies::SetFlown(std::size_t body, bool is_flown) {
  flown_[body / lanes_] += static_cast<int>(is_flown) - static_cast<int>(is_flown_[body] != 0);
  is_flown_[body] = is_flown;
}

void RotorBodies::Fly(const TickOfRotorBodies& tick) {
  for (std::size_t first = 0; first < flown_.size();) {
    std::size_t end = first;
    while (end < flown_.size() && flown_[end] > 0) ++end;
    if (end > first) fly_(numbers_.data() + first * RotorField::kCount * lanes_, end - first, tick);
    first = end + 1;
  }
}

std::vector<int> LanesOfRotors() {
  std::vector<int> lanes;
  for (const RotorKernel& kernel : Kernels()) lanes.push_back(kernel.lanes);
  return lanes;
}

}  // namespace mascot

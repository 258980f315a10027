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
  for (std::size_t i = 0; i < blocks * lanes_; ++i)  // also those that only fill up the last block
    for (const int field :
         std::initializer_list<int>{RotorField::kR, RotorField::kR + 4, RotorField::kR + 8, RotorField::kInertia,
                                    RotorField::kInertia + 1, RotorField::kInertia + 2})
      At(i, field) = 1;
}

void RotorBodies::Fly(const TickOfRotorBodies& tick) {
  fly_(numbers_.data(), numbers_.size() / (RotorField::kCount * lanes_), tick);
}

std::vector<int> LanesOfRotors() {
  std::vector<int> lanes;
  for (const RotorKernel& kernel : Kernels()) lanes.push_back(kernel.lanes);
  return lanes;
}

}  // namespace mascot

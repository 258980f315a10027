#include "physics_server/lanes/rotor_bodies.h"

#include <initializer_list>

namespace mascot {
namespace {

/// The kernels that this processor can run, the one with most lanes first.
std::vector<RotorKernel> Kernels() {
  std::vector<RotorKernel> kernels;
#ifdef MASCOT_AVX
  if (__builtin_cpu_supports("avx")) kernels.push_back(RotorsByAvx());
#endif
  kernels.push_back(RotorsByDefault());
  return kernels;
}

}  // namespace

RotorBodies::RotorBodies(std::size_t bodies, int max_lanes)
    : kernel_(KernelWith(Kernels(), max_lanes)),
      numbers_(bodies, RotorField::kCount, kernel_.lanes),
      is_flown_(bodies),
      flown_(numbers_.blocks()) {
  for (std::size_t i = 0; i < numbers_.blocks() * numbers_.lanes(); ++i)  // also those that only fill up the last block
    for (const int field :
         std::initializer_list<int>{RotorField::kR, RotorField::kR + 4, RotorField::kR + 8, RotorField::kInertia,
                                    RotorField::kInertia + 1, RotorField::kInertia + 2})
      At(i, field) = 1;
}

void RotorBodies::SetFlown(std::size_t body, bool is_flown) {
  flown_[body / numbers_.lanes()] += static_cast<int>(is_flown) - static_cast<int>(is_flown_[body] != 0);
  is_flown_[body] = is_flown;
}

void RotorBodies::Fly(const TickOfRotorBodies& tick, std::size_t first, std::size_t end) {
  while (first < end) {
    std::size_t next = first;
    while (next < end && flown_[next] > 0) ++next;
    if (next > first) kernel_.fly(numbers_.Block(first), next - first, tick);
    first = next + 1;
  }
}

std::vector<int> LanesOfRotors() { return LanesOf(Kernels()); }

}  // namespace mascot

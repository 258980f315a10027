#include "base/sines.h"

#include "base/lanes.h"

namespace mascot {

SinesAndCosines SinesAndCosinesOf(const Eigen::Vector2d& angles_rad) {
  SinesAndCosines of;
  for (std::ptrdiff_t i = 0; i < 2; i += kLanes) {
    const Real angles = Load(angles_rad.data() + i);
    Store(Sin(angles), of.sin.data() + i);
    Store(Cos(angles), of.cos.data() + i);
  }
  return of;
}

}  // namespace mascot

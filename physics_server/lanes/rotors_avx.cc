#include "physics_server/lanes/fly_in_lanes.h"

namespace mascot {

RotorKernel RotorsByAvx() { return {kLanes, FlyBlocks}; }

}  // namespace mascot

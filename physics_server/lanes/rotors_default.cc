#include "physics_server/lanes/fly_in_lanes.h"

namespace mascot {

RotorKernel RotorsByDefault() { return {kLanes, FlyBlocks}; }

}  // namespace mascot

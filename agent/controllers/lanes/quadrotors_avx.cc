#include "agent/controllers/lanes/actuate_in_lanes.h"

namespace mascot {

QuadrotorKernel QuadrotorsByAvx() { return {kLanes, ActuateBlocks}; }

}  // namespace mascot

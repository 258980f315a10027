#include "agent/controllers/lanes/actuate_in_lanes.h"

namespace mascot {

QuadrotorKernel QuadrotorsByDefault() { return {kLanes, ActuateBlocks}; }

}  // namespace mascot

#include "orchestrator/theory/lanes/move_in_lanes.h"

namespace mascot {

LoopKernel LoopsByAvx() { return {kLanes, MoveBlocks}; }

}  // namespace mascot

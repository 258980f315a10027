#include "orchestrator/theory/lanes/move_in_lanes.h"

namespace mascot {

LoopKernel LoopsByDefault() { return {kLanes, MoveBlocks}; }

}  // namespace mascot

#pragma once

#include <cstdint>

namespace mascot {

/// Throws std::runtime_error if this machine does not grant what a run over DDS needs; Fast DDS would end processes by
/// a signal, without a word. `shared_memory`: what its processes need together (bytes). External processes do not
/// count.
void RequireResources(std::uint64_t shared_memory);

}  // namespace mascot

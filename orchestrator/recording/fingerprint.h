#pragma once

#include <map>
#include <string>

#include "experiment/experiment.h"

namespace mascot {

/// Checksums of the files that a run depends on and whose contents its experiment does not hold, such as the library of
/// a law in C++, by path: "crc32 1a2b3c4d of 16384 bytes". Throws std::runtime_error if one cannot be read.
std::map<std::string, std::string> Fingerprints(const Experiment& experiment);

}  // namespace mascot

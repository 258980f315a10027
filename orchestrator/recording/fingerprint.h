#pragma once

#include <map>
#include <string>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/formats/mcap/reader.h"

namespace mascot {

/// Checksums of the files that a run depends on and whose contents its experiment does not hold, such as the library of
/// a law in C++, by path: "crc32 1a2b3c4d of 16384 bytes". Throws std::runtime_error if one cannot be read.
std::map<std::string, std::string> Fingerprints(const Experiment& experiment);

/// What differs between the program and the files with which a recording was made and those of now, a line each;
/// differences of bits may come from it. `again`: what is done with the recording now: "flown again". Throws as
/// Fingerprints() does.
std::vector<std::string> ChangesSince(const McapContents& recording, const Experiment& experiment,
                                      const std::string& again);

}  // namespace mascot

// Reads an experiment from TOML text in a test.
#pragma once

#include <string>

#include "agent/laws/laws.h"

namespace mascot {

inline Experiment Load(const std::string& toml) {
  return LoadExperiment(Section::FromText(toml, "folder/test.toml"), "test");
}

}  // namespace mascot

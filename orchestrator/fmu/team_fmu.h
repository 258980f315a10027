#pragma once

#include <string>
#include <vector>

#include "orchestrator/fmu/model_description.h"
#include "orchestrator/fmu/team_variables.h"

namespace mascot {

/// What is in the FMU of a team beside what is made from it.
struct FmuParts {
  std::string experiment;  ///< the resolved experiment, as TOML
  std::string binary;      ///< team_fmu.c, compiled for this processor
  std::string source;      ///< team_fmu.c
  std::string program;     ///< the path of the orchestrator that flies the team, if none is in PATH
};

/// The bytes of an FMU, a zip archive: the same for the same arguments. Throws std::invalid_argument if the team cannot
/// be said in this version of FMI.
std::string TeamFmu(FmiVersion version, const FmuTeam& team, const FmuParts& parts);

}  // namespace mascot

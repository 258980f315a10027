#pragma once

#include <string>

#include "orchestrator/fmu/team_variables.h"

namespace mascot {

enum class FmiVersion { k2, k3 };

/// modelDescription.xml of a team's FMU. `token`: by which a tool shows that it has read this description.
std::string ModelDescription(FmiVersion version, const FmuTeam& team, const std::string& token);

/// sources/buildDescription.xml of FMI 3: how the source file `source` is compiled.
std::string BuildDescription(const FmuTeam& team, const std::string& source);

}  // namespace mascot

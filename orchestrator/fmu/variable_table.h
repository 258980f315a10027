#pragma once

#include <string>

#include "orchestrator/fmu/team_variables.h"

namespace mascot {

/// The table that team_fmu.c reads, resources/variables.txt of an FMU: a line for each fact, with its name first.
/// `token`: the FMU's. `program`: the path of the orchestrator that the FMU starts, if it is not in PATH.
std::string VariableTable(const FmuTeam& team, const std::string& token, const std::string& program);

}  // namespace mascot

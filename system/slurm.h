#pragma once

#include <string>
#include <vector>

namespace mascot {

/// The nodes of the Slurm allocation that this process is in. Throws ConfigError if it is in none, and
/// std::runtime_error if `scontrol` does not tell them.
std::vector<std::string> NodesOfTheJob();

/// Words in front of a command that start it once on each of these nodes, hand it their standard input, and merge what
/// it prints, line by line.
std::vector<std::string> OnEachNode(const std::vector<std::string>& nodes);

}  // namespace mascot

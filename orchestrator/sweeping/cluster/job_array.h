#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace mascot {

/// A sweep as a job array of Slurm: each task flies one share.
struct JobArray {
  std::vector<std::string> command;  ///< the command of the sweep, without the options --shard, --jobs, --quiet
  std::string folder;                ///< folder in which the command was typed
  std::string out;                   ///< path of the table that all shares are merged to
  std::size_t runs = 0;
  std::size_t tasks = 1;
  int jobs = 1;                      ///< processes of each task
  std::vector<std::string> options;  ///< for sbatch, "--time=02:00:00"; they replace ours of the same name
};

/// The script for sbatch. A task that is told that its time is nearly up (SIGUSR1, a minute before) ends in order and
/// is queued again; it then goes on with the runs that are missing. Throws ConfigError if `out` is a path beside which
/// Slurm cannot write logs.
std::string JobArrayScript(const JobArray& array);

}  // namespace mascot

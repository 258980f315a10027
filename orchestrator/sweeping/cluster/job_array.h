#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace mascot {

/// A sweep as a job array of Slurm: each task flies one share.
struct JobArray {
  std::vector<std::string> command;  ///< that of the sweep, without its options --shard, --jobs, --quiet
  std::string folder;                ///< where the command was typed
  std::string out;                   ///< the table that all shares together are
  std::size_t runs = 0;
  std::size_t tasks = 1;
  int jobs = 1;                      ///< processes of a task
  std::vector<std::string> options;  ///< of sbatch: "--time=02:00:00"; they come before ours of the same name
};

/// The script for sbatch. A task that is told that its time is up (SIGUSR1, a minute before) ends in order and is
/// queued again, and goes on with what is missing.
std::string JobArrayScript(const JobArray& array);

}  // namespace mascot

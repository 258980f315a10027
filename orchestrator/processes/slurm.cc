#include "orchestrator/processes/slurm.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <cstdio>
#include <sstream>
#include <stdexcept>

#include "experiment/toml/section.h"
#include "orchestrator/processes/environment.h"

namespace mascot {

std::vector<std::string> NodesOfTheJob() {
  if (EnvironmentText("SLURM_JOB_ID").empty() || EnvironmentText("SLURM_JOB_NODELIST").empty())
    throw ConfigError({"--slurm: expected a Slurm allocation (sbatch, salloc) around this command, got none"});
  FILE* pipe = popen("scontrol show hostnames \"$SLURM_JOB_NODELIST\"", "r");  // NOLINT(cert-env33-c): fixed words
  if (pipe == nullptr) throw std::runtime_error("cannot start scontrol");
  std::string text;
  std::array<char, 4096> buffer;
  while (const std::size_t got = fread(buffer.data(), 1, buffer.size(), pipe)) text.append(buffer.data(), got);
  const int status = pclose(pipe);
  std::istringstream lines(text);
  std::vector<std::string> nodes;
  for (std::string node; lines >> node;) nodes.push_back(node);
  if (status != 0 || nodes.empty()) throw std::runtime_error("scontrol does not tell the nodes of this job");
  return nodes;
}

std::vector<std::string> OnEachNode(const std::vector<std::string>& nodes) {
  std::vector<std::string> words{"srun",
                                 fmt::format("--nodelist={}", fmt::join(nodes, ",")),
                                 fmt::format("--nodes={}", nodes.size()),
                                 fmt::format("--ntasks={}", nodes.size()),
                                 "--ntasks-per-node=1",
                                 "--input=all",
                                 "--overlap",
                                 "--kill-on-bad-exit=0"};
  if (const std::string processors = EnvironmentText("SLURM_CPUS_ON_NODE"); !processors.empty())
    words.push_back("--cpus-per-task=" + processors);
  return words;
}

}  // namespace mascot

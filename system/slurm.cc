#include "system/slurm.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <optional>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <system_error>

#include "base/number.h"
#include "base/utf8.h"
#include "experiment/toml/section.h"
#include "system/descriptor.h"
#include "system/environment.h"
#include "system/spawn.h"

namespace mascot {
namespace {

constexpr std::size_t kLongestNode = 255, kLongestAnswer = std::size_t{16} << 20;

/// How many processors of each node the job has at least; nothing if Slurm does not tell.
std::optional<int> MinProcessors() {
  std::istringstream nodes(EnvironmentText("SLURM_JOB_CPUS_PER_NODE"));  // 72(x2),36
  std::optional<int> least;
  for (std::string node; std::getline(nodes, node, ',');) {
    const auto processors = NumberFrom<int>(std::string_view(node).substr(0, node.find('(')));
    if (!processors || *processors < 1) return std::nullopt;
    least = std::min(least.value_or(*processors), *processors);
  }
  return least;
}

/// The names of nodes that scontrol has told, a line each.
std::vector<std::string> NodesIn(const std::string& text) {
  std::istringstream lines(text);
  std::vector<std::string> nodes;
  std::set<std::string> known;
  for (std::string node; lines >> node;) {
    const bool is_name = node.size() <= kLongestNode && std::ranges::all_of(node, [](unsigned char c) {
                           return std::isalnum(c) != 0 || c == '-' || c == '.' || c == '_';
                         });
    if (!is_name || !known.insert(node).second)
      throw std::runtime_error(fmt::format("scontrol: expected the name of each node of this job once, got '{}'{}",
                                           Shortened(PlainLine(node), kLongestNode), is_name ? " again" : ""));
    nodes.push_back(node);
  }
  if (nodes.empty() || text.size() >= kLongestAnswer)
    throw std::runtime_error("scontrol does not tell the nodes of this job");
  return nodes;
}

/// What can be read, but at most kLongestAnswer: it is read to its end all the same, or its writer would wait.
std::string AllOf(const Descriptor& input) {
  std::string text;
  std::array<char, 4096> buffer;
  for (ssize_t got = 1; got != 0;) {
    got = read(input.number(), buffer.data(), buffer.size());
    if (got < 0 && errno != EINTR) throw std::system_error(errno, std::generic_category(), "cannot read from scontrol");
    if (got > 0 && text.size() < kLongestAnswer) text.append(buffer.data(), static_cast<std::size_t>(got));
  }
  return text;
}

}  // namespace

std::vector<std::string> NodesOfTheJob() {
  if (EnvironmentText("SLURM_JOB_ID").empty() || EnvironmentText("SLURM_JOB_NODELIST").empty())
    throw ConfigError({"--slurm: expected a Slurm allocation (sbatch, salloc) around this command, got none"});
  Pipe answer = MakePipe();
  ChildProcess scontrol = Spawn({.words = {"scontrol", "show", "hostnames", EnvironmentText("SLURM_JOB_NODELIST")},
                                 .output = answer.writes.number()});
  answer.writes = Descriptor();
  const std::string text = AllOf(answer.reads);
  if (scontrol.Reap() != 0) throw std::runtime_error("scontrol does not tell the nodes of this job");
  return NodesIn(text);
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
  if (const auto processors = MinProcessors()) words.push_back(fmt::format("--cpus-per-task={}", *processors));
  return words;
}

}  // namespace mascot

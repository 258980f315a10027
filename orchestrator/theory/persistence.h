#pragma once

#include <optional>
#include <string>
#include <vector>

#include "orchestrator/theory/timeline.h"

namespace mascot {

/// Whether, when and together with which other times the graph has a directed spanning tree: rooted at the leader if
/// there is one, and reaching all agents that do not stop during the run.
struct Persistence {
  bool always = false;             ///< at every time
  bool never_alone = false;        ///< at no time; then only the union of several times may have one
  bool joint = false;              ///< the union over what repeats has one; without repetition: the last graph has
  std::optional<double> window_s;  ///< of a graph that repeats: the union over any time so long has one
  std::optional<double> from_s;    ///< of one that does not: from this time on it has one
  std::optional<bool> in_range_at_start;  ///< with graph.range_m: that of starting positions within range has one
};

Persistence PersistenceOf(const Experiment& experiment, const Timeline& timeline);
/// "key: text": what keeps agents from meeting, if something does; of those who want to meet.
std::vector<std::string> PersistenceWarnings(const Experiment& experiment, const Timeline& timeline,
                                             const Persistence& persistence);
/// In a few words: "in the union of any 0.51 s; at no time alone".
std::string Describe(const Persistence& persistence);

}  // namespace mascot

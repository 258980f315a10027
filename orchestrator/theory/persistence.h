#pragma once

#include <optional>
#include <string>
#include <vector>

#include "orchestrator/theory/timeline.h"

namespace mascot {

/// When the graph, or its union over several times, has a directed spanning tree. The tree is rooted at the leader if
/// there is one, and reaches all agents that do not stop during the run.
struct Persistence {
  bool always = false;             ///< the graph has a tree at every time
  bool never_alone = false;        ///< the graph has a tree at no time; a union over several times may have one
  bool joint = false;              ///< the union over one repetition has a tree; without repetition: the last graph
  std::optional<double> window_s;  ///< with repetition: the union over any window of this length has a tree
  std::optional<double> from_s;    ///< without repetition: the graph has a tree from this time on
  std::optional<bool> in_range_at_start;  ///< with graph.range_m: the graph of the initial positions has a tree
};

Persistence PersistenceOf(const Experiment& experiment, const Timeline& timeline);
/// Warnings ("key: text") about the lack of a spanning tree, for laws by which agents agree.
std::vector<std::string> PersistenceWarnings(const Experiment& experiment, const Timeline& timeline,
                                             const Persistence& persistence);
/// Short text: "in the union of any 0.51 s; at no time alone".
std::string Describe(const Persistence& persistence);

}  // namespace mascot

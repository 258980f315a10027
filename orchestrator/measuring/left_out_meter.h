#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "agent/neighbours.h"
#include "agent/sensor.h"
#include "base/motion.h"
#include "experiment/experiment.h"

namespace mascot {

/// What laws leave out of what their agents hear (LawEntry::left_out), for viewers. What an agent hears and measures
/// depends only on the experiment, the tick and the true motions, and is therefore computed here again, from the rows.
class LeftOutMeter {
 public:
  /// The experiment must outlive this object.
  explicit LeftOutMeter(const Experiment& experiment);
  /// False if no law of the run ever leaves anything out: then neither Add() nor Mark() does anything.
  bool is_needed() const { return !neighbours_.empty(); }
  /// Call it when events have changed the experiment: from the next tick on, the experiment is `now`.
  void Adopt(const std::shared_ptr<const Experiment>& now);
  /// Adds the next tick, with the true motions of all agents, by id - 1.
  void Add(std::int64_t tick, std::span<const Motion> motions);
  /// Sets EdgeNow::left_out as it was at the newest tick. `edges` are all of the graph, in increasing order of hearer,
  /// then of heard.
  void Mark(std::vector<EdgeNow>& edges) const;

 private:
  void AddAgent(const AgentConfig& agent, std::int64_t tick, std::span<const Motion> motions);

  const Experiment& experiment_;
  std::shared_ptr<const Experiment> now_;  // null before the first event
  std::vector<Neighbours> neighbours_;     // by id - 1; empty if nothing is ever left out
  std::vector<OwnSensor> sensors_;         // likewise
  std::vector<std::uint8_t> left_out_;     // of each edge at the newest tick
  std::vector<Sample> samples_;            // scratch
};

}  // namespace mascot

// A run in the process of the test, recorded, with its rows kept.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "agent/laws/laws.h"
#include "orchestrator/engines/inprocess.h"
#include "orchestrator/measuring/run_meter.h"
#include "orchestrator/recording/run_folder.h"
#include "orchestrator/recording/run_writer.h"
#include "tests/support/scratch.h"

namespace mascot {

/// One tick of a run: its row, the state of each edge, the disagreement, the curve of the team's law.
struct FlownTick {
  DecodedRow row;
  std::vector<EdgeNow> edges;
  double disagreement_m = 0;
  std::optional<double> curve = {};
};

/// Flies `toml`, records it below `folder`, and keeps each tick.
class Flown final : private RowSink {
 public:
  Flown(const ScratchFolder& folder, const std::string& toml, const std::string& name = "run")
      : experiment_(LoadExperiment(Section::FromText(toml, name + ".toml"), name)), meter_(experiment_) {
    const RunFolder out(folder.File(name), experiment_, /*force=*/false);
    const Override none[] = {{.key = "events", .value = "[]"}};
    const Experiment without = LoadExperiment(Section::FromText(experiment_.resolved, name + ".toml", none), name);
    RunWriter writer(experiment_, out, without.resolved);
    EXPECT_EQ(RunInProcess(experiment_, {&writer, &meter_, this}, [] { return true; }).failure, "");
    writer.Close(experiment_.resolved);
    path_ = out.File("run.mcap").string();
  }

  const Experiment& experiment() const { return experiment_; }
  const std::string& path() const { return path_; }
  const FlownTick& at(std::int64_t tick) const { return ticks_.at(static_cast<std::size_t>(tick)); }
  std::int64_t last_tick() const { return static_cast<std::int64_t>(ticks_.size()) - 1; }

 private:
  void Add(const FlownRow& row) override {
    ticks_.push_back({row.decoded(), {}, meter_.disagreement_m(), meter_.curve()});
    meter_.EdgesNow(ticks_.back().edges);
  }

  Experiment experiment_;
  RunMeter meter_;
  std::string path_;
  std::vector<FlownTick> ticks_;
};

/// Whether two rows are the same, bit for bit, in all that a recording holds.
inline bool IsSame(const DecodedRow& a, const DecodedRow& b) {
  for (std::size_t i = 0; i < a.motions.size(); ++i) {
    const Motion &x = a.motions[i], &y = b.motions[i];
    const Command &c = a.commands[i], &d = b.commands[i];
    if (x.p_WB != y.p_WB || x.q_WB.coeffs() != y.q_WB.coeffs() || x.v_WB != y.v_WB || x.w_WB_B != y.w_WB_B ||
        x.a_WB != y.a_WB)
      return false;
    if (c.a_law_W != d.a_law_W || c.a_limited_W != d.a_limited_W || c.actuator != d.actuator || c.flags != d.flags)
      return false;
  }
  const auto same_event = [](const DecodedRow::RowEvent& e, const DecodedRow::RowEvent& f) {
    return e.number == f.number && e.event.tick == f.event.tick && e.event.Toml() == f.event.Toml();
  };
  return a.messages == b.messages && a.events_so_far == b.events_so_far &&
         std::ranges::equal(a.events, b.events, same_event);
}

}  // namespace mascot

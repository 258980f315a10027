// All rows of a run in the process of the test.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "orchestrator/engines/inprocess.h"
#include "orchestrator/team/row_sink.h"
#include "tests/support/three_agents.h"

namespace mascot {

/// Keeps every row.
class Rows final : public RowSink {
 public:
  void Add(const FlownRow& row) override { rows.push_back(row.decoded()); }
  std::vector<DecodedRow> rows;
};

/// Flies `toml` to its end.
inline std::vector<DecodedRow> Fly(const std::string& toml) {
  const Experiment experiment = Load(toml);
  Rows sink;
  const EngineResult result = RunInProcess(experiment, {&sink}, [] { return true; });
  EXPECT_EQ(result.failure, "");
  return sink.rows;
}

}  // namespace mascot

#pragma once

// Sweeps with the real `orchestrator`, and reads their tables, for end-to-end tests.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/support/folders.h"
#include "tests/support/orchestrator.h"
#include "tests/support/strict_csv.h"

namespace mascot::test {

using Cells = std::vector<std::string>;

/// The table of a sweep.
struct Table {
  explicit Table(const std::string& path) {
    rows = StrictCsv(ReadFile(path));
    if (rows.empty()) return;
    columns = rows.front();
    rows.erase(rows.begin());
  }
  std::string At(std::size_t row, const std::string& column) const {
    const auto place = std::ranges::find(columns, column);
    return place == columns.end() ? "no such column"
                                  : rows.at(row).at(static_cast<std::size_t>(place - columns.begin()));
  }
  /// The rows without the columns that depend on wall-clock time.
  std::vector<Cells> Repeatable() const {
    std::vector<Cells> all = rows;
    for (Cells& row : all) row.resize(row.size() - 2);
    return all;
  }
  Cells columns;
  std::vector<Cells> rows;
};

/// The number of rows of a table that a sweep may be writing: only whole rows count. 0 if there is no table.
inline std::size_t RowsSoFar(const std::string& path) {
  const std::string text = ReadFile(path);
  return static_cast<std::size_t>(std::max<std::ptrdiff_t>(std::ranges::count(text, '\n') - 1, 0));
}

/// A folder with a small experiment, and where its sweep goes.
class SweepTest : public ::testing::Test {
 protected:
  SweepTest() {
    WriteFile(config_,
              "[run]\nduration_s = 2.0\n[agents]\ncount = 3\n[graph]\ntopology = 'ring'\n[law]\np_gain = 0.3\n");
  }
  std::string Words(const std::string& more) const {
    return BuildFolder() + "/orchestrator sweep " + config_ + " --out " + out_ + " " + more;
  }
  Ran Sweep(const std::string& more) const { return Shell(Words(more)); }

  ScratchFolder folder_;
  std::string config_ = folder_.File("small.toml");
  std::string out_ = folder_.File("sweep.csv");
};

}  // namespace mascot::test

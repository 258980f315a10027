#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace mascot {

/// What is known of several finished runs, beside each other: what their experiments set differently, and what was
/// measured and predicted.
class SideBySide {
 public:
  /// Reads config.toml and summary.json of run folders. Throws ConfigError, "RUN: ...", for a folder that lacks one.
  explicit SideBySide(const std::vector<std::string>& runs);

  /// A table with a column for each run. Figures and keys that no run has are left out; "-": this run has no value.
  std::string Text() const;
  /// {"runs": [...], "config": {key: [...]}, "summary": {column: [...]}}, lists by run, null where a run has none.
  std::string JsonText() const;

 private:
  struct Line {
    std::string name;                ///< a dotted key
    std::vector<std::string> cells;  ///< by run; empty: it has none
  };

  std::vector<std::string> runs_;
  std::vector<Line> config_;   // keys that do not have the same value in all runs
  std::vector<Line> summary_;  // figures that a run has
};

}  // namespace mascot

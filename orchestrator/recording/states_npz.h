#pragma once

#include <string>
#include <vector>

#include "orchestrator/formats/npz.h"
#include "orchestrator/recording/state_arrays.h"

namespace mascot {

/// Writes states.npz row by row: the arrays of kStateArrays, and `id`. Failures throw std::runtime_error.
class StatesNpz {
 public:
  /// `commands`: whether to write the arrays of what the agents commanded.
  StatesNpz(const std::string& path, int agents, bool commands = true);

  void Append(const StateRow& row);
  /// Puts the file at `path`; without it there is none.
  void Close() { npz_.Close(); }

 private:
  struct Column {
    std::size_t array;  // index into kStateArrays
    int handle;
  };

  NpzWriter npz_;
  std::vector<Column> columns_;
};

}  // namespace mascot

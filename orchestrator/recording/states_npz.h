#pragma once

#include <string>
#include <vector>

#include "orchestrator/formats/npz.h"
#include "orchestrator/recording/state_arrays.h"

namespace mascot {

/// Writes states.npz row by row: the arrays of kStateArrays, and `id` (1 .. N). Failures throw std::runtime_error.
class StatesNpz {
 public:
  /// `max_rows`: how many rows may come. `commands`: whether to write the arrays with of_command.
  StatesNpz(const std::string& path, int agents, std::int64_t max_rows, bool commands = true);

  void Append(const StateRow& row);
  /// Completes the file. Without it there is no file.
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

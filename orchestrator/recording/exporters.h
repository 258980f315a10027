#pragma once

#include <span>
#include <string>
#include <string_view>

#include "orchestrator/recording/recording.h"

namespace mascot {

/// An export format for recordings. Exports the arrays of states.npz (docs/recording.md), without those of commands if
/// commands were not recorded.
struct Exporter {
  std::string_view format;  ///< also the file's extension
  /// Writes the complete file at `path`. Failures throw std::runtime_error and leave no new file.
  void (*write)(const Recording& recording, const std::string& path);
};

/// All formats.
std::span<const Exporter> Exporters();

}  // namespace mascot

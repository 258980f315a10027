#pragma once

#include <span>
#include <string>
#include <string_view>

#include "orchestrator/recording/recording.h"

namespace mascot {

/// A format that recordings are exported to: the arrays of states.npz (docs/recording.md), or what there is of them if
/// commands were not recorded.
struct Exporter {
  std::string_view format;  ///< also the file's extension
  /// Writes the file at `path`, or none: failures throw std::runtime_error.
  void (*write)(const Recording& recording, const std::string& path);
};

std::span<const Exporter> Exporters();

}  // namespace mascot

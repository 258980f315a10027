#pragma once

#include <memory>
#include <string>

#include "agent/plugin.h"

namespace mascot {

/// A shared library that holds a law. Once opened it stays in memory until the process ends: its code may still be
/// wanted after its last law is gone (what() of an exception that it threw, destructors of threads).
class LawLibrary {
 public:
  /// `path` is absolute. Throws std::runtime_error ("expected ..., got ...") for what is no such library, or one that
  /// does not fit this program.
  explicit LawLibrary(const std::string& path);

  bool sends_messages() const { return law_->sends_messages; }
  /// Throws what the law's constructor throws.
  std::unique_ptr<Law> Make(const PluginSetup& setup) const { return std::unique_ptr<Law>(law_->make(setup)); }

 private:
  const PluginExport* law_;
};

}  // namespace mascot

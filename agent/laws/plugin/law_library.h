#pragma once

#include <memory>
#include <string>

#include "agent/laws/plugin/plugin.h"

namespace mascot {

/// A shared library that holds a law. It stays loaded until the process ends: its code may still be needed after its
/// last law is gone (what() of an exception that it threw, destructors of threads).
class LawLibrary {
 public:
  /// `path` is absolute. Throws std::runtime_error ("expected ..., got ...") if the file is not a library with a law,
  /// or if the library does not fit this program.
  explicit LawLibrary(const std::string& path);

  bool sends_messages() const { return law_->sends_messages; }
  /// Gives a law of this library new parameters; null: the law takes none (PluginExport::set).
  auto set() const { return law_->set; }
  /// Makes a law. Throws what the law's constructor throws.
  std::unique_ptr<Law> Make(const PluginSetup& setup) const { return std::unique_ptr<Law>(law_->make(setup)); }

 private:
  const PluginExport* law_;
};

}  // namespace mascot

#pragma once

// What plugin*.cc share: a law in a shared library.

#include <memory>
#include <string>

#include "agent/laws/laws.h"
#include "agent/laws/plugin/law_library.h"
#include "agent/user_code/law_at_work.h"

namespace mascot {

struct PluginConfig final : LawParams {
  std::string library;  ///< absolute path; "" after a mistake
  Value params;         ///< a table
  /// What the laws wanted when they were tried; an acceleration if they were not.
  Wanted wanted = Wanted::kAcceleration;
};

/// What the library gets to make the law of agent `id`.
PluginSetup SetupOf(const Experiment& experiment, int id, PluginParams& params);
/// Text of the exception that is being handled.
std::string ExceptionText();
/// LawEntry::read: lets the library make the law of each agent once, to check its parameters and what it wants.
std::shared_ptr<const LawParams> ReadPlugin(const Experiment& experiment, const LawConfig& law, Section& section);

}  // namespace mascot

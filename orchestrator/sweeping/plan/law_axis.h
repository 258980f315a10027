#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "experiment/toml/section.h"
#include "orchestrator/sweeping/plan/plan.h"

namespace mascot {

/// A string of TOML, or a word as the command line has it, without quotes.
std::string Unquoted(const std::string& value);

/// The laws of a sweep over `law.name`. The file's [law] table has the keys of one law: what another one does not know
/// is left out of its runs, if one of these laws knows it. So is a key that --set gives one value. A key with several
/// values must be known to every law.
class LawAxis {
 public:
  /// `document`: the experiment file, parsed.
  LawAxis(Section document, const SweepPlan& plan);

  /// The values of law.name; empty: the sweep does not set it.
  const std::vector<std::string>& laws() const { return laws_; }
  /// What a run sets, without the keys that its law does not know.
  std::vector<Override> Fit(const std::vector<Override>& overrides) const;
  /// For each law with keys left out: "law.name = velocity_consensus: without law.beta".
  std::vector<std::string> Notes() const;

 private:
  struct Dropped {
    std::string law;
    std::vector<std::string> keys;  ///< dotted
  };
  std::vector<std::string> laws_;
  std::vector<Dropped> dropped_;
};

}  // namespace mascot

#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "experiment/toml/section.h"
#include "orchestrator/sweeping/plan/plan.h"

namespace mascot {

/// A value as typed, without the quotes of TOML, if it has some.
std::string Unquoted(const std::string& value);

/// The laws of a sweep over `law.name`. The file's [law] table has the keys of one law. A key in it that another law
/// does not know is left out of the runs of that law, if at least one law of the sweep or the file's own knows it. The
/// same holds for a key to which --set gives one value; a key with several values must be known to every law.
class LawAxis {
 public:
  /// `document`: the experiment file, parsed.
  LawAxis(Section document, const SweepPlan& plan);

  /// The values of law.name, each once; empty: the sweep does not set it.
  const std::vector<std::string>& laws() const { return laws_; }
  /// The overrides of a run, without the keys that its law does not know, and with orders to remove these from the
  /// file's table.
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

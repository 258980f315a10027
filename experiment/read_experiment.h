#pragma once

#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "experiment/experiment.h"
#include "experiment/toml/section.h"

namespace mascot {

/// The version of the files that a run leaves: config.toml, summary.json and the recording state it, as `format`. It is
/// raised when a reader of the version before would misunderstand one of them. Readers refuse a newer version; a file
/// without `format` has version 1.
inline constexpr int kFormat = 1;
/// Reads `format` of an experiment file; notes a mistake if it is newer than kFormat. The document uses
/// ExperimentKeys().
void CheckFormat(Section& document);
/// Reads run.pace; nullopt: there is none. Notes a mistake if the run is in real time.
std::optional<double> ReadPace(Section& run, Mode mode);

/// All keys that an experiment file may have, except the parameters of single laws (agent/laws/laws.h).
std::span<const Key> ExperimentKeys();
/// The keys of [law] that all laws share.
std::span<const Key> LawKeys();

/// The laws that an experiment file may name: an interface, because their table is in a library above this one
/// (agent/laws/laws.h).
class LawCatalog {
 public:
  virtual ~LawCatalog() = default;
  /// Names of all laws; the first is the default of law.name.
  virtual std::span<const std::string_view> names() const = 0;
  /// The default of law.axes.
  virtual Axes DefaultAxes(std::string_view law) const = 0;
  /// The keys of a law in [law], besides LawKeys().
  virtual std::span<const Key> Parameters(std::string_view law) const = 0;
  /// The keys in an agent's law, with their values, that make it fly to `p_W` from `t_s` on; empty: it flies no
  /// waypoints.
  virtual std::map<std::string, Value> GoTo(const AgentConfig& agent, const Eigen::Vector3d& p_W, double t_s) const = 0;
  /// Reads and checks the parameters of `law`, which is experiment.law or an agent's own, from its table `section`.
  /// Everything else has been read. Mistakes are noted in `section`.
  virtual std::shared_ptr<const LawParams> Read(const Experiment& experiment, const LawConfig& law,
                                                Section& section) const = 0;
};

/// Reads a complete experiment. `default_name` is the default of run.name. `checked` says that the experiment was read
/// before, without a mistake. Throws ConfigError with all mistakes.
Experiment ReadExperiment(Section document, const LawCatalog& laws, const std::string& default_name, bool checked,
                          UserCode user_code = UserCode::kMayRun);
/// Reads a resolved and checked experiment without the parameters of laws, for the physics server, which runs none.
/// Throws ConfigError.
Experiment ReadWithoutLaws(Section document, const std::string& default_name);

}  // namespace mascot

#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/engines/engine.h"
#include "orchestrator/engines/stepped_team.h"
#include "orchestrator/serving/recorded_series.h"
#include "orchestrator/serving/snapshot_text.h"
#include "system/console.h"

namespace mascot {

/// The version of the words between clients and server (docs/serve.md).
inline constexpr int kServeProtocol = 1;

/// A team that waits to be stepped, and what clients ask of it: requests in, answers out, without sockets and threads.
class TeamService {
 public:
  using Json = nlohmann::ordered_json;
  struct Options {
    std::string text, path;  ///< of the experiment
    std::vector<Override> overrides = {};
    std::vector<int> ports = {};          ///< agents that take actions, besides those that do by the file
    std::string engine = kInProcess;      ///< which flies them
    Console* console = nullptr;           ///< over DDS, what processes say goes there
    std::optional<std::string> out = {};  ///< every episode is recorded as a run in this folder: "1", "2", ...
    std::function<bool()> may_go_on = [] { return true; };  ///< asked before each tick; false: a step ends early
  };
  /// The first episode is at its tick 0. Throws what the engine's episodes throw (SteppedTeam).
  explicit TeamService(Options options);

  /// An agent that takes actions.
  struct Port {
    int agent = 0;
    std::size_t numbers = 0;  ///< of an action: 3 of what the agent wants, and those of its message
  };
  const std::vector<Port>& ports() const { return ports_; }
  /// How many numbers the actions of all ports have together.
  std::size_t action_numbers() const;
  const SteppedTeam& team() const { return *team_; }
  /// Ends the episode, for good. Returns whether the process may end in order (SteppedTeam::Leave()).
  bool Leave() { return team_->Leave(); }

  /// Whether the request changes something, so that one client alone may make it.
  static bool IsChange(const std::string& request);
  /// Answers a request ({"request": ...}), which is an object. Throws JsonError, ConfigError, std::invalid_argument and
  /// std::runtime_error with words for the client; then the team is as before, or its episode has ended.
  Json Answer(const Json& request);
  /// Goes on by at most `ticks` ticks, with these actions of all ports, one after the other; none: those before hold.
  /// Throws as Answer() does.
  void Step(std::int64_t ticks, std::span<const double> actions);

  /// The largest number of ticks of one step, and of snapshots that are kept.
  static constexpr std::int64_t kMostTicks = 1'000'000;
  static constexpr std::size_t kMostSnapshots = 256;
  /// The figures of this tick, in the order of FigureTable(); NaN: there is none.
  struct Figure {
    const char *name, *unit, *description;
  };
  static const std::vector<Figure>& FigureTable();
  std::vector<double> Figures() const;

 private:
  std::unique_ptr<SteppedTeam> MakeTeam();
  Json Hello() const;
  Json State();
  Json Reset(const Json& request);
  Json Step(const Json& request);
  Json Take(const Json& event);
  Json Save(const Json& request);
  Json Restore(const Json& request);
  Json Forget(const Json& request);
  std::map<std::int64_t, ServedSnapshot>::const_iterator SnapshotOf(const Json& request) const;
  void Act(const Port& port, std::span<const double> action);
  std::vector<Override> Changes(const EpisodeStart& start) const;
  void Begin();
  std::vector<std::vector<double>> ActionsIn(const Json& actions) const;

  const Options options_;
  std::optional<RecordedSeries> records_;
  EpisodeStart start_;  // of this episode
  const std::unique_ptr<SteppedTeam> team_;
  std::vector<Port> ports_;
  std::map<std::int64_t, ServedSnapshot> snapshots_;
  std::int64_t next_snapshot_ = 1;
};

}  // namespace mascot

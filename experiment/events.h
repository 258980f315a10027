#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "experiment/faults.h"
#include "experiment/graph/edge.h"
#include "experiment/toml/section.h"

namespace mascot {

/// What changes a run while it goes on: one [[events]] table of the file, or the same keys given by hand. It takes
/// effect at a tick, before anybody answers that tick.
struct Event {
  using Edges = std::vector<Edge>;
  struct GoTo {
    int agent = 0;
    Eigen::Vector3d p_W = Eigen::Vector3d::Zero();  ///< where to (m)
  };

  std::int64_t tick = 0;
  std::map<std::string, Value> set = {};  ///< live keys, dotted, and their new values
  std::vector<int> agents = {};           ///< of `set`: the agents for which it is; empty: all agents that have the key
  std::optional<GoTo> go_to = {};         ///< replaces that agent's waypoints by this one
  std::optional<Edges> graph = {};        ///< the edges that work from now on, of those that the file declares
  Edges cut = {};                         ///< edges that work no more
  Edges mend = {};                        ///< edges that work again
  std::optional<Fault> fault = {};        ///< what goes wrong with an agent
  std::optional<int> restart = {};        ///< the agent whose place a fresh one takes
  bool after_loss = false;                ///< of restart: run.on_agent_loss has brought it, no [[events]]
  /// A phase of [[law.schedule]]: the whole law table from now on, of `agents`, or else of all without one of their
  /// own.
  std::optional<Value::Table> law = {};
  std::vector<std::string> files = {};  ///< absolute paths of files that `law` depends on, as LawParams::files
  std::string where = {};               ///< place of the event, as messages say it: "a.toml:12:1", "event by hand"

  /// Its keys but at_s as TOML, in a fixed form: the same for the event of a file and the same event given by hand.
  std::string Toml() const;
};

/// An experiment's text with one more event behind those that it has. `toml`: Event::Toml().
std::string WithEvent(std::string experiment, std::int64_t tick, int rate_hz, const std::string& toml);

/// Reads the key `at_s`, a whole number of ticks up to `last_tick`; 0 after a mistake, or with `rate_hz` = 0 (unknown).
std::int64_t ReadTick(Section& section, int rate_hz, std::int64_t last_tick);

/// The keys of [[events]].
std::span<const Key> EventKeys();
/// Reads `section`, one [[events]] table or the keys given by hand, all but at_s. `agents`: their number; 0: unknown
/// because of a mistake. Which keys are live, and which values legal, LiveExperiment::Take() says.
Event ReadEvent(Section& section, int agents);
/// Whether the event whose Event::Toml() this is stands elsewhere in the file than in [[events]]: a phase, or a restart
/// that run.on_agent_loss brings.
bool StandsElsewhere(const std::string& toml);
/// The event of this tick that Event::Toml() is `toml` of: of any event of a run of so many agents, also of those that
/// stand elsewhere.
/// Throws ConfigError, with `where` in front, for other text.
Event EventFrom(std::int64_t tick, const std::string& toml, int agents, const std::string& where);
/// Reads [[events]], in the order of the file. `ticks`: the last tick.
std::vector<Event> ReadEvents(Section& document, int agents, int rate_hz, std::int64_t ticks);

}  // namespace mascot

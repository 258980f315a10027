#include "experiment/law_tables.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "experiment/safety.h"
#include "experiment/toml/few_tables.h"

namespace mascot {
namespace {

/// The agent has the topics that a law of one of its phases needs.
void NoteTopics(const LawParams& params, AgentConfig& agent) {
  agent.sends_messages = agent.sends_messages || params.sends_messages;
  agent.takes_actions = agent.takes_actions || params.action > 0;
}

/// The table `safety` of a law table; nullopt: it has none.
std::optional<Section> SafetyOf(std::optional<Section> law) {
  return law && law->Has("safety") ? std::optional(law->Child("safety")) : std::nullopt;
}

/// Reads `safety` of a law table; what it leaves out, or all of it, is as in `before`, if there is one. `before` is
/// then what was read.
std::optional<SafetyConfig> ReadSafetyOf(Section& law, std::optional<Section>& before) {
  if (!law.Has("safety") && !before) return std::nullopt;
  Section safety = law.Child("safety");
  if (before) safety.InheritFrom(*before);
  before = safety;
  return ReadSafety(safety);
}

/// Reads the keys that all laws share but safety, `usual` being the axes if the table does not say.
LawConfig ReadCommon(Section& section, int count, const LawCatalog& laws, std::optional<Axes> usual) {
  LawConfig law;
  law.name = section.OneOf("name", laws.names(), std::string(laws.names().front()));
  law.leader = static_cast<int>(section.Integer("leader", 0, count > 0 ? count : kMaxAgents, 0));
  const Axes axes = usual.value_or(laws.DefaultAxes(law.name));
  law.axes = kAxes.Value(section.OneOf("axes", kAxes.names(), std::string(kAxes.Name(axes))));
  return law;
}

/// The schedule of one law table while it is read.
class ScheduleReader {
 public:
  /// `agent`: whose table it is; 0: the team's.
  ScheduleReader(const LawCatalog* laws, const Section& table, const LawConfig& law, int agent, Experiment& experiment)
      : laws_(laws), table_(table), safety_(SafetyOf(table)), before_(law), agent_(agent), experiment_(experiment) {}

  /// Phases that do not begin before `last_tick` are checked, but are no events.
  void Read(int rate_hz, std::int64_t last_tick, std::vector<Event>& events) {
    std::int64_t last = 0;
    for (Section& phase : FewTables(table_, "schedule", kMaxPhases)) {
      Event event{.tick = ReadTick(phase, rate_hz, kLongAfter),
                  .agents = agent_ > 0 ? std::vector{agent_} : std::vector<int>(),
                  .where = phase.Where("")};
      if (rate_hz > 0 && !phase.Wrong("at_s") && event.tick <= last)
        phase.Fail("at_s",
                   "expected a later time than that of the phase before, got " + ShortestFloat(phase.Number("at_s")));
      last = event.tick;
      if (laws_ != nullptr) ReadPhase(phase, event);
      if (!phase.Wrong("")) event.law = laws_ != nullptr ? phase.AsRead() : phase.InTheFile();
      if (event.law) event.law->erase("at_s");
      if (event.tick < last_tick || rate_hz == 0)
        events.push_back(std::move(event));
      else if (!phase.Wrong("at_s"))
        experiment_.late_phases_s.push_back(phase.Number("at_s"));
    }
  }

 private:
  static constexpr std::size_t kMaxPhases = 1000;  // each looks for its keys in all those before it
  static constexpr std::int64_t kLongAfter = std::numeric_limits<std::int64_t>::max();

  void ReadPhase(Section& phase, Event& event) {
    const bool goes_on = !phase.Has("name") || phase.Text("name") == before_.name;
    if (goes_on) phase.InheritFrom(table_, {"schedule"});  // and safety in any case, below
    LawConfig law = ReadCommon(phase, experiment_.size(), *laws_, before_.axes);
    law.safety = ReadSafetyOf(phase, safety_);
    if (!phase.Wrong("axes") && law.axes != before_.axes)
      phase.Fail("axes", "expected \"" + std::string(kAxes.Name(before_.axes)) + "\", as before, got \"" +
                             std::string(kAxes.Name(law.axes)) + "\": heights are held in all phases, or in none");
    if (!phase.Wrong("name") && !phase.Wrong("leader")) {
      law.params = laws_->Read(With(law), law, phase);
      event.files = law.params->files;
      for (AgentConfig& agent : experiment_.agents)
        if (Concerns(agent)) NoteTopics(*law.params, agent);
      phase.Done();
    }
    before_ = std::move(law);
    table_ = phase;
  }

  bool Concerns(const AgentConfig& agent) const { return agent_ > 0 ? agent.id == agent_ : !agent.has_own_law; }
  /// The experiment with `law` in place.
  Experiment With(const LawConfig& law) const {
    Experiment experiment = experiment_;
    if (agent_ == 0) experiment.law = law;
    for (AgentConfig& agent : experiment.agents)
      if (Concerns(agent)) agent.law = law;
    return experiment;
  }

  const LawCatalog* laws_;
  Section table_;                  // that of the phase before
  std::optional<Section> safety_;  // as it is in the phase before, of whichever law
  LawConfig before_;
  int agent_;
  Experiment& experiment_;
};

}  // namespace

std::span<const Key> LawKeys() {
  static const Key schedule[] = {
      key::Number("at_s", Above(0, 1e6), "time at which the phase begins; a whole number of ticks").Required(),
      key::Text("name", "one of the laws below").Otherwise("the law before"),
      key::Integer("leader", 0, kMaxAgents, "number of the agent that leads; 0: none")
          .Otherwise("that before, if the law stays; else 0"),
      key::OneOf("axes", kAxes.names(), "the axes that the law controls, always those of the first phase")
          .Otherwise("those before"),
      key::Table("safety", SafetyKeys(), "a filter around any law that keeps agents apart")
          .Otherwise("that before, also around another law"),
  };
  static const Key keys[] = {
      key::Text("name", "one of the laws below").Otherwise("the first of the laws"),
      key::Integer("leader", 0, kMaxAgents, "number of the agent that leads; 0: none").Default("0"),
      key::OneOf("axes", kAxes.names(), "the axes that the law controls; with xy each agent holds its initial height")
          .Otherwise("the law's own"),
      key::Table("safety", SafetyKeys(), "a filter around any law that keeps agents apart").Otherwise("none"),
      key::Tables("schedule", schedule,
                  "the law from a time on; also any parameter of that law; a phase that names the law of the phase "
                  "before, or no law, keeps its parameters; at most 1000"),
  };
  return keys;
}

LawConfig ReadLaw(Section& section, std::optional<Section> team, int count, const LawCatalog* laws) {
  LawConfig law;
  if (laws != nullptr) {
    law = ReadCommon(section, count, *laws, {});
  } else {
    law.name = section.Text("name");
    law.leader = static_cast<int>(section.Integer("leader", 0, count > 0 ? count : kMaxAgents));
    law.axes = kAxes.Value(section.OneOf("axes"));
  }
  std::optional<Section> safety = SafetyOf(team);
  law.safety = ReadSafetyOf(section, safety);
  return law;
}

void ReadOwnLaw(AgentOverride& override, const Section& team, int count, const LawCatalog* laws,
                Experiment& experiment) {
  if (!override.section.Has("law")) return;
  Section own = override.section.Child("law");
  const bool inherits = !own.Has("name") || own.Text("name") == experiment.law.name;
  if (inherits) own.InheritFrom(team, {"schedule"});
  const LawConfig law = ReadLaw(own, inherits ? std::optional(team) : std::nullopt, count, laws);
  if (override.id == 0) return;
  AgentConfig& agent = experiment.agents[static_cast<std::size_t>(override.id - 1)];
  agent.law = law;
  agent.has_own_law = true;
  override.law = own;
}

void ReadLawParameters(const LawCatalog& laws, Section& team, std::vector<AgentOverride>& overrides,
                       Experiment& experiment) {
  experiment.law.params = laws.Read(experiment, experiment.law, team);
  for (AgentConfig& agent : experiment.agents)
    if (!agent.has_own_law) agent.law.params = experiment.law.params;
  for (AgentOverride& override : overrides) {
    if (!override.law) continue;
    LawConfig& own = experiment.agents[static_cast<std::size_t>(override.id - 1)].law;
    own.params = laws.Read(experiment, own, *override.law);
  }
  for (AgentConfig& agent : experiment.agents) NoteTopics(*agent.law.params, agent);
}

std::vector<Event> ReadLawSchedules(const LawCatalog* laws, Section& team, std::vector<AgentOverride>& overrides,
                                    int rate_hz, std::int64_t last_tick, Experiment& experiment) {
  std::vector<Event> events;
  ScheduleReader(laws, team, experiment.law, 0, experiment).Read(rate_hz, last_tick, events);
  for (const AgentOverride& override : overrides)
    if (override.law)
      ScheduleReader(laws, *override.law, experiment.agent(override.id).law, override.id, experiment)
          .Read(rate_hz, last_tick, events);
  return events;
}

}  // namespace mascot

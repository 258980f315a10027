// Every random number of a run comes from a stream of Random or Dice (base/random.h), or from a law that is given
// run.seed. Each stream has a case below: the compiler refuses a stream without one.
#include "orchestrator/theory/draws.h"

#include <algorithm>

#include "agent/laws/laws.h"
#include "base/random.h"
#include "experiment/live_experiment.h"
#include "experiment/toml/section.h"

namespace mascot {
namespace {

/// Whether something happens only now and then.
bool IsChance(double probability) { return probability > 0 && probability < 1; }

using Keys = std::vector<std::string>;

void AddOnce(const char* key, bool if_so, Keys& keys) {
  if (if_so && std::ranges::find(keys, key) == keys.end()) keys.emplace_back(key);
}

/// Whether a table with the keys of [graph] draws its edges. A geometric graph follows from where agents start.
bool DrawsEdges(Section graph) {
  if (!graph.Has("random")) return false;
  Section random = graph.Child("random");
  return random.Has("p") && IsChance(random.Free("p").Number());
}

/// What is drawn before the run. `document`: the resolved experiment.
void AddOnReading(Random::Stream stream, Section& document, Keys& keys) {
  switch (stream) {
    case Random::Stream::kPositions:
    case Random::Stream::kVelocities:
    case Random::Stream::kHeadings:
      return AddOnce("agents.random", document.Child("agents").Has("random"), keys);
    case Random::Stream::kGraph: {
      Section graph = document.Child("graph");
      AddOnce("graph.random", DrawsEdges(graph), keys);
      for (const Section& phase : graph.Children("schedule")) AddOnce("graph.schedule.random", DrawsEdges(phase), keys);
      return;
    }
    case Random::Stream::kSweep:     // by the plan of a sweep,
    case Random::Stream::kEpisodes:  // or from one episode to the next: they draw run.seed itself
      return;
  }
}

void AddLink(const LinkConfig& link, Keys& keys) {
  AddOnce("link.loss", !link.bursts && IsChance(link.loss), keys);
  const auto& bursts = link.bursts;
  AddOnce("link.gilbert_elliott",
          bursts && (IsChance(bursts->good_to_bad) || IsChance(bursts->bad_to_good) || IsChance(bursts->loss_good) ||
                     IsChance(bursts->loss_bad)),
          keys);
  AddOnce("link.jitter_s", link.jitter_s > 0, keys);
  AddOnce("link.reordering", link.delay_s > 0 && IsChance(link.reordering), keys);
}

bool Draws(const Fault& fault) {
  return fault.kind == FaultKind::kGarbage || (fault.kind == FaultKind::kIntermittent && IsChance(fault.probability));
}

/// What is drawn in flight, as the experiment is at some time.
void AddInFlight(Dice::Stream stream, const Experiment& now, Keys& keys) {
  const auto is_heard = [&](int id) {
    return std::ranges::any_of(now.agents, [&](const AgentConfig& agent) { return now.graph.Hears(agent.id, id); });
  };
  switch (stream) {
    case Dice::Stream::kLink:
      for (const AgentConfig& agent : now.agents)
        for (const Graph::Neighbour& heard : now.graph.HeardBy(agent.id))
          AddLink(now.links.Of(agent.id, heard.id), keys);
      return;
    case Dice::Stream::kOwnSensor:
      return AddOnce("sensors.own", !now.sensors.own.IsNone(), keys);
    case Dice::Stream::kHeardSensor:
      return AddOnce("sensors.heard",
                     !now.sensors.heard.IsNone() && std::ranges::any_of(now.agents, is_heard, &AgentConfig::id), keys);
    case Dice::Stream::kWind:
      return AddOnce("physics.wind.gust_std_m_per_s", now.physics.wind.gust_std_m_per_s > 0, keys);
    case Dice::Stream::kFalseData:
      for (const AgentConfig& agent : now.agents)
        AddOnce("agents.override.lie", agent.lie && agent.lie->kind == FalseDataKind::kRandom && is_heard(agent.id),
                keys);
      return;
    case Dice::Stream::kFaultySensor:
    case Dice::Stream::kFaultyMotor:
    case Dice::Stream::kFaultyLink:
      for (const AgentConfig& agent : now.agents)
        for (const PartFault& part : agent.faults.parts) AddOnce("events.fault", Draws(part.fault), keys);
      return;
  }
}

bool AnyLawDraws(const Experiment& experiment) {
  return std::ranges::any_of(LawsIn(experiment), [](const LawEntry* law) { return law->draws != nullptr; });
}

/// Whether an event may change what is drawn. `laws_draw`: it may be a key of a law on which that depends.
bool MayDraw(const Event& event, bool laws_draw) {
  const auto may = [&](const auto& entry) {
    const std::string table = entry.first.substr(0, entry.first.find('.'));
    return table != "control" && table != "run" && (table != "law" || laws_draw);
  };
  return event.law.has_value() || event.fault.has_value() || std::ranges::any_of(event.set, may);
}

void AddAll(const Experiment& now, Keys& keys) {
  using enum Dice::Stream;
  for (const Dice::Stream stream :
       {kLink, kOwnSensor, kHeardSensor, kWind, kFalseData, kFaultySensor, kFaultyMotor, kFaultyLink})
    AddInFlight(stream, now, keys);
  for (const AgentConfig& agent : now.agents) {
    const LawEntry& law = EntryOf(agent.law);
    AddOnce("law", law.draws != nullptr && law.draws(agent.law), keys);
  }
}

}  // namespace

std::vector<std::string> DrawsOf(const Experiment& experiment) {
  Keys keys;
  Section document = Section::FromText(experiment.resolved, "the resolved experiment");
  using enum Random::Stream;
  for (const Random::Stream stream : {kPositions, kVelocities, kHeadings, kGraph, kSweep})
    AddOnReading(stream, document, keys);
  AddAll(experiment, keys);
  const bool laws_draw = AnyLawDraws(experiment);
  const auto may_draw = [&](const Event& event) { return MayDraw(event, laws_draw); };
  if (std::ranges::none_of(experiment.events, may_draw)) return keys;  // each event means another reading
  LiveExperiment live(experiment, &LawTable(), /*checked=*/true);
  for (const Event& event : experiment.events) AddAll(*live.After(event), keys);
  return keys;
}

}  // namespace mascot

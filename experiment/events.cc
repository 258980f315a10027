#include "experiment/events.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <string>
#include <utility>

#include "experiment/agent_ids.h"
#include "experiment/experiment.h"
#include "experiment/live_experiment.h"
#include "experiment/toml/few_tables.h"

namespace mascot {
namespace {

constexpr Range kGoTo_m = {-1e6, 1e6};
constexpr std::array kEventKinds = {"set", "goto", "graph", "cut", "mend", "fault", "restart"};

constexpr Key kGoToKeys[] = {
    key::Integer("agent", 1, kMaxAgents, "a leader, or an agent that flies waypoints").Required(),
    key::Vector3("position_m", kGoTo_m, "where to, in W").Required(),
};

constexpr Key kGraphKeys[] = {
    key::Rows("edges", {1, kMaxAgents}, "`[i, j]`, ... (i hears j)").Required(),
};

constexpr Key kAgents = key::Numbers("agents", {1, kMaxAgents}, "with set: the agents for which it is")
                            .Otherwise("all agents that have the key");

constexpr Key kPhaseKeys[] = {
    key::Any("law", "a whole law table"),
    kAgents,
};

constexpr Key kAfterLossKeys[] = {
    key::Boolean("after_loss", "run.on_agent_loss has brought the restart"),
};

/// Puts the leaves of `value` into `set`, under dotted keys: { law = { p_gain = 1 } } is { "law.p_gain" = 1 }. Returns
/// a key that is there twice; empty: none is.
std::string Flatten(const std::string& key, const Value& value, std::map<std::string, Value>& set) {
  const auto* table = std::get_if<Value::Table>(&value.data);
  if (table == nullptr || (table->empty() && !key.empty())) return set.emplace(key, value).second ? "" : key;
  std::string twice;
  for (const auto& [name, inner] : *table)
    if (std::string found = Flatten(key.empty() ? name : key + "." + name, inner, set); !found.empty())
      twice = std::move(found);
  return twice;
}

void ReadSet(Section& section, Event& event) {
  if (section.Kind("set") != "table") {
    section.Fail("set", "expected a table, got a " + section.Kind("set"));
    return;
  }
  const std::string twice = Flatten("", section.Free("set"), event.set);
  if (!twice.empty()) section.Fail("set", "expected each key once, got " + twice + " twice");
  if (event.set.empty()) section.Fail("set", "expected live keys and their new values, got none");
}

Event::Edges ReadEdges(Section& section, std::string_view key) {
  Event::Edges edges;
  const auto rows = section.Rows(key);
  std::set<Edge> seen;
  for (std::size_t k = 0; k < rows.size() && !section.Wrong(key); ++k) {
    const auto whole = [](double number) { return number == std::floor(number); };
    if (rows[k].size() != 2 || !std::ranges::all_of(rows[k], whole)) {
      section.FailRow(key, k, "expected an edge [i, j] (i hears j)");
      continue;
    }
    const Edge edge(static_cast<int>(rows[k][0]), static_cast<int>(rows[k][1]));
    if (!seen.insert(edge).second) section.FailRow(key, k, EachOnce("edge", EdgeText(edge)));
    edges.push_back(edge);
  }
  return edges;
}

Event::GoTo ReadGoTo(Section section, int agents) {
  Event::GoTo go_to;
  go_to.agent = static_cast<int>(section.Integer("agent", 1, agents > 0 ? agents : kMaxAgents));
  go_to.p_W = section.Vector3("position_m");
  section.Done();
  return go_to;
}

Event::Edges ReadGraph(Section section) {
  Event::Edges edges = ReadEdges(section, "edges");
  if (!section.Has("edges")) section.Fail("edges", "expected edges [i, j] (i hears j), got nothing");
  section.Done();
  return edges;
}

/// The kind of the event; "" after a mistake: it is not of exactly one.
std::string ReadKind(Section& section) {
  std::string found, all;
  int count = 0;
  for (const char* kind : kEventKinds) {
    all += (all.empty() ? "" : ", ") + std::string(kind);
    if (!section.Has(kind)) continue;
    found += (found.empty() ? "" : " and ") + std::string(kind);
    ++count;
  }
  if (count != 1) section.Fail("", "expected one of " + all + ", got " + (count == 0 ? "none" : found));
  if (section.Has("agents") && !section.Has("set"))
    section.Fail("agents", "expected only with set, got " + (count == 0 ? "it alone" : found));
  return count == 1 ? found : "";
}

Event ReadPhase(Section& section, int agents) {
  Event event;
  event.where = section.Where("");
  const Value law = section.Free("law");
  if (const auto* table = std::get_if<Value::Table>(&law.data))
    event.law = *table;
  else
    section.Fail("law", "expected a table, got a " + section.Kind("law"));
  if (section.Has("agents")) event.agents = ReadAgentIds(section, "agents", agents);
  return event;
}

std::string EdgesText(const Event::Edges& edges) {
  Value::List list;
  for (const auto& [hearer, heard] : edges)
    list.push_back({Value::List{{std::int64_t{hearer}}, {std::int64_t{heard}}}});
  return ToToml({std::move(list)});
}

std::string PointText(const Eigen::Vector3d& p) { return ToToml({Value::List{{p.x()}, {p.y()}, {p.z()}}}); }

}  // namespace

std::string Event::Toml() const {
  std::string text;
  if (!set.empty()) text += "set = " + ToToml({Value::Table(set.begin(), set.end())}) + "\n";
  if (law) text += "law = " + ToToml({*law}) + "\n";
  if (!agents.empty()) {
    Value::List ids;
    for (const int id : agents) ids.push_back({std::int64_t{id}});
    text += "agents = " + ToToml({std::move(ids)}) + "\n";
  }
  if (go_to)
    text += "goto = { agent = " + std::to_string(go_to->agent) + ", position_m = " + PointText(go_to->p_W) + " }\n";
  if (graph) text += "graph = { edges = " + EdgesText(*graph) + " }\n";
  if (!cut.empty()) text += "cut = " + EdgesText(cut) + "\n";
  if (!mend.empty()) text += "mend = " + EdgesText(mend) + "\n";
  if (fault) text += "fault = " + ToToml(*fault) + "\n";
  if (restart) text += "restart = " + std::to_string(*restart) + "\n";
  if (after_loss) text += "after_loss = true\n";
  return text;
}

std::string WithEvent(std::string experiment, std::int64_t tick, int rate_hz, const std::string& toml) {
  const std::string at_s = ShortestFloat(static_cast<double>(tick) / rate_hz);
  return std::move(experiment) + "\n[[events]]\nat_s = " + at_s + "\n" + toml;
}

std::int64_t ReadTick(Section& section, int rate_hz, std::int64_t last_tick) {
  constexpr double kTolerance = 1e-9;  // relative: 0.1 s at 30 Hz is 3 ticks although 0.1 is not a binary fraction
  const double at_s = section.Number("at_s");
  if (section.Wrong("at_s") || rate_hz == 0) return 0;
  const double ticks = at_s * rate_hz;
  if (std::abs(ticks - std::round(ticks)) > kTolerance * ticks) {
    section.Fail("at_s", "expected a whole number of periods of control.rate_hz (" + std::to_string(rate_hz) +
                             "), got " + ShortestFloat(at_s));
  } else if (std::round(ticks) > static_cast<double>(last_tick)) {
    section.Fail("at_s", "expected at most run.duration_s, got " + ShortestFloat(at_s));
  }
  return section.Wrong("at_s") ? 0 : std::llround(ticks);
}

std::span<const Key> EventKeys() {
  static const Key keys[] = {
      key::Number("at_s", {0, 1e6}, "when; a whole number of ticks").Required(),
      key::Any("set", "live keys and their new values: `{ \"law.p_gain\" = 0.2 }`"),
      kAgents,
      key::Table("goto", kGoToKeys, "the agent's waypoints are replaced by this one"),
      key::Table("graph", kGraphKeys, "these edges work from now on, of those that the file declares, and no others"),
      key::Rows("cut", {1, kMaxAgents}, "`[i, j]`, ...: edges that work no more (i hears j)"),
      key::Rows("mend", {1, kMaxAgents}, "`[i, j]`, ...: edges that work again"),
      key::Table("fault", FaultKeys(), "something goes wrong with an agent, see the table of faults"),
      key::Integer("restart", 1, kMaxAgents,
                   "a fresh process of this agent takes its place, with a law that begins anew"),
  };
  return keys;
}

Event ReadEvent(Section& section, int agents) {
  Event event;
  event.where = section.Where(ReadKind(section));
  if (section.Has("set")) ReadSet(section, event);
  if (section.Has("agents")) event.agents = ReadAgentIds(section, "agents", agents);
  if (section.Has("goto")) event.go_to = ReadGoTo(section.Child("goto"), agents);
  if (section.Has("graph")) event.graph = ReadGraph(section.Child("graph"));
  for (const auto& [key, edges] : {std::pair("cut", &event.cut), std::pair("mend", &event.mend)}) {
    if (!section.Has(key)) continue;
    *edges = ReadEdges(section, key);
    if (edges->empty() && !section.Wrong(key)) section.Fail(key, "expected edges [i, j] (i hears j), got none");
  }
  if (section.Has("fault")) event.fault = ReadFault(section.Child("fault"), agents);
  if (section.Has("restart"))
    event.restart = static_cast<int>(section.Integer("restart", 1, agents > 0 ? agents : kMaxAgents));
  return event;
}

bool StandsElsewhere(const std::string& toml) {
  const Section section = Section::FromInlineTable(toml, "event");
  return section.Has("law") || section.Has("after_loss");
}

Event EventFrom(std::int64_t tick, const std::string& toml, int agents, const std::string& where) {
  Section section = Section::FromInlineTable(toml, where);
  const bool is_phase = section.Has("law");
  section.Use(is_phase ? std::span<const Key>(kPhaseKeys) : EventKeys());
  if (!is_phase) section.Use(kAfterLossKeys);
  Event event = is_phase ? ReadPhase(section, agents) : ReadEvent(section, agents);
  if (section.Has("after_loss")) event.after_loss = section.Boolean("after_loss");
  section.Done();
  section.ThrowIfWrong();
  event.tick = tick;
  return event;
}

std::vector<Event> ReadEvents(Section& document, int agents, int rate_hz, std::int64_t ticks) {
  std::vector<Event> events;
  for (Section& section : FewTables(document, "events", LiveExperiment::kMaxEvents)) {
    const std::int64_t tick = ReadTick(section, rate_hz, ticks);
    events.push_back(ReadEvent(section, agents));
    events.back().tick = tick;
    section.Done();
  }
  return events;
}

}  // namespace mascot

#include "experiment/live_laws.h"

#include <algorithm>
#include <utility>

#include "experiment/law_tables.h"

namespace mascot {
namespace {

/// A law table, and what has been read of it.
struct LawTable {
  Section section;
  LawConfig* law = nullptr;
};

/// Reads the parameters of laws whose other keys have been read.
void ReadParams(const LawCatalog& laws, const Experiment& experiment, std::vector<LawTable>& tables) {
  for (LawTable& table : tables) {
    table.law->params = laws.Read(experiment, *table.law, table.section);
    table.section.Done();
  }
}

}  // namespace

const LawConfig& LawsAgain::Of(const AgentConfig& agent) const {
  if (const auto found = own.find(agent.id); found != own.end()) return found->second;
  return team && !owners.contains(agent.id) ? *team : agent.law;
}

void LawsAgain::Apply(Experiment& next) const {
  if (team) next.law = *team;
  for (AgentConfig& agent : next.agents) {
    const std::int64_t since = agent.law.since;
    const LawConfig& law = Of(agent);
    if (&law != &agent.law) agent.law = law;
    agent.law.since = since;
    agent.has_own_law = owners.contains(agent.id);
  }
}

LawsAgain ReadLawsAgain(const TouchedTables& touched, bool all, Section& tables, const std::vector<int>& owners,
                        const std::set<int>& alone, const LawCatalog* laws, const Experiment& now) {
  LawsAgain again;
  std::vector<LawTable> read;
  Section team = tables.Child("law"), agents = tables.Child("agents");
  const bool of_all = all || touched.of_all.contains("law");
  if (of_all) read.push_back({team, &again.team.emplace(ReadLaw(team, {}, now.size(), laws))});
  const LawConfig& team_law = again.team ? *again.team : now.law;
  const auto own = touched.own.find("law");
  bool is_wrong = team.Wrong("name") || team.Wrong("leader");
  for (std::size_t k = 0; k < owners.size(); ++k) {
    Section override = agents.Child("override", k);
    if (!override.Has("law")) continue;
    const int id = owners[k];
    again.owners.insert(id);
    const bool is_touched = all || (own != touched.own.end() && own->second.contains(k));
    if (!of_all && !is_touched) continue;
    Section section = override.Child("law");
    const bool inherits = !alone.contains(id) && (!section.Has("name") || section.Text("name") == team_law.name);
    if (!inherits && !is_touched) continue;
    if (inherits) section.InheritFrom(team, {"schedule"});
    LawConfig& law = again.own[id];
    law = ReadLaw(section, inherits ? std::optional(team) : std::nullopt, now.size(), laws);
    is_wrong = is_wrong || section.Wrong("");
    read.push_back({section, &law});
  }
  if (laws == nullptr || is_wrong) return again;
  if (!all) {
    ReadParams(*laws, now, read);  // no reader of a law asks what another law is, if their names stay
  } else {
    Experiment next = now;
    again.Apply(next);
    ReadParams(*laws, next, read);
  }
  return again;
}

}  // namespace mascot

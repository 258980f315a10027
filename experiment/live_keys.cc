#include "experiment/live_keys.h"

#include <algorithm>

namespace mascot {
namespace {

void AddLive(const std::string& prefix, std::span<const Key> rows, std::vector<LiveKey>& live) {
  for (const Key& row : rows) {
    const std::string path = prefix.empty() ? std::string(row.name) : prefix + "." + std::string(row.name);
    const bool known = std::ranges::any_of(live, [&](const LiveKey& other) { return other.path == path; });
    if (row.live && !known) live.push_back({path, row});
    if (row.kind == ValueKind::kTable) AddLive(path, row.keys, live);
  }
}

}  // namespace

std::pair<std::string_view, std::string_view> SplitKey(std::string_view path) {
  const std::size_t dot = path.find('.');
  return {path.substr(0, dot), dot == path.npos ? "" : path.substr(dot + 1)};
}

const Key* FindRow(std::span<const Key> rows, std::string_view path) {
  const auto [name, rest] = SplitKey(path);
  const auto row = std::ranges::find(rows, name, &Key::name);
  if (row == rows.end()) return nullptr;
  if (rest.empty() || row->kind == ValueKind::kAny) return &*row;
  return row->kind == ValueKind::kTable ? FindRow(row->keys, rest) : nullptr;
}

std::vector<Key> KeysOfLaw(const LawCatalog& laws, const std::string& law) {
  std::vector<Key> rows;
  rows.reserve(LawKeys().size() + laws.Parameters(law).size());
  rows.assign(LawKeys().begin(), LawKeys().end());
  for (const Key& row : laws.Parameters(law)) {  // a law may describe `leader` more closely
    const auto common = std::ranges::find(rows, row.name, &Key::name);
    if (common == rows.end())
      rows.push_back(row);
    else
      *common = row;
  }
  return rows;
}

std::vector<std::string> LawNamesIn(const Experiment& experiment) {
  std::vector<std::string> names{experiment.law.name};
  for (const AgentConfig& agent : experiment.agents)
    if (std::ranges::find(names, agent.law.name) == names.end()) names.push_back(agent.law.name);
  return names;
}

std::vector<LiveKey> LiveKeysOf(const Experiment& experiment, const LawCatalog& laws) {
  std::vector<LiveKey> live;
  for (const Key& row : ExperimentKeys()) {
    if (row.name != "law")
      AddLive("", {&row, 1}, live);
    else
      for (const std::string& law : LawNamesIn(experiment)) AddLive("law", KeysOfLaw(laws, law), live);
  }
  return live;
}

}  // namespace mascot

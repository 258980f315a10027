#include "orchestrator/sweeping/plan/law_axis.h"

#include <algorithm>
#include <set>

#include "agent/laws/laws.h"

namespace mascot {
namespace {

constexpr std::string_view kLawTable = "law.";

bool Knows(std::string_view law, std::string_view key) {
  const auto has = [&](std::span<const Key> rows) { return std::ranges::find(rows, key, &Key::name) != rows.end(); };
  return has(LawKeys()) || has(LawTable().Parameters(law));
}

/// "law.p_gain" as "p_gain", "law.params.k" as "params"; empty for what is not in [law].
std::string_view KeyInLaw(std::string_view dotted) {
  if (!dotted.starts_with(kLawTable)) return {};
  dotted.remove_prefix(kLawTable.size());
  return dotted.substr(0, dotted.find_first_of(".["));
}

/// Keys of [law] that may be left out: those in the file, and those with one value.
std::set<std::string> KeysToFit(Section& law, const SweepPlan& plan) {
  std::set<std::string> keys;
  for (const auto& [key, value] : law.InTheFile()) keys.insert(key);
  for (const std::string& key : plan.keys()) keys.emplace(KeyInLaw(key));
  for (const std::string& key : plan.varied()) keys.erase(std::string(KeyInLaw(key)));
  keys.erase("");
  return keys;
}

}  // namespace

std::string Unquoted(const std::string& value) {
  const bool quoted =
      value.size() > 1 && (value.front() == '"' || value.front() == '\'') && value.back() == value.front();
  return quoted ? value.substr(1, value.size() - 2) : value;
}

LawAxis::LawAxis(Section document, const SweepPlan& plan) {
  for (const std::string& value : plan.ValuesOf(kLawKey))  // rows may have a law more than once
    if (std::ranges::find(laws_, Unquoted(value)) == laws_.end()) laws_.push_back(Unquoted(value));
  std::erase_if(laws_, [](const std::string& law) { return std::ranges::find(LawNames(), law) == LawNames().end(); });
  if (laws_.empty() || document.Kind("law") != "table") return;
  Section table = document.Child("law");
  std::vector<std::string> known = laws_;
  if (table.Kind("name") == "string") known.push_back(std::get<std::string>(table.Free("name").data));
  std::erase_if(known, [](const std::string& law) { return std::ranges::find(LawNames(), law) == LawNames().end(); });
  const std::set<std::string> keys = KeysToFit(table, plan);
  for (const std::string& law : laws_) {
    Dropped dropped{law, {}};
    for (const std::string& key : keys)
      if (!Knows(law, key) && std::ranges::any_of(known, [&](const std::string& other) { return Knows(other, key); }))
        dropped.keys.push_back(std::string(kLawTable) + key);
    if (!dropped.keys.empty()) dropped_.push_back(std::move(dropped));
  }
}

std::vector<Override> LawAxis::Fit(const std::vector<Override>& overrides) const {
  const auto name = std::ranges::find(overrides, kLawKey, &Override::key);
  if (name == overrides.end()) return overrides;
  const auto dropped = std::ranges::find(dropped_, Unquoted(name->value), &Dropped::law);
  if (dropped == dropped_.end()) return overrides;
  std::vector<Override> fitting;
  for (const std::string& key : dropped->keys) fitting.push_back({.key = key, .value = "", .removes = true});
  for (const Override& override : overrides) {
    const std::string table_key = std::string(kLawTable).append(KeyInLaw(override.key));
    if (std::ranges::find(dropped->keys, table_key) == dropped->keys.end()) fitting.push_back(override);
  }
  return fitting;
}

std::vector<std::string> LawAxis::Notes() const {
  std::vector<std::string> notes;
  for (const Dropped& dropped : dropped_) {
    std::string keys;
    for (const std::string& key : dropped.keys) keys += (keys.empty() ? "" : ", ") + key;
    notes.push_back(std::string(kLawKey) + " = " + dropped.law + ": without " + keys + ", which it does not have");
  }
  return notes;
}

}  // namespace mascot

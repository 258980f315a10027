// How two sweeps differ, for a user who goes on with the table of one by the command of the other.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>
#include <set>

#include "base/utf8.h"
#include "experiment/toml/section.h"
#include "orchestrator/sweeping/plan/values.h"
#include "orchestrator/sweeping/table/sweep_identity.h"

namespace mascot {
namespace {

constexpr std::size_t kMaxKeys = 3;          // named, of those that differ
constexpr std::size_t kLongestSetting = 60;  // of the characters of a value

/// A value as it is shown; "nothing" stands for what is not set.
std::string ShownSetting(const std::string& setting) {
  if (setting.empty()) return "nothing";
  return setting.size() <= kLongestSetting ? setting : std::string(CutUtf8(setting, kLongestSetting)) + "...";
}

/// Where the first part of two lists begins that differs: parts have ", " between. If one list is the beginning of the
/// other, it is its last part.
std::size_t FirstDifference(const std::string& there, const std::string& here) {
  const auto same = std::ranges::mismatch(there, here).in1 - there.begin();
  const auto before = there.substr(0, static_cast<std::size_t>(same)).rfind(", ");
  return before == std::string::npos ? 0 : before + 2;
}

/// "NAME: 0.1, 0.5 there and 0.1, 0.7 here". Long lists that begin alike are shown from where they differ.
std::string BothText(const std::string& name, const std::string& there, const std::string& here) {
  const std::size_t begin = ShownSetting(there) == ShownSetting(here) ? FirstDifference(there, here) : 0;
  const auto shown = [&](const std::string& setting) {
    return (begin > 0 ? "..., " : "") + ShownSetting(setting.substr(begin));
  };
  return fmt::format("{}: {} there and {} here", name, shown(there), shown(here));
}

/// The option that sets a key.
std::string OptionOf(const SweepPlan::Words& words, const std::string& key) {
  const auto sets = [&](const std::string& word) { return word.starts_with(key + "="); };
  if (std::ranges::any_of(words.sets, sets)) return "--set " + key;
  return std::ranges::any_of(words.randoms, sets) ? "--random " + key : "--seeds";
}

void AddPlans(const SweepPlan::Words& there_words, const SweepPlan::Words& here_words,
              std::vector<std::string>& parts) {
  const SweepPlan there(there_words), here(here_words);
  std::vector<std::string> keys = here.keys();
  for (const std::string& key : there.keys())
    if (std::ranges::find(keys, key) == keys.end()) keys.push_back(key);
  const std::size_t before = parts.size();
  for (const std::string& key : keys) {
    const bool is_here = !here.SettingOf(key).empty();
    if (here.SettingOf(key) != there.SettingOf(key))
      parts.push_back(
          BothText(OptionOf(is_here ? here_words : there_words, key), there.SettingOf(key), here.SettingOf(key)));
  }
  const auto combined = [](const SweepPlan& plan) { return plan.IsZipped() ? "row by row" : "each with each"; };
  if (parts.size() == before && there.IsZipped() != here.IsZipped())
    parts.push_back(BothText("how values are combined", combined(there), combined(here)));
  if (parts.size() == before && there.keys() != here.keys())
    parts.push_back(BothText("the order of what is set", fmt::format("{}", fmt::join(there.keys(), ", ")),
                             fmt::format("{}", fmt::join(here.keys(), ", "))));
}

/// The keys that differ in two experiments, with their values, after `whose`.
void AddKeys(const std::string& whose, const std::string& there_text, const std::string& here_text,
             std::vector<std::string>& parts) {
  if (there_text == here_text) return;
  const auto keys_of = [](const std::string& text) { return PlainKeys(Section::FromText(text, "").InTheFile()); };
  std::map<std::string, std::string> there, here;
  try {
    there = keys_of(there_text);
    here = keys_of(here_text);
  } catch (const ConfigError&) {  // one of them is no TOML: then only the text differs
  }
  std::set<std::string> all, differ;
  for (const auto* keys : {&there, &here})
    for (const auto& [key, value] : *keys) all.insert(key);
  for (const std::string& key : all)
    if (there[key] != here[key]) differ.insert(key);
  std::size_t named = 0;
  for (const std::string& key : differ)
    if (named++ < kMaxKeys) parts.push_back(BothText(fmt::format("{} of {}", key, whose), there[key], here[key]));
  if (differ.size() > kMaxKeys) parts.push_back(fmt::format("{} more keys of {}", differ.size() - kMaxKeys, whose));
  if (differ.empty()) parts.push_back(fmt::format("the text of {}, though in no value", whose));
}

}  // namespace

std::string SweepIdentity::DifferenceFrom(const std::string& theirs) const {
  const std::optional<SweepIdentity> there = FromText(theirs);
  if (!there) return "the form of its .plan, which this build does not read";
  std::vector<std::string> parts;
  if (there->build != build) parts.push_back(BothText("the build", there->build, build));
  if (there->search != search) parts.push_back(BothText("the search", there->search, search));
  const bool is_same_search = !search.empty() && there->search == search;
  const bool grows = is_same_search && SweepPlan(words).BeginsWith(SweepPlan(there->words));
  if (there->search == search && !grows) AddPlans(there->words, words, parts);
  AddKeys("the experiment file", there->experiment, experiment, parts);
  if (there->metric_file != metric_file) parts.emplace_back("the file of --metric");
  if (parts.empty()) AddKeys("the first run", there->first_run, first_run, parts);
  SweepIdentity same = *this;  // but for how it was typed
  same.words = there->words;
  if (grows) same.laws = there->laws;
  if (parts.empty() && same.Text() != there->Text()) parts.emplace_back("the laws and metrics of its runs");
  return fmt::format("{}", fmt::join(parts, "; "));
}

}  // namespace mascot

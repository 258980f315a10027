#include "orchestrator/sweeping/plan/labels.h"

#include <algorithm>
#include <span>

#include "agent/laws/laws.h"
#include "experiment/toml/key.h"

namespace mascot {
namespace {

/// Units of columns whose names do not end in them.
constexpr NameAndUnit kUnits[] = {{"control.effort", "m^2/s^3"}, {"links.bytes", "B"}};

/// As pictures show it: "1/s^2" as "1/s²", "deg" as "°".
std::string Symbol(std::string_view unit) {
  if (unit == "deg") return "°";
  std::string text(unit);
  for (const auto& [caret, raised] : {std::pair("^2", "²"), std::pair("^3", "³")})
    for (auto place = text.find(caret); place != text.npos; place = text.find(caret)) text.replace(place, 2, raised);
  return text;
}

std::string WithUnit(std::string text, std::string_view unit) {
  return unit.empty() ? text : text.append(" (").append(Symbol(unit)).append(")");
}

/// The units of the rows of a dotted key, one for each law that gives it another.
std::vector<std::string_view> UnitsOf(std::string_view key, std::span<const Key> rows, bool in_law,
                                      const std::vector<std::string>& laws) {
  const std::string_view step = key.substr(0, key.find('.'));
  const std::string_view name = step.substr(0, step.find('['));
  key.remove_prefix(std::min(key.size(), step.size() + 1));
  std::vector<std::string_view> units;
  const auto look = [&](std::span<const Key> among) {
    const auto row = std::ranges::find(among, name, &Key::name);
    if (row == among.end()) return;
    if (!key.empty()) units = UnitsOf(key, row->keys, name == "law", laws);
    if (key.empty() && !row->unit.empty() && std::ranges::find(units, row->unit) == units.end())
      units.push_back(row->unit);
  };
  look(rows);
  for (const std::string& law : laws)
    if (in_law) look(LawTable().Parameters(law));
  return units;
}

}  // namespace

std::string LabelOfColumn(std::string_view column) {
  std::string_view rest = column, prefix;
  if (rest.starts_with("consensus.")) rest.remove_prefix(std::string_view("consensus.").size());
  if (rest.starts_with("laws.")) {  // laws.NAME.FIGURE
    rest.remove_prefix(std::string_view("laws.").size());
    prefix = rest.substr(0, rest.find('.'));
    rest.remove_prefix(std::min(rest.size(), prefix.size() + 1));
  }
  std::string_view axis;
  for (const std::string_view end : {".x", ".y", ".z"})
    if (rest.ends_with(end)) axis = end.substr(1);
  if (!axis.empty()) rest.remove_suffix(2);
  NameAndUnit named = SplitUnit(rest);
  for (const NameAndUnit& known : kUnits)
    if (column == known.name) named.unit = known.unit;
  std::string words(named.name);
  std::replace_if(
      words.begin(), words.end(), [](char c) { return c == '_' || c == '.'; }, ' ');
  if (!axis.empty()) words.append(" ").append(axis);
  return WithUnit(prefix.empty() ? words : std::string(prefix) + ": " + words, named.unit);
}

std::string LabelOfMetric(const PythonMetric& metric) {
  if (metric.unit.empty()) return LabelOfColumn(metric.name);
  std::string words(SplitUnit(metric.name).name);
  std::ranges::replace(words, '_', ' ');
  return WithUnit(words, metric.unit);
}

std::string LabelOfKey(std::string_view key, const std::vector<std::string>& laws) {
  const NameAndUnit named = SplitUnit(key);
  std::string units;
  for (const std::string_view unit : UnitsOf(key, ExperimentKeys(), false, laws))
    units.append(units.empty() ? "" : " or ").append(unit);
  return WithUnit(std::string(named.name), units.empty() ? named.unit : units);
}

}  // namespace mascot

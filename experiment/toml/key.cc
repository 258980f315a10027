#include "experiment/toml/key.h"

namespace mascot {
namespace {

/// Units as names end in them; longer endings first.
constexpr NameAndUnit kEndings[] = {
    {"_m_per_s2", "m/s^2"},
    {"_rad_per_s", "rad/s"},
    {"_m2_per_s3", "m^2/s^3"},
    {"_m_per_s", "m/s"},
    {"_per_s", "1/s"},
    {"_rad", "rad"},
    {"_deg", "deg"},
    {"_hz", "Hz"},
    {"_kg", "kg"},
    {"_N", "N"},
    {"_m2", "m^2"},
    {"_m", "m"},
    {"_s", "s"},
};

std::string ValueText(ValueKind kind, const Key& key) {
  std::string names;
  switch (kind) {
    case ValueKind::kNone:
      return "";
    case ValueKind::kNumber:
      return key.range.Text();
    case ValueKind::kInteger:
      return std::to_string(key.min_integer) + ".." + std::to_string(key.max_integer);
    case ValueKind::kBoolean:
      return "true | false";
    case ValueKind::kText:
      return "text";
    case ValueKind::kOneOf:
      for (const std::string_view name : key.names) names.append(names.empty() ? "" : " | ").append(name);
      return names;
    case ValueKind::kTexts:
      return "list of texts";
    case ValueKind::kVector3:
      return "[x, y, z] in " + key.range.Text();
    case ValueKind::kNumbers:
      return "list in " + key.range.Text();
    case ValueKind::kRows:
      return "list of lists in " + key.range.Text();
    case ValueKind::kPoints:
      return "list of [x, y, z] in " + key.range.Text();
    case ValueKind::kPointLists:
      return "list of lists of [x, y, z] in " + key.range.Text();
    case ValueKind::kTable:
      return "table";
    case ValueKind::kTables:
      return "tables";
    case ValueKind::kAny:
      return "any table";
  }
  return "";
}

}  // namespace

NameAndUnit SplitUnit(std::string_view name) {
  for (const NameAndUnit& ending : kEndings)
    if (name.ends_with(ending.name)) return {name.substr(0, name.size() - ending.name.size()), ending.unit};
  return {name, ""};
}

std::string_view UnitOf(const Key& key) { return key.unit.empty() ? SplitUnit(key.name).unit : key.unit; }

std::string ValueText(const Key& key) {
  std::string text = ValueText(key.kind, key);
  if (key.or_kind != ValueKind::kNone) text += " or " + ValueText(key.or_kind, key);
  return key.unit.empty() ? text : text.append(", ").append(key.unit);
}

}  // namespace mascot

#include "experiment/toml/key.h"

namespace mascot {
namespace {

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

std::string ValueText(const Key& key) {
  std::string text = ValueText(key.kind, key);
  if (key.or_kind != ValueKind::kNone) text += " or " + ValueText(key.or_kind, key);
  return key.unit.empty() ? text : text.append(", ").append(key.unit);
}

}  // namespace mascot

#include "orchestrator/sweeping/plan/values.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "agent/laws/laws.h"

namespace mascot {
namespace {

/// Where a value stands, as the rows of keys describe it.
struct Where {
  std::vector<std::span<const Key>> tables = {};  ///< rows of the keys inside it
  bool holds_numbers = false;                     ///< it is a number, or a list of numbers, and no integer
};

bool HoldsNumbers(ValueKind kind) {
  return kind == ValueKind::kNumber || kind == ValueKind::kVector3 || kind == ValueKind::kNumbers ||
         kind == ValueKind::kRows || kind == ValueKind::kPoints || kind == ValueKind::kPointLists;
}

/// Where the value of `key` stands, a key of a table that stands at `outer`.
Where Inside(const Where& outer, std::string_view key) {
  Where inner;
  for (const std::span<const Key> rows : outer.tables) {
    const auto row = std::ranges::find(rows, key, &Key::name);
    if (row == rows.end()) continue;
    inner.holds_numbers = inner.holds_numbers || HoldsNumbers(row->kind) || HoldsNumbers(row->or_kind);
    inner.tables.push_back(row->keys);
  }
  if (key != "law") return inner;
  for (const std::string_view law : LawNames()) inner.tables.push_back(LawTable().Parameters(law));
  return inner;
}

/// Where the value of a dotted key stands.
Where WhereIs(std::string_view key) {
  Where where{.tables = {ExperimentKeys()}};
  while (!key.empty()) {
    const std::string_view step = key.substr(0, key.find('.'));
    key.remove_prefix(std::min(key.size(), step.size() + 1));
    where = Inside(where, step.substr(0, step.find('[')));
  }
  return where;
}

std::string Plain(double number) {
  constexpr double kExactIntegers = 1e15;
  if (std::abs(number) < kExactIntegers && number == std::trunc(number))
    return std::to_string(static_cast<std::int64_t>(number));
  return ShortestFloat(number);
}

std::string PlainName(const std::string& key) {
  const bool is_bare = !key.empty() && std::ranges::all_of(key, [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
  });
  return is_bare ? key : ToToml({key});
}

std::string Plain(const Where& where, const Value& value) {
  if (const auto* list = std::get_if<Value::List>(&value.data)) {
    std::vector<std::string> items;
    for (const Value& item : *list) items.push_back(Plain(where, item));
    return fmt::format("[{}]", fmt::join(items, ", "));
  }
  if (const auto* table = std::get_if<Value::Table>(&value.data)) {
    std::vector<std::string> items;
    for (const auto& [key, item] : *table) items.push_back(PlainName(key) + " = " + Plain(Inside(where, key), item));
    return fmt::format("{{{}}}", fmt::join(items, ", "));
  }
  const bool is_number = std::holds_alternative<double>(value.data) || std::holds_alternative<std::int64_t>(value.data);
  return where.holds_numbers && is_number ? Plain(value.Number()) : ToToml(value);
}

/// The value that --set takes `typed` for; nothing if it is none, or a date.
std::optional<Value> ValueOf(const std::string& typed) {
  constexpr const char* kKey = "value";
  try {
    const Override override{.key = kKey, .value = typed};
    Section section = Section::FromText("", "", {&override, 1});
    if (section.Kind(kKey) == "date or time") return std::nullopt;
    return section.Free(kKey);
  } catch (const ConfigError&) {
    return std::nullopt;
  }
}

void AddPlainKeys(const Value::Table& table, const Where& where, const std::string& prefix,
                  std::map<std::string, std::string>& keys) {
  for (const auto& [key, value] : table) {
    const auto* inner = std::get_if<Value::Table>(&value.data);
    if (inner != nullptr && !inner->empty())
      AddPlainKeys(*inner, Inside(where, key), prefix + key + ".", keys);
    else
      keys[prefix + key] = Plain(Inside(where, key), value);
  }
}

}  // namespace

std::string PlainToml(std::string_view key, const Value& value) { return Plain(WhereIs(key), value); }

std::string PlainValue(std::string_view key, const std::string& typed) {
  const std::optional<Value> value = ValueOf(typed);
  if (!value) return typed;
  if (const auto* text = std::get_if<std::string>(&value->data); text != nullptr && ValueOf(*text) == value)
    return *text;
  return PlainToml(key, *value);
}

std::vector<std::string> PlainNumbers(std::string_view key, const std::vector<double>& numbers) {
  const bool holds_numbers = WhereIs(key).holds_numbers;
  std::vector<std::string> texts;
  for (const double number : numbers) texts.push_back(holds_numbers ? Plain(number) : ShortestFloat(number));
  return texts;
}

std::map<std::string, std::string> PlainKeys(const Value::Table& document) {
  std::map<std::string, std::string> keys;
  AddPlainKeys(document, {.tables = {ExperimentKeys()}}, "", keys);
  return keys;
}

}  // namespace mascot

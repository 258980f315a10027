#include <sstream>
#include <utility>

#include "experiment/toml/section_internal.h"

namespace mascot {

Value ToValue(const toml::node& node) {
  if (const auto boolean = node.value_exact<bool>()) return {*boolean};
  if (const auto integer = node.value_exact<std::int64_t>()) return {*integer};
  if (const auto number = node.value_exact<double>()) return {*number};
  if (const auto text = node.value_exact<std::string>()) return {*text};
  if (const toml::array* array = node.as_array()) {
    Value::List list;
    for (const toml::node& element : *array) list.push_back(ToValue(element));
    return {std::move(list)};
  }
  if (const toml::table* table = node.as_table()) {
    Value::Table values;
    for (const auto& [key, element] : *table) values.emplace(key.str(), ToValue(element));
    return {std::move(values)};
  }
  std::ostringstream text;  // a date or a time
  node.visit([&](const auto& typed) { text << typed; });
  return {text.str()};
}

namespace {

toml::array ToArray(const Value::List& list);

/// Calls `add` with `value` as toml++ takes it.
template <class Add>
void AddValue(const Value& value, Add add) {
  if (const auto* list = std::get_if<Value::List>(&value.data))
    add(ToArray(*list));
  else if (const auto* table = std::get_if<Value::Table>(&value.data))
    add(ToTable(*table));
  else if (const auto* text = std::get_if<std::string>(&value.data))
    add(*text);
  else if (const auto* number = std::get_if<double>(&value.data))
    add(*number);
  else if (const auto* integer = std::get_if<std::int64_t>(&value.data))
    add(*integer);
  else
    add(std::get<bool>(value.data));
}

toml::array ToArray(const Value::List& list) {
  toml::array array;
  array.reserve(list.size());
  for (const Value& item : list) AddValue(item, [&](auto&& one) { array.push_back(std::forward<decltype(one)>(one)); });
  return array;
}

}  // namespace

toml::table ToTable(const Value::Table& table) {
  toml::table values;
  for (const auto& [key, item] : table)
    AddValue(item, [&, &name = key](auto&& one) { values.insert(name, std::forward<decltype(one)>(one)); });
  return values;
}

std::string ToToml(const Value& value) {
  struct Writer {
    std::string operator()(bool boolean) const { return boolean ? "true" : "false"; }
    std::string operator()(std::int64_t integer) const { return std::to_string(integer); }
    std::string operator()(double number) const { return ShortestFloat(number); }
    std::string operator()(const std::string& text) const { return QuotedToml(text); }
    std::string operator()(const Value::List& list) const {
      std::vector<std::string> items;
      for (const Value& item : list) items.push_back(ToToml(item));
      return "[" + Joined(items) + "]";
    }
    std::string operator()(const Value::Table& table) const {
      std::vector<std::string> items;
      for (const auto& [key, item] : table) items.push_back(QuotedToml(key) + " = " + ToToml(item));
      return items.empty() ? "{}" : "{ " + Joined(items) + " }";
    }
  };
  return std::visit(Writer{}, value.data);
}

}  // namespace mascot

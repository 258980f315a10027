#pragma once

#include <charconv>
#include <cstdint>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "base/value.h"

namespace mascot {

/// Reads [law.params] strictly: for a value that is not as expected it throws std::invalid_argument("params.gain:
/// expected a number in [0, 10], got 'fast'"), which MASCOT reports with file, line and column. A key of the table that
/// the law has never asked for is reported, too. A key without fallback is required. All in this header, because a
/// plugin links nothing of MASCOT.
class PluginParams {
 public:
  explicit PluginParams(Value table) : table_(std::move(table)) {}

  /// A finite number from `min` to `max`; an integer is taken for a number.
  double Number(const std::string& key, double min, double max, std::optional<double> fallback = {}) {
    const Value* value = Find(key);
    if (value == nullptr && fallback) return *fallback;
    const std::optional<double> number = value != nullptr ? AsNumber(*value) : std::nullopt;
    if (!number || !(*number >= min && *number <= max))
      Fail(key, "expected a number in [" + Text(min) + ", " + Text(max) + "], got " + Got(value));
    return *number;
  }
  std::int64_t Integer(const std::string& key, std::int64_t min, std::int64_t max,
                       std::optional<std::int64_t> fallback = {}) {
    const Value* value = Find(key);
    if (value == nullptr && fallback) return *fallback;
    const auto* integer = value != nullptr ? std::get_if<std::int64_t>(&value->data) : nullptr;
    if (integer == nullptr || *integer < min || *integer > max)
      Fail(key, "expected an integer in [" + std::to_string(min) + ", " + std::to_string(max) + "], got " + Got(value));
    return *integer;
  }
  bool Boolean(const std::string& key, std::optional<bool> fallback = {}) {
    return Exactly<bool>(key, "true or false", fallback);
  }
  std::string String(const std::string& key, std::optional<std::string> fallback = {}) {
    return Exactly<std::string>(key, "a string", std::move(fallback));
  }
  /// A list of numbers from `min` to `max`; empty if absent.
  std::vector<double> Numbers(const std::string& key, double min, double max) {
    const Value* value = Find(key);
    if (value == nullptr) return {};
    const auto* list = std::get_if<Value::List>(&value->data);
    if (list == nullptr) Fail(key, "expected a list of numbers, got " + Got(value));
    std::vector<double> numbers;
    for (const Value& item : *list) {
      const std::optional<double> number = AsNumber(item);
      if (!number || !(*number >= min && *number <= max))
        Fail(key + "[" + std::to_string(numbers.size()) + "]",
             "expected a number in [" + Text(min) + ", " + Text(max) + "], got " + Got(&item));
      numbers.push_back(*number);
    }
    return numbers;
  }
  /// The value of `key` as it is, for what the readers above cannot read; null if absent.
  const Value* Find(const std::string& key) {
    asked_.insert(key);
    return table_.Find(key);
  }
  /// Throws std::invalid_argument for `key`: `message` = "expected ..., got ...".
  [[noreturn]] static void Fail(const std::string& key, const std::string& message) {
    throw std::invalid_argument("params." + key + ": " + message);
  }

  /// The keys that the law has asked for.
  const std::set<std::string>& asked() const { return asked_; }

 private:
  template <class T>
  T Exactly(const std::string& key, const std::string& expected, std::optional<T> fallback) {
    const Value* value = Find(key);
    if (value == nullptr && fallback) return *std::move(fallback);
    const T* exact = value != nullptr ? std::get_if<T>(&value->data) : nullptr;
    if (exact == nullptr) Fail(key, "expected " + expected + ", got " + Got(value));
    return *exact;
  }

  static std::optional<double> AsNumber(const Value& value) {
    const bool is_number =
        std::holds_alternative<std::int64_t>(value.data) || std::holds_alternative<double>(value.data);
    return is_number ? std::optional(value.Number()) : std::nullopt;
  }
  /// The shortest text that reads back as `number`.
  static std::string Text(double number) {
    char text[32];
    return {text, std::to_chars(text, text + sizeof text, number).ptr};
  }
  /// What the user wrote, for messages.
  static std::string Got(const Value* value) {
    if (value == nullptr) return "nothing";
    struct Words {
      std::string operator()(bool boolean) const { return boolean ? "true" : "false"; }
      std::string operator()(std::int64_t integer) const { return std::to_string(integer); }
      std::string operator()(double number) const { return Text(number); }
      std::string operator()(const std::string& text) const { return "'" + text + "'"; }
      std::string operator()(const Value::List& list) const { return "a list of " + std::to_string(list.size()); }
      std::string operator()(const Value::Table&) const { return "a table"; }
    };
    return std::visit(Words{}, value->data);
  }

  Value table_;
  std::set<std::string> asked_;
};

}  // namespace mascot

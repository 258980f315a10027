#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <variant>
#include <vector>

namespace mascot {

/// A TOML value of any kind, for tables whose keys the user chooses: [law.params].
struct Value {
  using List = std::vector<Value>;
  using Table = std::map<std::string, Value>;
  std::variant<bool, std::int64_t, double, std::string, List, Table> data = Table{};

  bool operator==(const Value&) const = default;

  /// A number, whether written as integer or not; throws std::bad_variant_access for anything else.
  double Number() const {
    const auto* integer = std::get_if<std::int64_t>(&data);
    return integer != nullptr ? static_cast<double>(*integer) : std::get<double>(data);
  }
  /// The value of `key` in a table, or null if there is none.
  const Value* Find(const std::string& key) const {
    const auto* table = std::get_if<Table>(&data);
    if (table == nullptr) return nullptr;
    const auto found = table->find(key);
    return found == table->end() ? nullptr : &found->second;
  }
};

}  // namespace mascot

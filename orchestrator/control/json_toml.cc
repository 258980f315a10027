#include "orchestrator/control/json_toml.h"

#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

namespace mascot {

Value ValueOf(const nlohmann::ordered_json& json) {
  using Kind = nlohmann::ordered_json::value_t;
  switch (json.type()) {
    case Kind::boolean:
      return {json.get<bool>()};
    case Kind::number_integer:
      return {json.get<std::int64_t>()};
    case Kind::number_unsigned:
      if (json.get<std::uint64_t>() > std::uint64_t{std::numeric_limits<std::int64_t>::max()})
        return {json.get<double>()};
      return {json.get<std::int64_t>()};
    case Kind::number_float:
      return {json.get<double>()};
    case Kind::string:
      return {json.get<std::string>()};
    case Kind::array: {
      Value::List list;
      for (const auto& item : json) list.push_back(ValueOf(item));
      return {std::move(list)};
    }
    case Kind::object: {
      Value::Table table;
      for (const auto& [key, item] : json.items()) table[key] = ValueOf(item);
      return {std::move(table)};
    }
    default:
      throw std::invalid_argument("expected a value, got null");
  }
}

}  // namespace mascot

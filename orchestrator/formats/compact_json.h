#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace mascot {

/// JSON in one line. Text in it that is not UTF-8, such as the name of a file, is replaced, not refused.
inline std::string CompactJson(const nlohmann::ordered_json& json) {
  return json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace mascot

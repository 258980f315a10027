#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "base/utf8.h"
#include "experiment/toml/key.h"
#include "orchestrator/formats/outside_json.h"

namespace mascot {

/// JSON whose objects keep the insertion order of their keys.
using Json = nlohmann::ordered_json;

/// `json` as it is printed and written. Text that is no UTF-8, such as the name of a file, is replaced, not refused;
/// characters that are not fit for a terminal are escaped, so that it may be shown there.
inline std::string JsonText(const Json& json) {
  return Plain(json.dump(2, ' ', false, Json::error_handler_t::replace)) + "\n";
}

inline Json VectorJson(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

template <class Value>
Json OrNull(const std::optional<Value>& value) {
  return value ? Json(*value) : Json(nullptr);
}
inline Json OrNull(const std::optional<Eigen::Vector3d>& v) { return v ? VectorJson(*v) : Json(nullptr); }

/// The default of a key, null if it has none. Defaults are TOML text that is also valid JSON.
inline Json DefaultJson(const Key& key) { return key.fallback.empty() ? Json(nullptr) : ReadJson<Json>(key.fallback); }

}  // namespace mascot

#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <optional>

#include "experiment/toml/key.h"

namespace mascot {

/// JSON whose objects keep the insertion order of their keys.
using Json = nlohmann::ordered_json;

inline Json VectorJson(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

template <class Value>
Json OrNull(const std::optional<Value>& value) {
  return value ? Json(*value) : Json(nullptr);
}
inline Json OrNull(const std::optional<Eigen::Vector3d>& v) { return v ? VectorJson(*v) : Json(nullptr); }

/// The default of a key, null if it has none. Defaults are TOML text that is also valid JSON.
inline Json DefaultJson(const Key& key) { return key.fallback.empty() ? Json(nullptr) : Json::parse(key.fallback); }

}  // namespace mascot

#pragma once

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <optional>

#include "experiment/toml/key.h"

namespace mascot {

/// Keys in the order in which they are put in.
using Json = nlohmann::ordered_json;

inline Json VectorJson(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

template <class Value>
Json OrNull(const std::optional<Value>& value) {
  return value ? Json(*value) : Json(nullptr);
}
inline Json OrNull(const std::optional<Eigen::Vector3d>& v) { return v ? VectorJson(*v) : Json(nullptr); }

/// A key's default, whose TOML is JSON, too; null if it has none.
inline Json DefaultJson(const Key& key) { return key.fallback.empty() ? Json(nullptr) : Json::parse(key.fallback); }

}  // namespace mascot

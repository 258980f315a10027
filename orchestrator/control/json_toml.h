#pragma once

#include <nlohmann/json.hpp>

#include "base/value.h"

namespace mascot {

/// A value in JSON as one in TOML. TOML has no null: throws std::invalid_argument for one, wherever it stands.
Value ValueOf(const nlohmann::ordered_json& json);

}  // namespace mascot

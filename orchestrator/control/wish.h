#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "orchestrator/control/run_control.h"

namespace mascot {

// Wishes as JSON, as the page and `orchestrator send` write them: {"ask": "pause"}, {"ask": "event", "toml": "..."}.

/// Throws std::invalid_argument with what was expected.
Wish ReadWish(const nlohmann::ordered_json& request);
/// The inverse of ReadWish().
nlohmann::ordered_json WishJson(const Wish& wish);
/// The event that gives a key a value.
Wish SetKey(const std::string& key, const nlohmann::ordered_json& value);

}  // namespace mascot

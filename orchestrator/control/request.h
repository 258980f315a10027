#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "orchestrator/control/run_control.h"

namespace mascot {

// Requests as JSON, as the page and `orchestrator send` write them: {"ask": "pause"}, {"ask": "event", "toml": "..."}.

/// The request that `json` holds. Throws std::invalid_argument with what was expected. Numbers are not checked further.
Request ReadRequest(const nlohmann::ordered_json& json);
/// The inverse of ReadRequest().
nlohmann::ordered_json RequestJson(const Request& request);
/// The request for an event that sets a live key to a value.
Request SetKey(const std::string& key, const nlohmann::ordered_json& value);

}  // namespace mascot

#include "agent/laws/parts/user_params.h"

#include <algorithm>

namespace mascot {

void FailUnknownParams(Section& law, const Value& params, std::span<const std::string_view> known) {
  for (const auto& [key, value] : std::get<Value::Table>(params.data)) {
    if (std::ranges::find(known, key) != known.end()) continue;
    const auto nearest = DidYouMean(key, known);
    law.FailInside("params", key, "unknown key" + (nearest ? " (did you mean \"" + *nearest + "\"?)" : std::string()));
  }
}

}  // namespace mascot

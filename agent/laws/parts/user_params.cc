#include "agent/laws/parts/user_params.h"

#include <algorithm>

namespace mascot {

bool HasParamsTable(Section& law) {
  if (!law.Has("params") || law.Kind("params") == "table") return true;
  law.Fail("params", "expected a table, got a " + law.Kind("params"));
  return false;
}

Value ReadUserParams(Section& law) { return HasParamsTable(law) ? law.Free("params") : Value(); }

void FailUnknownParams(Section& law, const Value& params, std::span<const std::string_view> known) {
  for (const auto& [key, value] : std::get<Value::Table>(params.data)) {
    if (std::ranges::find(known, key) != known.end()) continue;
    const auto nearest = DidYouMean(key, known);
    law.FailInside("params", key, "unknown key" + (nearest ? " (did you mean \"" + *nearest + "\"?)" : std::string()));
  }
}

}  // namespace mascot

#pragma once

#include <span>
#include <string_view>

#include "experiment/toml/section.h"

namespace mascot {

// The table [law.params] that the user's own law gets.

/// Whether it is a table, or left out. Notes a mistake otherwise.
bool HasParamsTable(Section& law);
/// The table; an empty one after a mistake, which it notes, or if it is left out.
Value ReadUserParams(Section& law);
/// Notes the keys of `params`, that table, which the law does not take: all but `known`.
void FailUnknownParams(Section& law, const Value& params, std::span<const std::string_view> known);

}  // namespace mascot

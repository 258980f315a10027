#pragma once

#include <span>
#include <string_view>

#include "experiment/toml/section.h"

namespace mascot {

/// Notes the keys of `params`, the table [law.params] that the user's own law gets, that the law does not take: all but
/// `known`.
void FailUnknownParams(Section& law, const Value& params, std::span<const std::string_view> known);

}  // namespace mascot

#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "experiment/toml/section.h"

namespace mascot {

/// For options that take one of a few names: says which, where CLI::IsMember says "xls not in {npz,csv,mat}".
inline CLI::Validator OneOf(std::vector<std::string> names) {
  const std::string shown = fmt::format("{{{}}}", fmt::join(names, ","));
  return CLI::Validator(
      [names = std::move(names)](const std::string& given) {
        if (std::ranges::find(names, given) != names.end()) return std::string();
        return fmt::format("expected one of {}, got {}", fmt::join(names, ", "), given);
      },
      shown);
}

/// For names that are looked up later: throws ConfigError, "laws: expected the name of a law, got 'x' (did you mean
/// ...?)", if `given` is none of `names`. `what`: "a law".
inline void RequireOneOf(std::string_view verb, std::string_view what, std::string_view given,
                         std::span<const std::string_view> names) {
  if (std::ranges::find(names, given) != names.end()) return;
  const auto nearest = DidYouMean(given, names);
  throw ConfigError({fmt::format("{}: expected the name of {}, got '{}'{}", verb, what, given,
                                 nearest ? fmt::format(" (did you mean \"{}\"?)", *nearest) : "")});
}

}  // namespace mascot

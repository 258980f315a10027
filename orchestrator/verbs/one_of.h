#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

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

}  // namespace mascot

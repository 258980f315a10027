#pragma once

#include <gtest/gtest.h>

#include <cctype>
#include <string>

namespace mascot::test {

/// Converts `words` to the last part of a test name, which may contain letters, digits and underscores only: `law.axes
/// to xyz` becomes `law_axes_to_xyz`. GoogleTest refuses to start if two names are equal.
inline std::string ParamName(const std::string& words) {
  std::string name;
  for (const char c : words) {
    if (std::isalnum(static_cast<unsigned char>(c))) {
      name += c;
    } else if (!name.empty() && name.back() != '_') {
      name += '_';
    }
  }
  return name;
}

/// Name generator for test parameters whose printed text describes the test.
template <class Param>
std::string NamedAsPrinted(const testing::TestParamInfo<Param>& row) {
  return ParamName(testing::PrintToString(row.param));
}

}  // namespace mascot::test

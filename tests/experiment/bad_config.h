// The corpus tests/bad_configs: each FILE.toml has its error text in FILE.expected.
#pragma once

#include <string>

#include "agent/laws/laws.h"

namespace mascot::test {

inline void ReplaceAll(std::string& text, const std::string& part, const std::string& by) {
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + by.size()))
    text.replace(at, part.size(), by);
}

/// The error text as in an .expected file: FILE stands for the path, LAWS for the names of all laws.
inline std::string Anonymous(std::string refusal, const std::string& path) {
  std::string laws;
  for (const std::string_view law : LawNames()) laws += (laws.empty() ? "" : ", ") + std::string(law);
  ReplaceAll(refusal, path, "FILE");
  ReplaceAll(refusal, laws, "LAWS");
  return refusal;
}

}  // namespace mascot::test

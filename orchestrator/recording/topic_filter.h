#pragma once

#include <fnmatch.h>

#include <algorithm>
#include <string>
#include <vector>

#include "idl/topics.h"

namespace mascot {

/// Whether `topic` matches one of `patterns` (record.topics, shell patterns as in fnmatch) and is thus recorded.
inline bool IsRecorded(const std::vector<std::string>& patterns, const Topic& topic) {
  return std::any_of(patterns.begin(), patterns.end(), [name = topic.Name()](const std::string& pattern) {
    return ::fnmatch(pattern.c_str(), name.c_str(), 0) == 0;
  });
}

}  // namespace mascot

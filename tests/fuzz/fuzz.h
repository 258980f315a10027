// What the fuzzers share. Each is a program of libFuzzer: tests/fuzz/README.md.
#pragma once

#include <fuzzer/FuzzedDataProvider.h>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace mascot {

/// Ends the fuzzer with a finding unless `holds`.
inline void Require(bool holds, const std::string& otherwise) {
  if (holds) return;
  std::fprintf(stderr, "%s\n", otherwise.c_str());
  std::abort();
}

}  // namespace mascot

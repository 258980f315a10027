// Calls verbs of the orchestrator in the process of the test.
#pragma once

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "orchestrator/verbs/verb.h"

namespace mascot {

struct Said {
  int exit_code = -1;
  std::string out, err;
};

/// Calls a verb as `orchestrator` does: exceptions become errors and exit codes.
inline Said Call(std::function<int()> (*set_up)(CLI::App& command), const std::vector<std::string>& arguments) {
  CLI::App app;
  const std::function<int()> run = set_up(app);
  app.parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  Said said;
  said.exit_code = ExitCodeOf(run);
  said.out = testing::internal::GetCapturedStdout();
  said.err = testing::internal::GetCapturedStderr();
  return said;
}

}  // namespace mascot

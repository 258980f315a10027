#include "orchestrator/verbs/verb.h"

#include <iostream>

#include "experiment/toml/section.h"
#include "system/failure.h"

namespace mascot {

int ExitCodeOf(const std::function<int()>& action) try { return action(); } catch (const ConfigError& error) {
  for (const std::string& mistake : error.mistakes()) std::cerr << "error: " << mistake << "\n";
  return kExitUsage;
} catch (const std::exception& error) {
  std::cerr << "error: " << InWords(error) << "\n";
  return kExitFailed;
}

}  // namespace mascot

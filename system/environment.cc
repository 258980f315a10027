#include "system/environment.h"

#include <cstdlib>

namespace mascot {

std::string EnvironmentText(const char* name) {
  const char* text = std::getenv(name);  // NOLINT(concurrency-mt-unsafe): nothing sets variables
  return text == nullptr ? "" : text;
}

}  // namespace mascot

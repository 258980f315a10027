// write_reference FOLDER: makes docs/configuration.md and docs/mascot.schema.json in a source tree anew.
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>

#include "orchestrator/reference/reference.h"

namespace {

void Write(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  if (!(file << text).flush()) throw std::runtime_error(path.string() + ": cannot be written");
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) throw std::runtime_error("expected the folder of the source tree");
  const std::filesystem::path folder = argv[1];
  Write(folder / "docs/configuration.md", mascot::ConfigurationReference());
  Write(folder / "docs/mascot.schema.json", mascot::ConfigurationSchema());
  return 0;
} catch (const std::exception& error) {
  std::cerr << "error: " << error.what() << "\n";
  return 1;
}

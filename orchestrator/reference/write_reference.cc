// write_reference FOLDER: writes docs/configuration.md and docs/mascot.schema.json of the source tree FOLDER.
#include <exception>
#include <filesystem>
#include <iostream>
#include <stdexcept>

#include "orchestrator/formats/whole_file.h"
#include "orchestrator/reference/reference.h"

int main(int argc, char** argv) try {
  if (argc != 2) throw std::runtime_error("expected the folder of the source tree");
  const std::filesystem::path folder = argv[1];
  mascot::WriteWhole(folder / "docs/configuration.md", mascot::ConfigurationReference());
  mascot::WriteWhole(folder / "docs/mascot.schema.json", mascot::ConfigurationSchema());
  return 0;
} catch (const std::exception& error) {
  std::cerr << "error: " << error.what() << "\n";
  return 1;
}

// write_reference FOLDER: writes docs/configuration.md, docs/mascot.schema.json and the sections of the laws in
// docs/laws.md of the source tree FOLDER.
#include <exception>
#include <filesystem>
#include <iostream>
#include <stdexcept>

#include "experiment/toml/section.h"
#include "orchestrator/formats/whole_file.h"
#include "orchestrator/reference/reference.h"

int main(int argc, char** argv) try {
  if (argc != 2) throw std::runtime_error("expected the folder of the source tree");
  const std::filesystem::path folder = argv[1];
  mascot::WriteWhole(folder / "docs/configuration.md", mascot::ConfigurationReference());
  mascot::WriteWhole(folder / "docs/mascot.schema.json", mascot::ConfigurationSchema());
  const std::filesystem::path laws = folder / "docs/laws.md";
  mascot::WriteWhole(laws, mascot::LawPage(mascot::ReadRegularFile(laws), folder / "configs"));
  return 0;
} catch (const std::exception& error) {
  std::cerr << "error: " << error.what() << "\n";
  return 1;
}

// Fuzzer: any bytes as the archive of an FMU, and as its modelDescription.xml. They are refused in words, or are what
// the same files are when they are packed anew.
#include "agent/fmi/archive.h"
#include "agent/fmi/error.h"
#include "agent/fmi/model_description.h"
#include "tests/fuzz/fuzz.h"

namespace mascot {
namespace {

void ReadArchive(const std::string& bytes) {
  const FmuArchive archive(bytes);
  std::map<std::string, std::string> files;
  for (const auto& [name, size] : archive.sizes()) {
    Require(!name.starts_with('/') && ("/" + name + "/").find("/../") == std::string::npos, "a name that climbs out");
    files[name] = archive.Read(name);
  }
  const FmuArchive again(PackFiles(files));
  Require(again.sizes() == archive.sizes(), "other files");
}

void ReadDescription(const std::string& text) {
  const ModelDescription model = ModelDescription::FromXml(text);
  Require(model.version == 2 || model.version == 3, "another version");
  for (const FmuVariable& variable : model.variables) {
    Require(model.Find(variable.name) == &variable, "a variable that cannot be found");
    Require(variable.size() <= ModelDescription::kMaxArray, "an array that is too long");
  }
}

}  // namespace
}  // namespace mascot

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string bytes(reinterpret_cast<const char*>(data), size);
  for (auto* const read : {mascot::ReadArchive, mascot::ReadDescription}) try {
      read(bytes);
    } catch (const mascot::FmuError& error) {
      mascot::Require(!std::string(error.what()).empty(), "an error without words");
    }
  return 0;
}

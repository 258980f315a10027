// Fuzzer: any bytes as an experiment file. It is refused with a place, or its resolved form reads back as itself. No
// code of a law is run: laws in Python and in shared libraries are read as laws without parameters.
#include <regex>

#include "agent/laws/laws.h"
#include "tests/fuzz/fuzz.h"

namespace mascot {
namespace {

constexpr int kMaxAgentsFuzzed = 40;  // more take long, and are no other code

class LawsWithoutCode final : public LawCatalog {
 public:
  std::span<const std::string_view> names() const override { return LawNames(); }
  Axes DefaultAxes(std::string_view law) const override { return Row(law).axes; }
  std::span<const Key> Parameters(std::string_view law) const override { return Row(law).parameters; }
  std::map<std::string, Value> GoTo(const AgentConfig& /*agent*/, const Eigen::Vector3d& /*p_W*/,
                                    double /*t_s*/) const override {
    return {};
  }
  std::shared_ptr<const LawParams> Read(const Experiment& experiment, const LawConfig& law,
                                        Section& section) const override {
    const LawEntry& row = Row(law.name);
    section.Use(row.parameters);
    if (row.linear != nullptr || row.pursuit != nullptr) return row.read(experiment, law, section);
    return std::make_shared<LawParams>();
  }

 private:
  static const LawEntry& Row(std::string_view law) { return *std::ranges::find(Laws(), law, &LawEntry::name); }
};

Experiment Read(const std::string& text) {
  return ReadExperiment(Section::FromText(text, "fuzz.toml"), LawsWithoutCode(), "fuzz", /*checked=*/true);
}

bool IsLarge(const std::string& text) {
  Section document = Section::FromText(text, "fuzz.toml");
  document.Use(ExperimentKeys());
  return document.Child("agents").Integer("count") > kMaxAgentsFuzzed;
}

void FuzzExperiment(const std::string& text) try {
  if (IsLarge(text)) return;
  const std::string resolved = Read(text).resolved;
  Require(Read(resolved).resolved == resolved, "a resolved experiment does not read back as itself:\n" + resolved);
} catch (const ConfigError& error) {
  for (const std::string& mistake : error.mistakes())
    Require(mistake.starts_with("fuzz.toml:"), "a mistake without a place: " + mistake);
}

}  // namespace
}  // namespace mascot

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  mascot::FuzzExperiment({reinterpret_cast<const char*>(data), size});
  return 0;
}

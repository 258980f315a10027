#include "orchestrator/engines/dds/hosts/same_bits.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace mascot {
namespace {

constexpr std::size_t kDigits = 12;  // of a hash, in messages

/// The processors of one run: that of the physics server, and another one that agents may have beside it.
struct Mix {
  std::string_view physics, agents;
  std::string_view why_not;  ///< empty: agents decide with the same bits (docs/arm64.md)
};
constexpr Mix kMixes[] = {
    {"x86_64", "aarch64", ""},
    {"aarch64", "x86_64",
     "a run on both needs its physics server on x86_64, because Debian's Bullet for aarch64 rounds a * b + c once and "
     "so moves bodies with other bits: start `up` on an x86_64 machine"},
};

}  // namespace

std::string ProcessorText() {
#if defined(__x86_64__)
  return "x86_64";
#elif defined(__aarch64__)
  return "aarch64";
#else
  return "other";
#endif
}

std::string WhyNotTogether(const ProgramBuild& ours, const ProgramBuild& theirs) {
  if (theirs.text == ours.text) return "";
  if (theirs.processor == ours.processor || theirs.processor.empty())
    return fmt::format("has another build of MASCOT: {}, expected {}", theirs.text, ours.text);
  const auto* const mix = std::ranges::find_if(
      kMixes, [&](const Mix& each) { return each.physics == ours.processor && each.agents == theirs.processor; });
  const std::string processors =
      fmt::format("has a processor of another kind: {}, and this machine {}", theirs.processor, ours.processor);
  if (mix == std::end(kMixes))
    return processors + "; a run may have agents on x86_64 and aarch64, beside a physics server on x86_64";
  if (!mix->why_not.empty()) return fmt::format("{}; {}", processors, mix->why_not);
  const auto version = [](const std::string& text) { return text.substr(0, text.find(',')); };
  if (version(theirs.text) == version(ours.text) && theirs.sources == ours.sources) return "";
  return fmt::format("({}) was built from other sources: MASCOT {}, sources {}; expected MASCOT {}, sources {}",
                     theirs.processor, version(theirs.text), theirs.sources.substr(0, kDigits), version(ours.text),
                     ours.sources.substr(0, kDigits));
}

}  // namespace mascot

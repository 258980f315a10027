#include "orchestrator/engines/dds/hosts/same_bits.h"

#include <gmock/gmock.h>
#include <sys/utsname.h>

namespace mascot {
namespace {

using ::testing::HasSubstr;
using ::testing::MatchesRegex;

const ProgramBuild kOurs{"0.2.0, build 1", "abcdefabcdef0123", "x86_64"};

TEST(ProgramsOfARun, AreOneProgram) {
  EXPECT_EQ(WhyNotTogether(kOurs, kOurs), "");
  EXPECT_EQ(WhyNotTogether(kOurs, {"0.2.0, build 2", kOurs.sources, "x86_64"}),
            "has another build of MASCOT: 0.2.0, build 2, expected 0.2.0, build 1");
  EXPECT_EQ(WhyNotTogether(kOurs, {"0.1.0, build 2", "", ""}),
            "has another build of MASCOT: 0.1.0, build 2, expected 0.2.0, build 1")
      << "an older one says nothing of its processor";
}

TEST(ProgramsOfARun, MayBeOfTheSameSourcesForAgentsOnAarch64) {
  EXPECT_EQ(WhyNotTogether(kOurs, {"0.2.0, build 2", kOurs.sources, "aarch64"}), "");
  EXPECT_EQ(
      WhyNotTogether(kOurs, {"0.2.0, build 2", "1234567890123456", "aarch64"}),
      "(aarch64) was built from other sources: MASCOT 0.2.0, sources 123456789012; expected MASCOT 0.2.0, sources "
      "abcdefabcdef");
  EXPECT_THAT(WhyNotTogether(kOurs, {"0.1.0, build 2", kOurs.sources, "aarch64"}),
              HasSubstr("was built from other sources: MASCOT 0.1.0, "));
  EXPECT_THAT(WhyNotTogether(kOurs, {"0.2.0, build 2", "", "aarch64"}), HasSubstr(", sources ; expected"));
}

TEST(ProgramsOfARun, MixProcessorsOnlyBesideAPhysicsServerOnX86) {
  const ProgramBuild on_arm{"0.2.0, build 2", kOurs.sources, "aarch64"};
  EXPECT_EQ(WhyNotTogether(on_arm, on_arm), "");
  EXPECT_EQ(
      WhyNotTogether(on_arm, kOurs),
      "has a processor of another kind: x86_64, and this machine aarch64; a run on both needs its physics server on "
      "x86_64, because Debian's Bullet for aarch64 rounds a * b + c once and so moves bodies with other bits: start "
      "`up` on an x86_64 machine");
  EXPECT_EQ(WhyNotTogether(kOurs, {"0.2.0, build 3", kOurs.sources, "riscv64"}),
            "has a processor of another kind: riscv64, and this machine x86_64; a run may have agents on x86_64 and "
            "aarch64, beside a physics server on x86_64");
}

TEST(ProgramsOfARun, KnowTheirSourcesAndTheirProcessor) {
  EXPECT_THAT(SourcesText(), MatchesRegex("[0-9a-f]{64}"));
  utsname machine{};
  ASSERT_EQ(uname(&machine), 0);
  EXPECT_EQ(ProcessorText(), machine.machine);
}

}  // namespace
}  // namespace mascot

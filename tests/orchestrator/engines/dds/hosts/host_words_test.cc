// What `up` and `orchestrator host` tell each other: read as the words of a stranger.
#include "orchestrator/engines/dds/hosts/host_words.h"

#include <gmock/gmock.h>

#include "orchestrator/formats/outside_json.h"

namespace mascot {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

HostJob JobOfThree() {
  return {.domain = 7,
          .own_memory = false,
          .shared_memory = 123'456,
          .silence_s = 2.5,
          .processes = {{"agent_1", {"--id", "1"}}, {"agents_2-3", {}}}};
}

TEST(HostWords, AreReadAsTheyWereSaid) {
  const HostHello hello = ReadHello(WordsOf(
      HostHello{.build = "1.0", .sources = "f7", .processor = "aarch64", .machine = "a 7", .seen_from = "10.0.0.1"}));
  EXPECT_EQ(hello.build + hello.sources + hello.processor + hello.machine + hello.seen_from, "1.0f7aarch64a 710.0.0.1");
  const HostJob job = ReadJob(WordsOf(JobOfThree()));
  EXPECT_EQ(WordsOf(job), WordsOf(JobOfThree()));
}

TEST(HostWords, ThatAreNotOfTheirKindAreNamed) {
  const auto expect = [](const char* field, const HostWords& value, const std::string& words) {
    HostWords job = WordsOf(JobOfThree());
    job[field] = value;
    EXPECT_THAT([&] { ReadJob(job); }, ThrowsMessage<JsonError>(HasSubstr(words)));
  };
  expect("domain", 233, "expected an integer in [0, 232] as \"domain\", got 233");
  expect("domain", "7", "expected an integer in [0, 232] as \"domain\", got \"7\"");
  expect("own_memory", 1, "expected true or false as \"own_memory\", got 1");
  expect("shared_memory", -1, "as \"shared_memory\", got -1");
  expect("silence_s", nullptr, "as \"silence_s\", got null");
  expect("processes", "agent_1", "as \"processes\", got \"agent_1\"");
  expect("processes", {1}, "expected an object as each of the \"processes\"");
  expect("processes", HostWords::array({{{"name", "agent_1"}}}),
         "expected a list of at most 1000 values as \"arguments\"");
  expect("processes", HostWords::array({{{"name", "agent_1"}, {"arguments", {1}}}}),
         "expected a text as each of the \"arguments\"");
  HostWords twice = WordsOf(JobOfThree());
  twice["processes"].push_back(twice["processes"][0]);
  EXPECT_THAT([&] { ReadJob(twice); },
              ThrowsMessage<JsonError>("expected each of the \"processes\" once, got one twice"));
  EXPECT_THAT(
      [] {
        ReadHello({{"kind", "hello"}, {"build", "1.0"}, {"machine", 7}, {"seen_from", ""}});
      },
      ThrowsMessage<JsonError>("expected a text of at most 10000 bytes as \"machine\", got 7"));
}

}  // namespace
}  // namespace mascot

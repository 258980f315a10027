#include "system/asked_program.h"

#include <gmock/gmock.h>

namespace mascot {
namespace {

TEST(AskedProgram, ReadsTheQuestionAndAnswersToItsLastArgument) {
  AskedProgram program({"sh", "-c", "cat >&$0; echo not this"}, std::string(1'000'000, 'x'));
  const AskedProgram::Answer answer = program.Wait();
  EXPECT_EQ(answer.text, std::string(1'000'000, 'x'));
  EXPECT_EQ(answer.end, "");
}

TEST(AskedProgram, SaysHowItFailed) {
  EXPECT_EQ(AskedProgram({"sh", "-c", "exit 3"}, "").Wait().end, "exited with code 3");
  const AskedProgram::Answer killed = AskedProgram({"sh", "-c", "echo half >&$0; kill -9 $$"}, "").Wait();
  EXPECT_EQ(killed.text, "half\n");
  EXPECT_THAT(killed.end, testing::StartsWith("was killed by signal 9"));
  EXPECT_THROW(AskedProgram({"/nowhere/program"}, ""), std::runtime_error);
}

}  // namespace
}  // namespace mascot

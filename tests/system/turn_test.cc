#include "system/turn.h"

#include <gmock/gmock.h>
#include <signal.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "system/spawn.h"
#include "tests/support/scratch.h"
#include "tests/support/waits.h"

namespace mascot {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(Turn, IsTakenByOneProcessAtATime) {
  constexpr int kProcesses = 8;
  const ScratchFolder folder;
  std::vector<ChildProcess> children;
  for (int k = 0; k < kProcesses; ++k)
    children.push_back(Fork([&folder] {
      const Turn turn(folder.File("turn"));
      std::ofstream log(folder.File("log"), std::ios::app);
      log << "begin " << std::flush;
      log << "end ";
    }));
  for (ChildProcess& child : children) EXPECT_EQ(child.Reap(), 0);
  std::string expected;
  for (int k = 0; k < kProcesses; ++k) expected += "begin end ";
  EXPECT_EQ(ReadFile(folder.File("log")), expected);
}

TEST(Turn, OfAProcessThatWasKilledIsGivenBack) {
  const ScratchFolder folder;
  ChildProcess child = Fork([&] {
    const Turn turn(folder.File("turn"));
    WriteFile(folder.File("taken"), "");
    pause();
  });
  test::Await("its turn", [&] { return std::filesystem::exists(folder.File("taken")); });
  child.Signal(SIGKILL);
  child.Reap();
  const Turn turn(folder.File("turn"));
}

TEST(Turn, SaysWhyThereIsNone) {
  EXPECT_THAT([] { Turn("/nowhere/turn"); },
              ThrowsMessage<std::filesystem::filesystem_error>(HasSubstr("No such file or directory [/nowhere/turn]")));
}

}  // namespace
}  // namespace mascot

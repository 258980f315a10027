// What failed, in words, and exceptions that no code catches.
#include "system/failure.h"

#include <gtest/gtest.h>

#include <new>
#include <stdexcept>
#include <system_error>
#include <thread>

namespace mascot {
namespace {

TEST(InWords, WantOfMemoryAndOfThreadsIsSaid) {
  EXPECT_EQ(InWords(std::runtime_error("as it is")), "as it is");
  EXPECT_EQ(InWords(std::bad_alloc()), "out of memory (std::bad_alloc); is there a limit, such as ulimit -v?");
  EXPECT_EQ(InWords(std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again))),
            "no thread can be started (Resource temporarily unavailable); is there a limit, such as ulimit -u or -v?");
}

TEST(InWordsDeathTest, ThatNobodyCatchesAnExceptionIsAnErrorAndExitCode1) {
  const auto die_of = [](auto exception) {
    SayWhatIsUncaught();
    std::thread([exception] { throw exception; }).join();
  };
  EXPECT_EXIT(die_of(std::bad_alloc()), testing::ExitedWithCode(1), "^error: out of memory \\(std::bad_alloc\\)");
  EXPECT_EXIT(die_of(std::runtime_error("no such bit")), testing::ExitedWithCode(1), "^error: no such bit\n$");
  EXPECT_EXIT(die_of(7), testing::ExitedWithCode(1),
              "^error: an exception of the C\\+\\+ type int, which nothing in system_tests has caught\n$");
}

}  // namespace
}  // namespace mascot

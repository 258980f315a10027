// Experiments from files and from pipes.
#include "experiment/toml/input.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <string>
#include <thread>

#include "experiment/toml/section.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

using ::testing::StartsWith;
using ::testing::ThrowsMessage;

/// A pipe with a text in it, as a shell makes for <(COMMAND).
class Pipe {
 public:
  explicit Pipe(const std::string& text) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
    end_ = ends[0];
    writer_ = std::jthread([end = ends[1], text] {  // more than the pipe holds
      std::size_t written = 0;
      while (written < text.size()) {
        const ssize_t more = ::write(end, text.data() + written, text.size() - written);
        if (more <= 0) break;
        written += static_cast<std::size_t>(more);
      }
      ::close(end);
    });
  }
  ~Pipe() { ::close(end_); }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  std::string path(const std::string& folder = "/dev/fd/") const { return folder + std::to_string(end_); }

 private:
  int end_ = -1;
  std::jthread writer_;
};

TEST(Input, ADescriptorIsKnownByTheNamesThatASystemHasForIt) {
  EXPECT_EQ(DescriptorOf("-"), 0);
  EXPECT_EQ(DescriptorOf("/dev/stdin"), 0);
  EXPECT_EQ(DescriptorOf("/dev/fd/63"), 63);
  EXPECT_EQ(DescriptorOf("/proc/self/fd/4"), 4);
  for (const char* path :
       {"", "--", "./-", "stdin", "/dev/fd", "/dev/fd/", "/dev/fd/x", "/dev/fd/3/a", "/dev/null", "-x"})
    EXPECT_FALSE(DescriptorOf(path)) << path;
}

TEST(Input, APipeIsReadToItsEnd) {
  const std::string text(300000, 'x');
  for (const char* folder : {"/dev/fd/", "/proc/self/fd/"}) {
    const Pipe pipe(text);
    EXPECT_EQ(ReadInput(pipe.path(folder)), text);
  }
}

TEST(Input, APipeThatDoesNotEndIsRefused) {
  const int zeros = ::open("/dev/zero", O_RDONLY | O_CLOEXEC);
  const std::string path = "/dev/fd/" + std::to_string(zeros);
  EXPECT_THAT([&] { ReadInput(path); }, ThrowsMessage<ConfigError>(path + ": is larger than 16 MiB"));
  ::close(zeros);
}

TEST(Input, WhatIsNotOpenOrAFolderIsRefusedAndSoIsAPipeInTheFileSystem) {
  EXPECT_THAT([] { ReadInput("/dev/fd/99"); },
              ThrowsMessage<ConfigError>("/dev/fd/99: cannot be read: Bad file descriptor"));
  const int folder = ::open("/", O_RDONLY | O_CLOEXEC);
  const std::string path = "/proc/self/fd/" + std::to_string(folder);
  EXPECT_THAT([&] { ReadInput(path); }, ThrowsMessage<ConfigError>(path + ": is a directory"));
  ::close(folder);
  const ScratchFolder scratch;
  ASSERT_EQ(::mkfifo(scratch.File("a.toml").c_str(), 0600), 0);
  EXPECT_THAT([&] { ReadInput(scratch.File("a.toml")); },
              ThrowsMessage<ConfigError>(scratch.File("a.toml") + ": is not a regular file"))
      << "nobody may ever write to it";
}

TEST(Input, MistakesNameThePipeAndItsLine) {
  const Pipe pipe("a = 1\na = 2\n");
  std::string said;
  try {
    Section::FromFile(pipe.path());
  } catch (const ConfigError& error) {  // once: nothing comes out of it a second time
    said = error.what();
  }
  EXPECT_THAT(said, StartsWith(pipe.path() + ":2:"));
  EXPECT_EQ(NameOfInput("-"), "<stdin>");
  EXPECT_EQ(NameOfInput("/dev/stdin"), "<stdin>");
  EXPECT_EQ(NameOfInput("a.toml"), "a.toml");
}

TEST(Input, FilesBesideAPipeAreThoseOfTheCurrentFolder) {
  const Pipe pipe("file = 'law.py'\n");
  Section section = Section::FromFile(pipe.path());
  EXPECT_EQ(section.PlaceOfText("file").folder, "");
  EXPECT_EQ(Section::FromText("file = 'law.py'\n", "folder/a.toml").PlaceOfText("file").folder, "folder");
}

TEST(Input, APipeHasNoNameOfItsOwn) {
  EXPECT_EQ(StemOfInput("<stdin>"), "");
  EXPECT_EQ(StemOfInput("/dev/fd/63"), "");
  EXPECT_EQ(StemOfInput("folder/ring.6.toml"), "ring.6");
}

TEST(Input, APathIsAPathWhateverItBeginsWith) {
  const ScratchFolder scratch;
  std::filesystem::create_directories(scratch.path() / "http:/x");
  for (const char* name :
       {"-x.toml", "--set", "~", "$HOME", "a b.toml", "a\nb.toml", "http:/x/y.toml", "%s", "\xff.toml"}) {
    WriteFile(scratch.File(name), "a = 1\n");
    EXPECT_EQ(ReadInput(scratch.File(name)), "a = 1\n") << name;
  }
}

}  // namespace
}  // namespace mascot

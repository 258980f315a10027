// Files that are made where something else has their name.
#include "orchestrator/formats/create_file.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cstring>
#include <functional>
#include <stdexcept>

#include "orchestrator/formats/csv.h"
#include "orchestrator/formats/mat_file.h"
#include "orchestrator/formats/npz.h"
#include "orchestrator/formats/output_file.h"
#include "orchestrator/formats/whole_file.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

using ::testing::ThrowsMessage;

TEST(OutputFile, ThatIsRemovedWhileItIsWrittenIsNoFile) {
  const ScratchFolder folder;
  OutputFile file(folder.File("run.mcap"));
  file.Write(std::array<std::uint8_t, 3>{1, 2, 3});
  ASSERT_EQ(unlink(folder.File("run.mcap").c_str()), 0);
  EXPECT_THAT(
      [&] { file.SyncAndClose(); },
      ThrowsMessage<std::runtime_error>("cannot complete " + folder.File("run.mcap") + ": No such file or directory"));
}

/// A kind of file, and how it is written at a path.
struct Kind {
  std::string name;
  std::function<void(const std::string& path)> write;
  std::string unfinished = ".part";  ///< what the name has more until it is whole
};

void PrintTo(const Kind& kind, std::ostream* out) { *out << kind.name; }

const Kind kKinds[] = {
    {"Whole", [](const std::string& path) { WriteWhole(path, "ours"); }},
    {"Csv",
     [](const std::string& path) {
       const std::string columns[] = {"ours"};
       CsvWriter(path, columns).Close();
     }},
    {"Npz",
     [](const std::string& path) {
       NpzWriter file(path, 1);
       file.Append(file.AddArray("name", {}), std::vector<double>{1});
       file.Close();
     }},
    {"Mat",
     [](const std::string& path) {
       MatWriter file(path);
       file.AddText("name", "ours");
       file.Close();
     }},
};

class NewFiles : public testing::TestWithParam<Kind> {
 protected:
  void Write() const { GetParam().write(path_); }
  void ExpectRefused(const std::string& name, const std::string& why) const {
    EXPECT_THAT([this] { Write(); }, ThrowsMessage<std::runtime_error>("cannot create " + name + ": " + why));
  }

  const ScratchFolder scratch_;
  const std::string path_ = scratch_.File("file"), part_ = path_ + GetParam().unfinished;
  const std::string other_ = scratch_.File("other");
};

TEST_P(NewFiles, DoNotFollowALinkAtTheNameThatTheyHaveUntilTheyAreWhole) {
  WriteFile(other_, "theirs");
  std::filesystem::create_symlink(other_, part_);
  ExpectRefused(part_, "a symbolic link has this name");
  EXPECT_EQ(ReadFile(other_), "theirs");
  EXPECT_TRUE(std::filesystem::is_symlink(part_)) << "it is left as it is";
}

TEST_P(NewFiles, TakeThePlaceOfALinkAndLeaveWhatItLeadsTo) {
  WriteFile(other_, "theirs");
  std::filesystem::create_symlink(other_, path_);
  Write();
  EXPECT_EQ(ReadFile(other_), "theirs");
  EXPECT_TRUE(std::filesystem::is_regular_file(std::filesystem::symlink_status(path_)));
}

TEST_P(NewFiles, TakeThePlaceOfWhatAKilledProcessLeft) {
  WriteFile(part_, "half of one");
  WriteFile(path_, "an earlier one");
  std::filesystem::create_hard_link(part_, other_);
  Write();
  EXPECT_FALSE(std::filesystem::exists(part_));
  EXPECT_NE(ReadFile(path_), "an earlier one");
  EXPECT_EQ(ReadFile(other_), "half of one");
}

TEST_P(NewFiles, AreRefusedWhereAPipeASocketOrAFolderHasTheirName) {
  for (const std::string& name : {path_, part_}) {
    ASSERT_EQ(::mkfifo(name.c_str(), 0600), 0);
    ExpectRefused(name, "a pipe has this name");
    std::filesystem::remove(name);
    std::filesystem::create_directory(name);
    ExpectRefused(name, "Is a directory");
    std::filesystem::remove(name);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    ASSERT_LT(name.size(), sizeof address.sun_path);
    std::strcpy(address.sun_path, name.c_str());
    const int socket = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    ASSERT_EQ(::bind(socket, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    ExpectRefused(name, "a socket has this name");
    ::close(socket);
    std::filesystem::remove(name);
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds, NewFiles, testing::ValuesIn(kKinds), [](const auto& kind) { return kind.param.name; });

TEST(CreateFile, IsRefusedWhereADeviceHasTheName) {
  EXPECT_THAT([] { CreateFile("/dev/null", O_WRONLY); },
              ThrowsMessage<std::runtime_error>("cannot create /dev/null: a device has this name"));
  EXPECT_THAT([] { WriteWhole("/dev/null", "x"); },
              ThrowsMessage<std::runtime_error>("cannot create /dev/null: a device has this name"));
}

}  // namespace
}  // namespace mascot

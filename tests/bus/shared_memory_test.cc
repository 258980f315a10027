// Which files in /dev/shm are taken for those of dead processes. The files have the names that Fast DDS gives its own.
#include "bus/shared_memory.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <semaphore.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <string>

#include "bus/ports.h"
#include "tests/support/waits.h"

namespace mascot {
namespace {

using testing::Contains;
using testing::Not;

// Domains of no run: network.domain is at most 100. Each is of one test, since tests run at the same time.
constexpr int kDomain = 200, kDomainOfOthers = 210;

/// Another process, which does something and then stalls until it is killed.
class Stalled {
 public:
  explicit Stalled(const std::function<void()>& action) {
    int ready[2];
    if (pipe(ready) != 0) return;
    pid_ = fork();
    if (pid_ == 0) {
      action();
      close(ready[0]);
      close(ready[1]);
      for (;;) pause();
    }
    close(ready[1]);
    test::AwaitInput(ready[0], "a process that stalls");  // its end of the pipe is closed
    close(ready[0]);
  }
  ~Stalled() { Kill(); }
  Stalled(const Stalled&) = delete;
  Stalled& operator=(const Stalled&) = delete;

  void Kill() {
    if (pid_ <= 0) return;
    kill(pid_, SIGKILL);
    test::AwaitEndOf(pid_, "the process that stalled");
    pid_ = 0;
  }

 private:
  pid_t pid_ = 0;
};

std::string Unique(const std::string& name) { return name + std::to_string(getpid()); }

TEST(SharedMemory, ASegmentIsNotStaleBetweenItsMakingAndItsMapping) {
  const std::string name = "/" + Unique("fastrtps_made"), path = "/dev/shm" + name;
  Stalled maker([&] { shm_open(name.c_str(), O_CREAT | O_EXCL | O_RDWR, 0644); });
  ASSERT_TRUE(std::filesystem::exists(path));
  EXPECT_THAT(StaleSharedMemory(kNoDomain), Not(Contains(path)));
  SweepSharedMemory(kNoDomain);
  EXPECT_TRUE(std::filesystem::exists(path));
  maker.Kill();
  SweepSharedMemory(kNoDomain);
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(SharedMemory, ASegmentThatIsMappedIsNotStale) {
  const std::string name = "/" + Unique("fastrtps_mapped"), path = "/dev/shm" + name;
  Stalled user([&] {
    const int descriptor = shm_open(name.c_str(), O_CREAT | O_EXCL | O_RDWR, 0644);
    if (ftruncate(descriptor, 4096) != 0) _exit(1);
    mmap(nullptr, 4096, PROT_READ, MAP_SHARED, descriptor, 0);
    close(descriptor);
  });
  SweepSharedMemory(kNoDomain);
  EXPECT_TRUE(std::filesystem::exists(path));
  user.Kill();
  SweepSharedMemory(kNoDomain);
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(SharedMemory, ASemaphoreOfAPortIsNotStaleWhileItsMakerMapsItUnderAnotherName) {
  const std::string name = "/fastrtps_port" + std::to_string(FirstPort(kDomain)) + "_mutex";
  const std::string path = "/dev/shm/sem." + name.substr(1);
  Stalled maker([&] { sem_open(name.c_str(), O_CREAT, 0644, 1); });  // links a temporary file to this name
  ASSERT_TRUE(std::filesystem::exists(path));
  SweepSharedMemory(kDomain);
  EXPECT_TRUE(std::filesystem::exists(path));
  maker.Kill();
  SweepSharedMemory(kDomain);
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(SharedMemory, PortsOfOtherDomainsAreLeftToThoseWhoLockThem) {
  const std::string path = "/dev/shm/fastrtps_port" + std::to_string(FirstPort(kDomainOfOthers));
  close(open(path.c_str(), O_CREAT | O_WRONLY, 0644));
  const Descriptor reserved = ReserveInSharedMemory(kDomainOfOthers);
  ASSERT_TRUE(reserved.is_open());
  EXPECT_FALSE(ReserveInSharedMemory(kDomainOfOthers).is_open()) << "two runs have one domain";
  for (const int other : {kNoDomain, kDomainOfOthers - kDomainsPerRun, kDomainOfOthers + 1}) {
    SweepSharedMemory(other);
    EXPECT_TRUE(std::filesystem::exists(path)) << other;
  }
  SweepSharedMemory(kDomainOfOthers);
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(SharedMemory, PortsBeyondItsOwnThatARunHasLeftAreRemovedUnlessARunHasThem) {
  constexpr int kDomainOfHalfMade = 220, kNext = kDomainOfHalfMade + kDomainsPerRun;
  const std::string path = "/dev/shm/fastrtps_port" + std::to_string(FirstPort(kNext + 1) + 12);
  close(open(path.c_str(), O_CREAT | O_WRONLY, 0644));
  {
    const Descriptor reserved = ReserveInSharedMemory(kNext);  // the run of this domain runs over into the next
    SweepSharedMemory(kDomainOfHalfMade);
    EXPECT_TRUE(std::filesystem::exists(path));
  }
  SweepSharedMemory(kNoDomain);
  EXPECT_TRUE(std::filesystem::exists(path));
  SweepSharedMemory(kDomainOfHalfMade);
  EXPECT_FALSE(std::filesystem::exists(path));
  EXPECT_TRUE(ReserveInSharedMemory(kNext).is_open()) << "it was given back";
}

}  // namespace
}  // namespace mascot

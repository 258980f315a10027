// What control groups let a run have, as their folders tell.
#include "system/control_groups.h"

#include <gmock/gmock.h>
#include <sched.h>

#include "bus/resources.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

TEST(ControlGroups, OfThisProcessBeginWithTheInnermostAndEndAtTheRoot) {
  for (const char* controller : {"memory", "pids"}) {
    const auto groups = ControlGroups(controller);
    if (groups.empty()) GTEST_SKIP() << "this kernel has none";
    for (const auto& group : groups) EXPECT_TRUE(group.string().starts_with("/sys/fs/cgroup")) << group;
    EXPECT_LE(groups.back().string().size(), groups.front().string().size());
  }
}

TEST(ControlGroups, MemoryThatIsUsedIsWhatCannotBeHadAgain) {
  const ScratchFolder folder;
  WriteFile(folder.File("memory.max"), "max\n");
  WriteFile(folder.File("memory.stat"), "anon 3000\nfile 9000\nshmem 500\nactive_file 8000\n");
  EXPECT_FALSE(MemoryOfGroup(folder.path())) << "no limit";
  WriteFile(folder.File("memory.max"), "67108864\n");
  const auto memory = MemoryOfGroup(folder.path());
  ASSERT_TRUE(memory);
  EXPECT_EQ(memory->limit, 67108864U);
  EXPECT_EQ(memory->used, 3500U);
  EXPECT_EQ(memory->file, folder.path() / "memory.max");
}

TEST(ControlGroups, OfVersionOneCountWhatIsInside) {
  const ScratchFolder folder;
  WriteFile(folder.File("memory.limit_in_bytes"), "9223372036854771712\n");
  EXPECT_FALSE(MemoryOfGroup(folder.path())) << "which is how it writes that there is no limit";
  WriteFile(folder.File("memory.limit_in_bytes"), "1048576\n");
  WriteFile(folder.File("memory.stat"), "cache 7\nrss 1\nshmem 2\ntotal_cache 70\ntotal_rss 10\ntotal_shmem 20\n");
  EXPECT_EQ(MemoryOfGroup(folder.path())->used, 30U);
}

TEST(ControlGroups, GiveTimeOfProcessors) {
  const ScratchFolder v2, v1;
  EXPECT_FALSE(ProcessorsOfGroup(v2.path())) << "no such file";
  for (const char* text : {"max 100000\n", "", "0 100000\n", "50000\n", "x y\n"}) {
    WriteFile(v2.File("cpu.max"), text);
    EXPECT_FALSE(ProcessorsOfGroup(v2.path())) << text;
  }
  WriteFile(v2.File("cpu.max"), "250000 100000\n");
  EXPECT_EQ(ProcessorsOfGroup(v2.path()), 2.5);
  WriteFile(v1.File("cpu.cfs_period_us"), "50000\n");
  WriteFile(v1.File("cpu.cfs_quota_us"), "-1\n");
  EXPECT_FALSE(ProcessorsOfGroup(v1.path()));
  WriteFile(v1.File("cpu.cfs_quota_us"), "25000\n");
  EXPECT_EQ(ProcessorsOfGroup(v1.path()), 0.5);
}

TEST(ControlGroups, UsableProcessorsAreThoseOfTheAffinity) {
  const int all = UsableProcessors();
  EXPECT_GE(all, 1);
  cpu_set_t before, one;
  ASSERT_EQ(::sched_getaffinity(0, sizeof before, &before), 0);
  EXPECT_LE(all, CPU_COUNT(&before));
  CPU_ZERO(&one);
  for (std::size_t cpu = 0; CPU_COUNT(&one) == 0; ++cpu)
    if (CPU_ISSET(cpu, &before)) CPU_SET(cpu, &one);
  ASSERT_EQ(::sched_setaffinity(0, sizeof one, &one), 0);
  EXPECT_EQ(UsableProcessors(), 1);
  ASSERT_EQ(::sched_setaffinity(0, sizeof before, &before), 0);
  EXPECT_EQ(UsableProcessors(), all);
}

TEST(ControlGroups, WithoutATableOrWithNonsenseHaveNoNumber) {
  const ScratchFolder folder;
  EXPECT_FALSE(MemoryOfGroup(folder.path()));
  for (const char* text : {"", "max", "-1", "0", "x", "99999999999999999999"}) {
    WriteFile(folder.File("memory.max"), text);
    EXPECT_FALSE(NumberInGroup(folder.File("memory.max"))) << text;
    EXPECT_FALSE(MemoryOfGroup(folder.path())) << text;
  }
}

}  // namespace
}  // namespace mascot

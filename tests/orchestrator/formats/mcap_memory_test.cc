#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <new>

#include "orchestrator/formats/mcap/reader.h"
#include "orchestrator/formats/mcap/writer.h"
#include "tests/orchestrator/formats/mcap_files.h"
#include "tests/support/scratch.h"

namespace {

std::atomic<std::size_t> g_allocations = 0;  // also counted in the thread that compresses
std::atomic<std::size_t> g_largest_bytes = 0;

}  // namespace

// Counts allocations, to show that writing a message allocates nothing and that no file makes its reader allocate much.
// Not inlined, since g++ 12 would then warn that malloc and delete do not match.
[[gnu::noinline]] void* operator new(std::size_t bytes) {
  ++g_allocations;
  std::size_t largest_bytes = g_largest_bytes;
  while (bytes > largest_bytes && !g_largest_bytes.compare_exchange_weak(largest_bytes, bytes)) {
  }
  if (void* memory = std::malloc(bytes)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace mascot {
namespace {

TEST(McapMemory, AMessageAllocatesNothingOnceTheChunkHasFoundItsSize) {
  const ScratchFolder scratch;
  McapWriter writer(scratch.File("run.mcap"));
  const auto channel = writer.AddChannel(Numbers("/n"));
  const Bytes sample(208);
  std::uint64_t time_ns = 0;
  const auto second = [&] {
    for (int i = 0; i < 1001; ++i) writer.Write(channel, time_ns += kMs, sample);
  };
  for (int warm_up = 0; warm_up < 3; ++warm_up) {  // two buffers are used in turn
    second();
    writer.EndTick();
  }
  const std::size_t before = g_allocations;
  second();
  EXPECT_EQ(g_allocations, before);
}

TEST(McapMemory, HostileFilesCostLittle) {
  const ScratchFolder scratch;
  for (const Hostile& hostile : HostileFiles()) {
    WriteFile(scratch.File("bad.mcap"), Handmade(hostile.records));
    g_largest_bytes = 0;
    EXPECT_FALSE(ReadMcap(scratch.File("bad.mcap")).complete) << hostile.name;
    EXPECT_LT(g_largest_bytes, std::size_t{4} << 20) << hostile.name;
  }
}

}  // namespace
}  // namespace mascot

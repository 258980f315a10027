// What a client asks of a team for a long time, without sockets. Everything else: serve_test.py.
#include "orchestrator/serving/team_service.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <new>

namespace {

std::atomic<std::size_t> g_bytes = 0;                     // that are allocated now
constexpr std::size_t kHead = alignof(std::max_align_t);  // in front of each piece: its size

}  // namespace

// Not inlined, since g++ 12 would then warn that malloc and delete do not match.
[[gnu::noinline]] void* operator new(std::size_t bytes) {
  auto* const memory = static_cast<std::byte*>(std::malloc(kHead + bytes));
  if (memory == nullptr) throw std::bad_alloc();
  *reinterpret_cast<std::size_t*>(memory) = bytes;
  g_bytes += bytes;
  return memory + kHead;
}
[[gnu::noinline]] void operator delete(void* piece) noexcept {
  if (piece == nullptr) return;
  auto* const memory = static_cast<std::byte*>(piece) - kHead;
  g_bytes -= *reinterpret_cast<const std::size_t*>(memory);
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* piece, std::size_t) noexcept { operator delete(piece); }

namespace mascot {
namespace {

constexpr const char* kTeam = R"([run]
duration_s = 0.2
[agents]
count = 3
random = {}
[graph]
topology = "complete"
[law]
name = "consensus"
)";

TEST(TeamService, DoesNotGrowByAByteInAThousandResets) {
  TeamService team({.text = kTeam, .path = "team.toml"});
  const auto ask = [&](const char* text) {
    const TeamService::Json answer = team.Answer(TeamService::Json::parse(text));
    EXPECT_FALSE(answer.contains("error")) << answer;
  };
  const auto session = [&] {
    ask(R"({"request": "reset", "seed": 1, "ports": []})");
    ask(R"({"request": "step", "ticks": 2})");
    ask(R"({"request": "reset", "seed": 2, "ports": [1, 3], "set": {"law.p_gain": 0.2}})");
    ask(R"({"request": "step", "actions": [[1, 0, 0], null]})");
    ask(R"({"request": "set", "set": {"law.p_gain": 0.3}})");
    ask(R"({"request": "step", "ticks": 100})");
  };
  for (int k = 0; k < 2; ++k) session();
  const std::size_t before = g_bytes;
  for (int k = 0; k < 500; ++k) session();
  EXPECT_EQ(g_bytes, before);
}

TEST(TeamService, ForgetsWhatASnapshotHasKept) {
  TeamService team({.text = kTeam, .path = "team.toml", .ports = {1}});
  const auto session = [&] {
    team.Step(3, {});
    const auto kept = team.Answer({{"request", "snapshot"}});
    team.Step(3, {});
    team.Answer({{"request", "restore"}, {"snapshot", kept["snapshot"]}});
    team.Answer({{"request", "forget"}, {"snapshot", kept["snapshot"]}});
    team.Answer({{"request", "reset"}});
  };
  for (int k = 0; k < 2; ++k) session();
  const std::size_t before = g_bytes;
  for (int k = 0; k < 1000; ++k) session();
  EXPECT_EQ(g_bytes, before);
}

}  // namespace
}  // namespace mascot

// What a client asks of a team for a long time, without sockets. Everything else: serve_test.py.
#include "orchestrator/serving/team_service.h"

#include <gtest/gtest.h>
#include <malloc.h>

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

/// Bytes that are allocated now, with what malloc adds to them for itself: that differs by some dozens from time to
/// time, once as many sizes have been asked for as there will be.
std::size_t Allocated() { return mallinfo2().uordblks; }

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
  for (int k = 0; k < 400; ++k) session();
  const std::size_t before = Allocated();
  for (int k = 0; k < 500; ++k) session();
  EXPECT_LT(Allocated(), before + 1000) << "less than a byte each: nothing that is kept is so small";
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
  for (int k = 0; k < 1500; ++k) session();
  const std::size_t before = Allocated();
  for (int k = 0; k < 1000; ++k) session();
  EXPECT_LT(Allocated(), before + 1000);
}

}  // namespace
}  // namespace mascot

// Incidents of a run (contacts, limits, lost samples, late commands) in events.csv, on the terminal and in
// summary.json.

#include <gmock/gmock.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "bus/wire.h"
#include "orchestrator/report/incident_report.h"
#include "tests/support/law_run.h"
#include "tests/support/strict_csv.h"
#include "tests/support/three_agents.h"

namespace mascot {
namespace {

using Kind = Incident::Kind;
using testing::HasSubstr;

Experiment LoadThree() { return Load(Three("name = 'consensus'\n")); }

/// A row as a test makes it up.
class MadeRow final : public FlownRow {
 public:
  MadeRow(std::int64_t tick, DecodedRow row) : tick_(tick), row_(std::move(row)) {}
  std::int64_t tick() const override { return tick_; }
  const DecodedRow& decoded() const override { return row_; }
  const Row& bytes() const override { throw std::logic_error("no bytes"); }
  const Row* received() const override { return nullptr; }

 private:
  std::int64_t tick_;
  DecodedRow row_;
};

/// The incidents of three agents, of which agent 2 has these flags at these ticks.
Incidents OfFlags(const std::map<std::int64_t, std::uint32_t>& flags) {
  const Experiment experiment = LoadThree();
  const LinkMeter links(experiment);
  IncidentMeter meter(experiment);
  for (const auto& [tick, bits] : flags) {
    DecodedRow row(3);
    row.commands[1].flags = bits;
    meter.Add(MadeRow(tick, row), links);
  }
  return meter.Result({}, {});
}

TEST(Incidents, GoOnThroughGapsOfHalfASecond) {
  const Incidents all =
      OfFlags({{3, kTiltLimited}, {5, 0}, {6, kTiltLimited}, {56, kTiltLimited}, {107, kTiltLimited}});
  ASSERT_EQ(all.told.size(), 2u) << "at 100 Hz, 50 ticks are 0.5 s";
  EXPECT_EQ(all.told[0].kind, Kind::kTiltLimit);
  EXPECT_EQ(all.told[0].agent, 2);
  EXPECT_EQ(all.told[0].from, 3);
  EXPECT_EQ(all.told[0].to, 56);
  EXPECT_EQ(all.told[0].count, 3);
  EXPECT_EQ(all.told[1].from, 107);
  EXPECT_EQ(all.told[1].count, 1);
}

TEST(Incidents, AreOfOneKindForEachLimit) {
  const std::pair<std::uint32_t, Kind> kinds[] = {{kAccelerationLimited, Kind::kAccelerationLimit},
                                                  {kTiltLimited, Kind::kTiltLimit},
                                                  {kRotorLimited, Kind::kRotorLimit},
                                                  {kSpeedLimited, Kind::kSpeedLimit},
                                                  {kSafetyInfeasible, Kind::kNoSafeCommand}};
  for (const auto& [flag, kind] : kinds) {
    const Incidents all = OfFlags({{1, flag}});
    ASSERT_EQ(all.told.size(), 1u) << flag;
    EXPECT_EQ(all.told[0].kind, kind) << flag;
  }
  EXPECT_TRUE(OfFlags({{1, kSafetyFiltered}}).told.empty()) << "what a filter is for is no incident";
}

TEST(Incidents, AreToldInOrderWithContactsAndLateCommandsAmongThem) {
  const Experiment experiment = LoadThree();
  const LinkMeter links(experiment);
  IncidentMeter meter(experiment);
  DecodedRow row(3);
  row.commands[2].flags = kAccelerationLimited;
  row.events.push_back({.number = 1, .event = {.set = {{"law.beta", Value{2.0}}}}});
  meter.Add(MadeRow(7, row), links);
  const Incidents all = meter.Result({.agents = 1,
                                      .ground = 1,
                                      .obstacles = 1,
                                      .first = {{.tick = 5, .agent = 1, .other = 3, .speed_m_per_s = 2.5},
                                                {.tick = 7, .agent = 2, .other = 0, .speed_m_per_s = 0.25},
                                                {.tick = 9, .agent = 1, .other = -4, .speed_m_per_s = 1}}},
                                     {{.agent = 2, .ticks = {.from = 6, .to = 8, .count = 2}}});
  EXPECT_EQ(IncidentsCsv(experiment, all),
            "t_s,until_s,what,count,agent,with,detail\n"
            "0.05,0.05,contact,1,1,agent 3,2.5 m/s\n"
            "0.06,0.08,late_command,2,2,,\n"
            "0.07,0.07,contact,1,2,ground,0.25 m/s\n"
            "0.07,0.07,acceleration_limit,1,3,,\n"
            "0.07,0.07,event,1,,event 1,\"set = { \"\"law.beta\"\" = 2.0 }\"\n"
            "0.09,0.09,contact,1,1,obstacle 4,1 m/s\n");
  EXPECT_EQ(IncidentsText(experiment, all),
            "happened       0.05 s: agent 1 touches agent 3 at 2.5 m/s; 2 more of this kind\n"
            "               0.06 to 0.08 s: commands of agent 2 come too late, for 2 ticks\n"
            "               0.07 s: agent 3 at its acceleration limit, at 1 tick\n");
}

TEST(Incidents, AreATableThatAStrictReaderReadsWhateverAnEventSays) {
  const Experiment experiment = LoadThree();
  const LinkMeter links(experiment);
  IncidentMeter meter(experiment);
  DecodedRow row(3);
  row.commands[2].flags = kAccelerationLimited;
  const Event lines = {.set = {{"law.params.a,b", Value{std::string("x, \"y\"")}}}, .cut = {{1, 2}, {2, 3}}};
  const std::string text = "set = { \"law.params.a,b\" = \"x, \\\"y\\\"\" }\ncut = [[1, 2], [2, 3]]";
  row.events = {{.number = 1, .event = lines}, {.number = 2}, {.number = 3, .event = {.cut = {{1, 2}}}}};
  meter.Add(MadeRow(7, row), links);
  const auto table = StrictCsv(IncidentsCsv(experiment, meter.Result({}, {})));
  const std::vector<std::vector<std::string>> rows = {{"t_s", "until_s", "what", "count", "agent", "with", "detail"},
                                                      {"0.07", "0.07", "acceleration_limit", "1", "3", "", ""},
                                                      {"0.07", "0.07", "event", "1", "", "event 1", text},
                                                      {"0.07", "0.07", "event", "1", "", "event 2", ""},
                                                      {"0.07", "0.07", "event", "1", "", "event 3", "cut = [[1, 2]]"}};
  EXPECT_EQ(table, rows) << "no line break at the end of a cell";
}

TEST(Incidents, BeyondAHundredThousandAreCounted) {
  const Experiment experiment = LoadThree();
  const LinkMeter links(experiment);
  IncidentMeter meter(experiment);
  DecodedRow row(3);
  for (int k = 0; k < 10; ++k) row.events.push_back({.number = 1});
  for (int tick = 0; tick < 10'001; ++tick) meter.Add(MadeRow(tick, row), links);
  const Incidents all = meter.Result({.ground = 3, .first = {{.tick = 1, .agent = 1, .other = 0}}}, {});
  EXPECT_EQ(all.told.size(), 100'001u);
  EXPECT_EQ(all.more, 10);
  EXPECT_EQ(all.more_contacts, 2);
  EXPECT_THAT(IncidentsText(experiment, all), HasSubstr("; 2 more of this kind"));
  EXPECT_THAT(IncidentsCsv(experiment, all), testing::EndsWith("\n,,more,10,,,\n"));
}

TEST(Incidents, OfAStatusAreThoseThatWerePutIntoIt) {
  const auto taken = [](const Pacing& told, const Contacts& touched) {
    mascot_msgs::msg::Status status;
    ToWire(told, touched, status);
    Pacing pacing;
    Contacts contacts;
    FromWire(status, /*agents=*/3, /*obstacles=*/2, /*last_tick=*/100, pacing, contacts);
    return std::pair(pacing, contacts);
  };
  const Contact last{.tick = 100, .agent = 3, .other = -2, .speed_m_per_s = 1.5};
  const LateCommands late{.agent = 2, .ticks = {.from = 4, .to = 9, .count = 3}};
  const auto [pacing, contacts] = taken({.late = {late}}, {.obstacles = 1, .first = {last}});
  ASSERT_EQ(contacts.first.size(), 1u);
  EXPECT_EQ(contacts.first[0].tick, last.tick);
  EXPECT_EQ(contacts.first[0].other, last.other);
  EXPECT_EQ(contacts.first[0].speed_m_per_s, last.speed_m_per_s);
  ASSERT_EQ(pacing.late.size(), 1u);
  EXPECT_EQ(pacing.late[0].ticks.to, late.ticks.to);
  EXPECT_EQ(pacing.late[0].ticks.count, late.ticks.count);

  for (const Contact& wrong : {Contact{.tick = 101, .agent = 1}, Contact{.tick = 1, .agent = 4}, Contact{.tick = 1},
                               Contact{.tick = 1, .agent = 1, .other = -3}, Contact{.tick = 1, .agent = 1, .other = 4},
                               Contact{.tick = 1, .agent = 1, .other = INT32_MIN},
                               Contact{.tick = 1, .agent = 1, .speed_m_per_s = std::nan("")}})
    EXPECT_THROW(taken({}, {.first = {wrong}}), std::runtime_error) << wrong.tick << " " << wrong.agent;
  try {
    taken({.late = {{.agent = 2, .ticks = {.from = 9, .to = 4, .count = 3}}}}, {});
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(),
                 "/status: expected incidents of agents 1 to 3 at ticks 0 to 100, got kind 1, agent 2, "
                 "other 0, ticks 9 to 4");
  }
}

TEST(Incidents, AreEmptyIfNothingHappened) {
  EXPECT_EQ(IncidentsText(LoadThree(), {}), "");
  EXPECT_EQ(IncidentsCsv(LoadThree(), {}), "t_s,until_s,what,count,agent,with,detail\n");
}

/// Lines of the table of a run, by what happened.
std::map<std::string, std::vector<Incident>> ByName(const LawRun& run, const EngineResult& engine) {
  std::map<std::string, std::vector<Incident>> by_name;
  const Incidents all = IncidentsOf(run.meter, engine, {});
  std::istringstream csv(IncidentsCsv(run.experiment, all));
  std::string line;
  std::getline(csv, line);
  for (const Incident& incident : all.told) {
    std::getline(csv, line);
    std::istringstream fields(line);
    std::string t_s, until_s, what;
    std::getline(std::getline(std::getline(fields, t_s, ','), until_s, ','), what, ',');
    EXPECT_EQ(std::stod(t_s), run.experiment.time_s(incident.from));
    by_name[what].push_back(incident);
  }
  return by_name;
}

TEST(Incidents, AddUpToWhatTheSummaryCounts) {
  const LawRun run(R"(
[run]
duration_s = 5
[agents]
count = 4
model = "double_integrator"
position_m = [[0, 0, 1], [9, 0, 1.5], [0, 9, 2], [9, 9, 2.5]]
[graph]
topology = "ring"
[link]
loss = 0.2
[control]
max_acceleration_m_per_s2 = 0.3
[law]
name = "consensus"
p_gain = 0.5
beta = 1.0
)");
  auto by_name = ByName(run, {});
  std::int64_t lost = 0, limited = 0;
  for (const Incident& incident : by_name["lost_samples"]) lost += incident.count;
  for (const Incident& incident : by_name["acceleration_limit"]) limited += incident.count;
  EXPECT_GT(lost, 0);
  EXPECT_EQ(lost, run.summary["links"]["lost"].get<std::int64_t>());
  EXPECT_GT(limited, 0);
  EXPECT_DOUBLE_EQ(static_cast<double>(limited) / (4.0 * 501),
                   run.summary["control"]["saturated_fraction"].get<double>());
  EXPECT_THAT(run.text, HasSubstr("at its acceleration limit, at "));
  EXPECT_THAT(run.text, HasSubstr(" samples of agent "));
}

TEST(Incidents, SayWhichEventsWereGivenByHand) {
  const Experiment experiment = Load(Three("name = 'consensus'\n") +
                                     "[[events]]\nat_s = 0.3\ncut = [[1, 2]]\n"
                                     "[[events]]\nat_s = 0.3\nmend = [[1, 2]]\n"
                                     "[[events]]\nat_s = 0.6\ncut = [[1, 3]]\n");
  RunMeter meter(experiment);
  const EngineResult result = RunInProcess(experiment, {&meter}, [] { return true; });
  EXPECT_EQ(result.failure, "");
  const int by_hand[] = {2};
  EXPECT_EQ(IncidentsCsv(experiment, IncidentsOf(meter, result, by_hand)),
            "t_s,until_s,what,count,agent,with,detail\n"
            "0.3,0.3,event,1,,event 1,\"cut = [[1, 2]]\"\n"
            "0.3,0.3,event,1,,event 2 by hand,\"mend = [[1, 2]]\"\n"
            "0.6,0.6,event,1,,event 3,\"cut = [[1, 3]]\"\n");
}

TEST(Incidents, OfALinkThatAnEventMakesLossyBeginWithTheEventAndAreAllThatIsLost) {
  const Experiment experiment = Load(Three("name = 'consensus'\n") +
                                     "[[events]]\nat_s = 0.3\nset = { \"link.loss\" = 0.5 }\n"
                                     "[[events]]\nat_s = 0.6\nset = { \"link.loss\" = 0.0 }\n");
  RunMeter meter(experiment);
  const EngineResult result = RunInProcess(experiment, {&meter}, [] { return true; });
  EXPECT_EQ(result.failure, "");
  std::map<int, std::int64_t> lost;
  for (const Incident& incident : IncidentsOf(meter, result, {}).told) {
    if (incident.kind != Kind::kLostSamples) continue;
    EXPECT_EQ(incident.agent, 1);
    EXPECT_GE(incident.from, 30);
    EXPECT_LT(incident.to, 60);
    lost[incident.other] += incident.count;
  }
  for (const EdgeTraffic& edge : meter.Traffic()) {
    EXPECT_GT(lost[edge.heard], 0);
    EXPECT_EQ(lost[edge.heard], static_cast<std::int64_t>(edge.count.lost)) << edge.heard;
  }
}

TEST(Incidents, TellOfARotorThatFailsAndOfWhatFollows) {
  const LawRun run(R"(
[run]
duration_s = 3
[agents]
count = 1
position_m = [[0, 0, 2]]
[[physics.rotor_failures]]
agent = 1
rotor = 3
at_s = 0.29
[law]
name = "waypoint"
waypoints_m = [[0, 0, 2]]
)");
  EXPECT_THAT(run.text, HasSubstr("0.29 s: rotor 3 of agent 1 fails\n"));
  EXPECT_THAT(
      run.prediction.warnings,
      testing::Contains("physics.rotor_failures: agent 1 will fall: from 0.29 s on, rotor 3 gives 0 N at most, and "
                        "3.622 N, a quarter of its weight, is needed to hover level"));
}

}  // namespace
}  // namespace mascot

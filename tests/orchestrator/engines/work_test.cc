// How much work a list of an experiment makes, as the bytes that are allocated meanwhile: twice the list, about twice
// the work. What grows with the square makes four times as much.
#include <gmock/gmock.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <new>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "agent/laws/laws.h"
#include "experiment/live_experiment.h"
#include "orchestrator/control/run_requests.h"
#include "tests/support/load.h"

namespace {

std::atomic<std::size_t> g_bytes = 0;

}  // namespace

// Not inlined, since g++ 12 would then warn that malloc and delete do not match.
[[gnu::noinline]] void* operator new(std::size_t bytes) {
  g_bytes += bytes;
  if (void* memory = std::malloc(bytes)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }

namespace mascot {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

double BytesOf(const std::function<void()>& work) {
  const std::size_t before = g_bytes;
  work();
  return static_cast<double>(g_bytes - before);
}

std::string Repeated(int count, const std::function<std::string(int)>& item) {
  std::string text;
  for (int k = 0; k < count; ++k) text += item(k);
  return text;
}

std::string Listed(int count, const std::function<std::string(int)>& item) {
  return "[" + Repeated(count, [&](int k) { return item(k) + ", "; }) + "]\n";
}

std::string Team(const std::string& more = {}, int agents = 4) {
  return "run.duration_s = 1000\nagents = { count = " + std::to_string(agents) +
         ", random = { min_separation_m = 0.1, max_m = [1000, 1000, 1000] } }\ngraph.topology = 'ring'\nlaw.name = "
         "'consensus'\noutput.fidelity = false\n" +
         more;
}

/// One [[events]] for each tick.
std::string Events(int count, const std::function<std::string(int)>& keys) {
  return Repeated(count, [&](int k) {
    return "[[events]]\nat_s = " + std::to_string(k / 100) + "." + std::to_string(k / 10 % 10) +
           std::to_string(k % 10) + "\n" + keys(k) + "\n";
  });
}

std::string Waypoints(int count) {
  return Listed(count, [](int k) { return "[" + std::to_string(k % 900) + ", 0, 1]"; });
}

/// A list of an experiment, of any length.
struct List {
  std::string name;
  int length = 0;
  std::function<std::string(int)> toml;
};

void PrintTo(const List& list, std::ostream* out) { *out << list.name; }

const List kLists[] = {
    {"events_that_set", 400,
     [](int n) {
       return Team() + Events(n, [](int k) { return "set = { law.p_gain = 0." + std::to_string(k + 1) + " }"; });
     }},
    {"events_for_one_agent", 300,
     [](int n) {
       return Team() + Events(n, [](int k) {
                return "set = { law.p_gain = 0.2 }\nagents = [" + std::to_string(k % 4 + 1) + "]";
              });
     }},
    {"events_that_cut", 3000,
     [](int n) { return Team() + Events(n, [](int k) { return k % 2 == 0 ? "cut = [[1, 2]]" : "mend = [[1, 2]]"; }); }},
    {"edges_in_an_event", 10000,
     [](int n) {
       return "run.duration_s = 1\nagents = { count = 150, model = 'double_integrator', random.max_m = [999, 999, 999] "
              "}\nlaw.name = 'consensus'\ngraph.topology = 'complete'\n[[events]]\nat_s = 1\ncut = " +
              Listed(n, [](int k) {  // [1, 2], [2, 3] and so on, then [1, 3], [2, 4]
                return "[" + std::to_string(k % 150 + 1) + ", " + std::to_string((k % 150 + k / 150 + 1) % 150 + 1) +
                       "]";
              });
     }},
    {"phases_of_the_law", 60,
     [](int n) {
       return Team() + Repeated(n, [](int k) {
                return "[[law.schedule]]\nat_s = " + std::to_string(k + 1) + "\np_gain = 0.2\n";
              });
     }},
    {"graphs_of_the_schedule", 1000,
     [](int n) {
       return Team() + Repeated(n, [](int k) {
                return "[[graph.schedule]]\nat_s = " + std::to_string(k + 1) + "\nedges = [[1, 2], [2, 1]]\n";
              });
     }},
    {"obstacles", 400,
     [](int n) {
       return Team() + Repeated(n, [](int k) {
                return "[[physics.obstacles]]\nshape = 'box'\nposition_m = [" + std::to_string(-2000 - 2 * k) +
                       ", 0, 1]\nsize_m = [1, 1, 1]\n";
              });
     }},
    {"failures_of_rotors", 2000,
     [](int n) {
       return Team() + Repeated(n, [](int k) {
                return "[[physics.rotor_failures]]\nagent = 1\nrotor = 1\nat_s = " + std::to_string(k) + "\n";
              });
     }},
    {"waypoints", 5000,
     [](int n) {
       return "run.duration_s = 1\nagents.count = 1\nlaw = { name = 'waypoint', axes = 'xyz', waypoints_m = " +
              Waypoints(n).substr(0, Waypoints(n).size() - 1) + " }\n";
     }},
    {"topics", 400,
     [](int n) { return Team() + "[record]\ntopics = " + Listed(n, [](int) { return "'/agent_*/state'"; }); }},
    {"positions", 500,
     [](int n) {
       return "run.duration_s = 1\ngraph.topology = 'ring'\nlaw.name = 'consensus'\nagents = { count = " +
              std::to_string(n) + ", model = 'double_integrator', position_m = [" +
              Repeated(n, [](int k) { return "[" + std::to_string(2 * k) + ", 0, 1], "; }) + "] }\n";
     }},
    {"edges", 400,
     [](int n) {
       return "run.duration_s = 1\nagents = { count = " + std::to_string(n) +
              ", model = 'double_integrator', random.max_m = [9999, 9999, 9999] }\nlaw.name = 'consensus'\ngraph.edges "
              "= " +
              Listed(n - 1, [](int k) { return "[" + std::to_string(k + 2) + ", " + std::to_string(k + 1) + "]"; });
     }},
    {"overrides_of_links", 500,
     [](int n) {
       return Team("[link]\n", 1001) + Repeated(n, [](int k) {
                return "[[link.override]]\nedges = [[" + std::to_string(k + 2) + ", " + std::to_string(k + 1) +
                       "]]\nloss = 0.1\n";
              });
     }},
    {"hosts", 200,
     [](int n) {
       return Team("", 400) + Repeated(n, [](int k) {
                return "[[hosts]]\nname = 'h" + std::to_string(k) + "'\nagents = '" + std::to_string(k + 1) + "'\n";
              });
     }},
};

class Work : public testing::TestWithParam<List> {};

TEST_P(Work, OfReadingAListGrowsWithItsLength) {
  const List& list = GetParam();
  const auto reading = [&](int length) {
    const std::string toml = list.toml(length);
    return BytesOf([&] { Load(toml); });
  };
  reading(2);  // what is made once
  const double once = reading(list.length), twice = reading(2 * list.length);
  EXPECT_LT(twice, 2.5 * once);
}

INSTANTIATE_TEST_SUITE_P(Lists, Work, testing::ValuesIn(kLists), [](const auto& param) { return param.param.name; });

TEST(Limits, OfListsAreSaidInWords) {
  const auto tables = [](const std::string& name, int count) {
    return Repeated(count, [&](int) { return "[[" + name + "]]\n"; });
  };
  const auto refusal = [](const std::string& more) -> std::string {
    try {
      Load(Team(more));
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "nothing";
  };
  EXPECT_THAT(refusal(tables("events", 100001)), HasSubstr(": events: expected at most 100000 tables, got 100001"));
  EXPECT_THAT(refusal(tables("law.schedule", 1001)),
              HasSubstr(": law.schedule: expected at most 1000 tables, got 1001"));
  EXPECT_THAT(refusal(tables("graph.schedule", 10001)),
              HasSubstr(": graph.schedule: expected at most 10000 tables, got 10001"));
  EXPECT_THAT(refusal(tables("physics.obstacles", 1001)),
              HasSubstr(": physics.obstacles: expected at most 1000 tables, got 1001"));
  EXPECT_THAT(refusal(tables("physics.rotor_failures", 40001)),
              HasSubstr(": physics.rotor_failures: expected at most 40000 tables, got 40001"));
  EXPECT_THAT(refusal(tables("link.override", 10001)),
              HasSubstr(": link.override: expected at most 10000 tables, got 10001"));
  EXPECT_THAT(refusal(tables("hosts", 1001)), HasSubstr(": hosts: expected at most 1000 tables, got 1001"));
  EXPECT_THAT(refusal("[record]\ntopics = " + Listed(1001, [](int) { return "'*'"; })),
              HasSubstr(": record.topics: expected at most 1000 patterns, got 1001"));
  EXPECT_THAT(refusal("[[events]]\nat_s = 1\ncut = " + Listed(1000001, [](int) { return "1"; })),
              HasSubstr(": events[0].cut: expected a list of at most 1000000, got a list of 1000001"));
}

TEST(Limits, OfEdgesHoldForAllGraphsOfAScheduleTogether) {
  const std::string graphs = Repeated(
      210, [](int k) { return "[[graph.schedule]]\nat_s = " + std::to_string(k + 1) + "\ntopology = 'complete'\n"; });
  EXPECT_THAT(
      [&] { Load(Team(graphs, 320)); },
      ThrowsMessage<ConfigError>(HasSubstr(": expected at most 10000000 edges in all graphs together, got more")));
}

TEST(Limits, OfEdgesAreSaidBeforeTheyTakeMemory) {
  const auto refusal = [](const std::string& graph) {
    try {
      Load("run.duration_s = 1\nagents.count = 5000\n" + graph);
    } catch (const ConfigError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const std::string limit = "expected a graph with at most 10000000 edges for 5000 agents, got ";
  EXPECT_THAT(refusal(""), HasSubstr("graph.topology: " + limit + "\"complete\", which has more"));
  EXPECT_THAT(refusal("graph.random = { kind = 'erdos_renyi', p = 0.9 }\n"),
              HasSubstr("graph.random: " + limit + "more"));
  EXPECT_THAT(refusal("graph.random = { kind = 'small_world', k = 4000, p = 0.1 }\n"),
              HasSubstr("graph.random: " + limit + "more"));
}

TEST(Limits, OfAnEventsSizeIsSaid) {
  const auto flies_with = [](int numbers) {
    return Load(
        "run.duration_s = 1\nagents.count = 2\n[law]\nname = 'custom'\npython = '''\ndef set(me, params): pass\n"
        "def control(t, me, neighbours): return 0, 0\n'''\n[[events]]\nat_s = 0.5\n"
        "set = { 'law.params' = { x = [" +
        Repeated(numbers, [](int) { return "1000000, "; }) + "] } }\n");
  };
  EXPECT_EQ(flies_with(100'000).events.size(), 1);
  EXPECT_THAT([&] { flies_with(200'000); },
              ThrowsMessage<ConfigError>(
                  HasSubstr(": expected an event of at most 1048576 bytes, as config.toml has it, got 1800")));
}

TEST(Limits, OfEventsHoldForARunToo) {
  Experiment experiment = Load(Team());
  experiment.events.resize(100000);
  RunRequests requests(experiment, 0);
  requests.Open();
  const Answer answer = requests.Ask({.kind = Request::Kind::kEvent, .toml = "cut = [[1, 2]]"});
  EXPECT_FALSE(answer.granted);
  EXPECT_EQ(answer.words, "event by hand: expected at most 100000 events in a run, got one more");
}

/// Bytes that a process of a run allocates when it takes all events of the file.
double Taking(const Experiment& experiment) {
  LiveExperiment live(experiment, &LawTable(), /*checked=*/true);
  return BytesOf([&] {
    for (const Event& event : experiment.events) live.Take(event);
  });
}

TEST(Work, OfAnEventDoesNotDependOnHowManyThereAre) {
  const auto toml = [](int n) { return Team() + Events(n, [](int) { return "set = { law.p_gain = 0.3 }"; }); };
  const Experiment few = Load(toml(50)), many = Load(toml(500));
  EXPECT_LT(Taking(many) / 500, 1.1 * Taking(few) / 50);
}

/// A team in a file that says where each agent starts.
std::string Placed(int agents) {
  return "run.duration_s = 1000\ngraph.topology = 'ring'\nlaw.name = 'consensus'\noutput.fidelity = false\n"
         "agents = { count = " +
         std::to_string(agents) + ", position_m = [" +
         Repeated(agents, [](int k) { return "[" + std::to_string(2 * k) + ".25, 0.5, 1.5], "; }) + "] }\n";
}

constexpr const char* kSmallEvents[] = {"set = { law.p_gain = 0.3 }",
                                        "set = { control.max_speed_m_per_s = 2.0 }\nagents = [2]",
                                        "set = { link.loss = 0.1, graph.range_m = 500.0 }",
                                        "set = { physics.wind.gust_std_m_per_s = 0.1 }",
                                        "set = { run.pace = 2.0 }",
                                        "cut = [[2, 1]]"};

TEST(Work, OfAnEventIsNoReadingOfTheExperiment) {
  const std::string team = Placed(200);
  Load(team);
  const double reading = BytesOf([&] { Load(team); });
  for (const char* keys : kSmallEvents)
    EXPECT_LT(Taking(Load(team + Events(100, [&](int) { return keys; }))) / 100, 0.05 * reading) << keys;
}

TEST(Work, OfAnEventDoesNotGrowWithTheTeam) {
  for (const char* keys : kSmallEvents) {
    const auto taking = [&](int agents) {
      return Taking(Load(Team("", agents) + Events(100, [&](int) { return keys; })));
    };
    EXPECT_LT(taking(400), 1.2 * taking(4)) << keys;
  }
}

/// Sends events to a run that stands still; an event that is granted takes effect at the next tick, the 7th.
class Asked {
 public:
  explicit Asked(const std::string& toml) : experiment_(Load(toml)), requests_(experiment_, 0) { requests_.Open(); }
  /// Bytes that the orchestrator allocates until `count` events are granted.
  double Work(const std::string& event, int count = 1) {
    return BytesOf([&] {
      for (int k = 0; k < count; ++k)
        EXPECT_TRUE(requests_.Ask({.kind = Request::Kind::kEvent, .toml = event}).granted);
    });
  }

 private:
  const Experiment experiment_;
  RunRequests requests_;
  const std::jthread run_{[this](const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      requests_.WaitUntil(std::chrono::steady_clock::now() + std::chrono::milliseconds(10));
      if (requests_.Next()) requests_.Done(7);
    }
  }};
};

constexpr const char* kByHand = "set = { law.p_gain = 0.3 }";

TEST(Work, OfAnEventByHandDoesNotDependOnHowManyWereGivenBefore) {
  Asked run(Team());
  run.Work(kByHand);
  const double first = run.Work(kByHand, 50);
  run.Work(kByHand, 400);
  EXPECT_LT(run.Work(kByHand, 50), 1.1 * first);
}

TEST(Work, OfAnEventByHandDoesNotDependOnLaterEventsOfTheFileInOtherTables) {
  const auto work = [](int later) {
    Asked run(Team("", 200) + Events(later, [](int k) {
                return k < 10 ? "cut = [[2, 1]]" : "set = { link.loss = 0.1, control.velocity_gain = 1.5 }";
              }));
    run.Work(kByHand);
    return run.Work(kByHand);
  };
  EXPECT_LT(work(400), 1.1 * work(0));
}

TEST(Work, OfAnEventByHandReadsForEachLaterEventOfItsTableThatTableAlone) {
  const std::string team = Placed(200);
  Load(team);
  const double reading = BytesOf([&] { Load(team); });
  const auto work = [&](int later) {
    Asked run(team + Events(later, [](int) { return "set = { law.beta = 2.0 }"; }));
    run.Work(kByHand);
    return run.Work(kByHand);
  };
  EXPECT_LT((work(400) - work(100)) / 300, 0.05 * reading);
}

}  // namespace
}  // namespace mascot

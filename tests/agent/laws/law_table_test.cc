// The table of laws: every law is in it with its keys, each key does something, and the resolved file keeps it.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <toml++/toml.h>

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <random>
#include <set>

#include "agent/laws/laws.h"
#include "base/base64.h"
#include "experiment/live_experiment.h"
#include "experiment/live_keys.h"
#include "tests/support/folders.h"
#include "tests/support/ideal_network.h"
#include "tests/support/onnx_model.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

using ::testing::HasSubstr;

std::vector<std::string> Mistakes(const std::string& toml) {
  try {
    LoadExperiment(Section::FromText(toml, "test.toml"), "test");
  } catch (const ConfigError& error) {
    return error.mistakes();
  }
  return {};
}

/// A test that `parameter` of a law has an effect: two sets of keys of [law].
struct Setting {
  std::string parameter;
  std::string base;     ///< lines of [law]
  std::string changed;  ///< lines of [law] that differ in the parameter alone
};

/// The settings with which a law is tried.
struct Trial {
  std::string experiment;  ///< everything in front of the lines of [law]
  std::vector<Setting> settings;
};

const std::string kFiveOnAPath =
    "[run]\nduration_s = 1.0\n"
    "[agents]\ncount = 5\nmodel = 'double_integrator'\n"
    "position_m = [[3, 0, 1], [-1, 2, 2], [4, 1, 3], [1, -3, 4], [-5, 5, 5]]\n[graph]\ntopology = 'path'\n";

/// Settings for the law in Python; custom_law_test.cc tests the rest.
std::vector<Setting> CustomSettings() {
  const auto law = [](const std::string& gain) {
    return "python = '''\ndef start(me, params):\n  me.gain = params.get('gain', 1.0)\n"
           "def control(t, me, neighbours):\n"
           "  return -me.velocity + sum(me.gain * " +
           gain + " * (j.position - me.position) for j in neighbours)\n'''\n";
  };
  const std::string published =
      "style = 'mascot'\npython = '''\ndef control_user(px, vx, ax, py, vy, ay, i, n, leader):\n"
      "  return 0.1 * leader - vx[i], -vy[i]\n'''\n";
  const auto with_module = [](const std::string& gain) {
    return "modules = { 'gains.py' = 'GAIN = " + gain +
           "' }\npython = '''\nimport gains\ndef control(t, me, neighbours):\n"
           "  return -me.velocity + sum(gains.GAIN * (j.position - me.position) for j in neighbours)\n'''\n";
  };
  const std::string weighed =
      "python = '''\ndef control(t, me, neighbours):\n  return sum(float(open(file).read()) for file in "
      "DATA.values()), 0\n"
      "'''\n";
  const auto with_data = [&](const std::string& base64) {
    return "data = ['w']\ndata_base64 = { w = '" + base64 + "' }\n" + weighed;
  };
  return {{"python", law("1.0"), law("1.1")},
          {"data", weighed, with_data(ToBase64("1.0"))},
          {"data_base64", with_data(ToBase64("1.0")), with_data(ToBase64("1.5"))},
          {"modules", with_module("1.0"), with_module("1.1")},
          {"params", law("1.0"), law("1.0") + "params = { gain = 0.5 }\n"},
          {"style", law("1.0"), published},
          {"leader", published, published + "leader = 2\n"},
          {"output", law("1.0"), law("1.0") + "output = 'velocity'\n"}};
}

/// Settings for laws in shared libraries, with those of tests/plugins.
std::vector<Setting> PluginSettings() {
  const auto library = [](const std::string& name) {
    return "library = '" + test::BuildFolder() + "/tests/plugins/lib" + name + ".so'\n";
  };
  const std::string base = library("mirror");
  return {{"library", base, library("talker")},
          {"params", base, base + "params = { gain = 0.5 }\n"},
          {"leader", base, base + "leader = 2\n"}};
}

/// Settings for the law in MATLAB's language; octave_law_test.cc tests the rest.
std::vector<Setting> OctaveSettings() {
  const auto law = [](const std::string& gain) {
    return "octave = '''\nfunction a = control(t, me, neighbours, params)\n  a = -me.velocity;\n  gain = 1.0;\n"
           "  if isfield(params, 'gain')\n    gain = params.gain;\n  end\n  for j = neighbours\n    a = a + gain * " +
           gain + " * (j.position - me.position);\n  end\nend\n'''\n";
  };
  const auto with_module = [&](const std::string& gain) {
    return "modules = { 'factor.m' = 'function y = factor(), y = " + gain + "; end' }\n" + law("factor()");
  };
  return {{"octave", law("1.0"), law("1.1")},
          {"modules", with_module("1.0"), with_module("1.1")},
          {"params", law("1.0"), law("1.0") + "params = { gain = 0.5 }\n"},
          {"output", law("1.0"), law("1.0") + "output = 'velocity'\n"}};
}

/// Settings for the law that is a network: the consensus law with one gain or another.
std::vector<Setting> PolicySettings() {
  const auto law = [](float p_gain) {
    const std::string hash = ObservationLayout{.places = 2, .message = 0}.Hash();  // on a path
    const std::string bytes = test::ConsensusNetwork(2, p_gain, 1).Metadata("mascot_observation", hash).Bytes();
    return "onnx_base64 = '" + ToBase64(bytes) + "'\n";
  };
  return {{"onnx_base64", law(0.5), law(0.25)}, {"output", law(0.5), law(0.5) + "output = 'velocity'\n"}};
}

/// Settings for the law that is an FMU, with those of tests/fmus.
std::vector<Setting> FmuSettings() {
  const auto fmu = [](int version) {
    const std::string file = fmt::format("{}/tests/fmus/law_fmi{}.fmu", test::BuildFolder(), version);
    return "fmu_base64 = '" + ToBase64(ReadFile(file)) + "'\n";
  };
  const std::string base = fmu(2), gain = "params = { p_gain = 0.5 }\n";
  return {{"fmu_base64", base + "params = { beta = 2.0 }\n", fmu(3) + "params = { beta = 1.0 }\n"},
          {"params", base, base + gain},
          {"output", base, base + "output = 'velocity'\n"},
          {"fmu", base, base + "fmu = { inputs = { 'v[1]' = 'p[2]' } }\n"}};
}

/// Reads tests/law_settings/LAW.toml. Each of its [keys] has the lines of [law] that change it, added to `base`, or two
/// sets of lines that differ in it. `experiment`: another team than five on a path.
Trial ReadTrial(std::string_view law) {
  const toml::table file = toml::parse_file(test::SourceFolder() + "/tests/law_settings/" + std::string(law) + ".toml");
  const std::string base = file["base"].value_or("");
  Trial trial{.experiment = file["experiment"].value_or(kFiveOnAPath), .settings = {}};
  for (const auto& [key, lines] : *file["keys"].as_table()) {
    const auto* two = lines.as_array();
    trial.settings.push_back({std::string(key.str()), two != nullptr ? two->at(0).value_or("") : base,
                              two != nullptr ? two->at(1).value_or("") : base + lines.value_or("")});
  }
  return trial;
}

Trial TrialOf(std::string_view law) {
  if (law == "custom") return {kFiveOnAPath, CustomSettings()};
  if (law == "octave") return {kFiveOnAPath, OctaveSettings()};
  if (law == "fmu") return {kFiveOnAPath, FmuSettings()};
  if (law == "policy") return {kFiveOnAPath, PolicySettings()};
  if (law == "plugin") return {kFiveOnAPath, PluginSettings()};
  return ReadTrial(law);
}

std::string With(const Trial& trial, std::string_view law, const std::string& lines) {
  return trial.experiment + "[law]\nname = '" + std::string(law) + "'\n" + lines;
}

TEST(LawTable, HasTheLawOfEveryFileThatDefinesOne) {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(test::SourceFolder() + "/agent/laws"))
    if (entry.path().extension() == ".cc" && ReadFile(entry.path()).find("\nLawEntry ") != std::string::npos)
      files.push_back(entry.path().stem());
  EXPECT_THAT(files, ::testing::UnorderedElementsAreArray(LawNames()));
  EXPECT_EQ(LawNames().front(), "consensus") << "the default of law.name";
}

TEST(LawTable, NamesOnlyParametersWhoseChangeChangesTheResultAndAllOfThem) {
  for (const LawEntry& law : Laws()) {
    std::vector<std::string> tried;
    const Trial trial = TrialOf(law.name);
    for (const Setting& setting : trial.settings) {
      IdealNetwork base(With(trial, law.name, setting.base));
      IdealNetwork changed(With(trial, law.name, setting.changed));
      base.RunUntil(20);
      changed.RunUntil(20);
      double difference = 0;
      for (std::size_t i = 0; i < base.motions.size(); ++i)
        difference += (base.motions[i].p_WB - changed.motions[i].p_WB).norm();
      EXPECT_GT(difference, 1e-4) << law.name << " " << setting.parameter;
      tried.push_back(setting.parameter);
    }
    // These are tested in actions_test.cc, custom_law_test.cc, custom_text_test.cc, fmu_test.cc, octave_law_test.cc,
    // policy_test.cc and plugin_law_test.cc: files, messages, places of errors.
    const std::vector<std::string_view> elsewhere = {"file",      "fmu_file",    "message",
                                                     "messages",  "octave_file", "octave_line",
                                                     "onnx_file", "python_file", "python_line"};
    std::vector<std::string> named;
    for (const Key& parameter : law.parameters)
      if (std::ranges::find(elsewhere, parameter.name) == elsewhere.end()) named.emplace_back(parameter.name);
    EXPECT_THAT(tried, ::testing::UnorderedElementsAreArray(named)) << law.name;
  }
}

/// The law table of the resolved experiment.
Value::Table LawOf(const std::string& toml) {
  Section document = Section::FromText(toml, "test.toml");
  LoadExperiment(document, "test");
  return Section::FromText(document.Resolved(), "test.toml").Child("law").InTheFile();
}

/// The keys of [law] in which the second experiment differs from the first, and their values in it; nullopt: not all of
/// them are live.
std::optional<std::map<std::string, Value>> LiveDifference(const std::string& law, const std::string& first,
                                                           const std::string& second) {
  const Value::Table before = LawOf(first), after = LawOf(second);
  const std::vector<Key> rows = KeysOfLaw(LawTable(), law);
  for (const auto& [key, value] : before)
    if (!after.contains(key)) return std::nullopt;
  std::map<std::string, Value> set;
  for (const auto& [key, value] : after) {
    if (const auto was = before.find(key); was != before.end() && was->second == value) continue;
    const Key* row = FindRow(rows, key);
    if (row == nullptr || !row->live || row->kind == ValueKind::kAny) return std::nullopt;
    set["law." + key] = value;
  }
  return set;
}

/// Positions of all agents after three seconds, or why the experiment is not valid.
std::string FlightOf(const std::function<Experiment()>& experiment) {
  try {
    IdealNetwork network(experiment());
    network.RunUntil(3);
    std::string places;
    for (const Motion& motion : network.motions)
      for (const double coordinate : motion.p_WB) places += ShortestFloat(coordinate) + " ";
    return places;
  } catch (const ConfigError& error) {
    return error.mistakes().front().substr(error.mistakes().front().find(": "));
  }
}

TEST(LawTable, HasLiveKeysWhoseEventsMakeTheExperimentOfTheFileThatHasTheirValues) {
  for (const LawEntry& law : Laws()) {
    const std::string name(law.name);
    const Trial trial = TrialOf(name);
    std::set<std::string> tried;
    for (const Setting& setting : trial.settings) {
      const std::string base = With(trial, name, setting.base), changed = With(trial, name, setting.changed);
      const auto set = LiveDifference(name, base, changed);
      if (!set || set->empty()) continue;
      const Experiment start = LoadExperiment(Section::FromText(base, "test.toml"), "test");
      std::string own;
      for (const auto& [key, value] : *set) {
        tried.insert(key);
        own += (own.empty() ? "" : ", ") + key.substr(key.find('.') + 1) + " = " + ToToml(value);
      }
      const std::string for_one = base + "[[agents.override]]\nid = 2\nlaw = { " + own + " }\n";
      for (const std::vector<int>& agents : {std::vector<int>(), {2}}) {
        const std::string flown = FlightOf([&] {
          LiveExperiment live(start, &LawTable(), /*checked=*/false);
          return *live.After({.tick = 1, .set = *set, .agents = agents, .where = "test"});
        });
        const std::string of_file = FlightOf(
            [&] { return LoadExperiment(Section::FromText(agents.empty() ? changed : for_one, "test.toml"), "test"); });
        EXPECT_EQ(flown, of_file) << name << ", " << agents.size() << " agents: " << own;
      }
    }
    for (const Key& row : law.parameters) {
      if (!row.live || row.kind == ValueKind::kAny) continue;
      EXPECT_TRUE(tried.contains("law." + std::string(row.name))) << name << ": " << row.name;
    }
  }
}

TEST(LawTable, ListsTheRightDefaults) {
  for (const LawEntry& law : Laws()) {
    const Trial trial = TrialOf(law.name);
    for (const Key& parameter : law.parameters) {
      if (parameter.fallback.empty()) continue;
      std::string lines;  // [law] with the parameter at its default
      for (const Setting& setting : trial.settings)
        if (setting.parameter == parameter.name) lines = setting.base;
      Section document = Section::FromText(With(trial, law.name, lines), "test.toml");
      LoadExperiment(document, "test");
      const std::string line = "\n" + std::string(parameter.name) + " = " + std::string(parameter.fallback) + "\n";
      EXPECT_THAT(document.Resolved(), HasSubstr(line)) << law.name;
    }
  }
}

TEST(LawTable, ListsTheRequiredParameters) {
  for (const LawEntry& law : Laws()) {
    std::vector<std::string> required;
    for (const Key& parameter : law.parameters) {
      if (parameter.required) required.push_back("law." + std::string(parameter.name) + ": ");
    }
    std::vector<std::string> mistakes = Mistakes(With(TrialOf(law.name), law.name, ""));
    std::erase_if(mistakes, [](const std::string& mistake) {  // the user chooses one of two keys
      return mistake.ends_with(", got none");
    });
    ASSERT_EQ(mistakes.size(), required.size()) << law.name;
    for (const std::string& key : required) EXPECT_THAT(mistakes, ::testing::Contains(HasSubstr(key)));
  }
}

TEST(LawTable, ReproducesTheLawFromTheResolvedFile) {
  for (const LawEntry& law : Laws()) {
    const Trial trial = TrialOf(law.name);
    for (const Setting& setting : trial.settings) {
      Section document = Section::FromText(With(trial, law.name, setting.changed), "test.toml");
      LoadExperiment(document, "test");
      IdealNetwork original(With(trial, law.name, setting.changed));
      IdealNetwork again(document.Resolved());
      original.RunUntil(5);
      again.RunUntil(5);
      for (std::size_t i = 0; i < original.motions.size(); ++i)
        EXPECT_EQ(original.motions[i].p_WB, again.motions[i].p_WB) << setting.changed;
    }
  }
}

// --- what rows promise --------------------------------------------------------------------------------

/// Calls `look` with an experiment for each way in which a law is tried, and with its row.
void ForEachTrial(const std::function<void(const LawEntry& law, const std::string& toml)>& look) {
  for (const LawEntry& law : Laws()) {
    const Trial trial = TrialOf(law.name);
    for (const Setting& setting : trial.settings)
      for (const std::string& lines : {setting.base, setting.changed}) {
        SCOPED_TRACE(std::string(law.name) + ", " + setting.parameter + ":\n" + lines);
        look(law, With(trial, law.name, lines));
      }
  }
}

/// Puts the agents at random positions with random velocities, along law.axes.
void PutAnywhere(IdealNetwork& network, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> coordinate(-5, 5);
  for (Motion& motion : network.motions)
    for (int axis = 0; axis < CountOf(network.experiment.law.axes); ++axis) {
      motion.p_WB[axis] = coordinate(random);
      motion.v_WB[axis] = coordinate(random) / 5;
    }
}

TEST(LawTable, WantsWhatItsRowsSay) {
  ForEachTrial([](const LawEntry& /*law*/, const std::string& toml) {
    IdealNetwork network(toml);
    for (const auto& law : network.laws) EXPECT_EQ(law->wanted(), WantedBy(network.experiment.law));
  });
}

/// What an agent wants, by the linear form of its law.
Eigen::Vector3d WantedByForm(const LinearForm& form, IdealNetwork& network, int id) {
  const std::span<const Eigen::Vector3d> places_W = PlacesOf(network.experiment.law);
  const auto q_W = [&](int k) -> Eigen::Vector3d {
    const Eigen::Vector3d p_W = network.agent(k).p_WB;
    return places_W.empty() ? p_W : p_W - places_W[static_cast<std::size_t>(k - 1)];
  };
  const Motion& self = network.agent(id);
  Eigen::Vector3d wanted_W = -form.beta * self.v_WB;
  for (const Graph::Neighbour& j : network.experiment.graph.HeardBy(id)) {
    wanted_W += j.weight * form.p * (q_W(j.id) - q_W(id));
    wanted_W += j.weight * form.g * (network.agent(j.id).v_WB - self.v_WB);
  }
  if (network.experiment.law.axes == Axes::kXy) wanted_W.z() = 0;
  return wanted_W;
}

TEST(LawTable, IsAsLinearAsItsRowsSay) {
  std::set<std::string_view> linear;
  ForEachTrial([&](const LawEntry& law, const std::string& toml) {
    IdealNetwork network(toml);
    const LawConfig& config = network.experiment.law;
    const std::optional<LinearForm> form = LinearFormOf(config);
    if (!form || !form->listens) return;
    linear.insert(law.name);
    for (unsigned seed = 1; seed <= 3; ++seed) {
      PutAnywhere(network, seed);
      const std::vector<Eigen::Vector3d> wants_W = network.Wants();
      for (int id = 1; id <= network.experiment.size(); ++id) {
        const Eigen::Vector3d& wants = wants_W[static_cast<std::size_t>(id - 1)];
        if (id != config.leader) {
          EXPECT_LT((wants - WantedByForm(*form, network, id)).norm(), 1e-9) << "agent " << id;
        } else if (!form->leader_flies) {
          EXPECT_EQ(wants.norm(), 0) << "the leader";
        }
      }
    }
  });
  EXPECT_THAT(linear, ::testing::IsSupersetOf({"consensus", "formation", "velocity_consensus"}));
}

TEST(LawTable, PursuesWithinTheBoundsAndOnTheTreeOfItsRows) {
  int pursuits = 0;
  ForEachTrial([&](const LawEntry& /*law*/, const std::string& toml) {
    IdealNetwork network(toml);
    const std::optional<PursuitForm> form = PursuitFormOf(network.experiment.law);
    if (!form) return;
    ++pursuits;
    PutAnywhere(network, 1);
    const std::vector<Eigen::Vector3d> wants_W = network.Wants();
    for (std::size_t i = 0; i < wants_W.size(); ++i)
      EXPECT_LE(wants_W[i].cwiseAbs().maxCoeff(), form->beta[i] * (1 + 1e-12)) << "agent " << i + 1;
    for (int moved = 1; moved <= network.experiment.size(); ++moved) {  // only its children mind where an agent is
      IdealNetwork other(toml);
      PutAnywhere(other, 1);
      other.agent(moved).p_WB += Eigen::Vector3d(100, 100, 0);
      const std::vector<Eigen::Vector3d> others_W = other.Wants();
      for (std::size_t i = 0; i < others_W.size(); ++i)
        EXPECT_TRUE(form->parent[i] == moved || static_cast<int>(i) + 1 == moved || others_W[i] == wants_W[i])
            << "agent " << i + 1 << " when " << moved << " moves";
    }
  });
  EXPECT_GT(pursuits, 0);
}

/// Positions of all agents after some seconds, with another seed.
std::vector<Eigen::Vector3d> FlownWith(const std::string& toml, int seed) {
  std::string text = toml;
  text.replace(text.find("[run]\n"), 6, "[run]\nseed = " + std::to_string(seed) + "\n");
  IdealNetwork network(text);
  network.RunUntil(3);
  std::vector<Eigen::Vector3d> places_W;
  for (const Motion& motion : network.motions) places_W.push_back(motion.p_WB);
  return places_W;
}

TEST(LawTable, DrawsOnlyWhereItsRowsSay) {
  ForEachTrial([](const LawEntry& law, const std::string& toml) {
    if (law.is_of_user || toml.find("[run]\n") == std::string::npos || toml.find("seed") != std::string::npos) return;
    const bool draws = law.draws != nullptr && law.draws(IdealNetwork(toml).experiment.law);
    EXPECT_EQ(FlownWith(toml, 1) != FlownWith(toml, 2), draws);
  });
}

TEST(LawTable, MindsWhatItSeesOfObstaclesOnlyWhereItsRowsSaySo) {
  std::map<std::string_view, bool> minds;
  ForEachTrial([&](const LawEntry& law, const std::string& toml) {
    if (law.is_of_user) return;  // as its user likes
    const std::string with_sensor = "[sensors]\nrange_m = 5.0\n" + toml;
    const std::string text = Mistakes(with_sensor).empty() ? with_sensor : toml;
    IdealNetwork blind(text), seeing(text);
    std::vector<std::vector<Eigen::Vector3d>> nearest_W;  // lives until the laws have answered
    for (std::size_t i = 0; i < seeing.laws.size(); ++i) {
      nearest_W.push_back({seeing.motions[i].p_WB + Eigen::Vector3d(0.4, 0.1, 0)});
      blind.laws[i]->See({});
      seeing.laws[i]->See(nearest_W.back());
    }
    for (IdealNetwork* network : {&blind, &seeing}) network->ranges.assign(network->motions.size(), RangeSensor(0, {}));
    minds[law.name] = minds[law.name] || blind.Wants() != seeing.Wants();
  });
  // Those that see obstacles may do so only with keys that no trial has.
  for (const auto& [name, does] : minds)
    EXPECT_TRUE(!does || std::ranges::find(Laws(), name, &LawEntry::name)->sees_obstacles) << name;
  EXPECT_TRUE(minds.at("avoidance"));
}

}  // namespace
}  // namespace mascot

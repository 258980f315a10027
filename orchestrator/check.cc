// `orchestrator check CONFIG`: validates, and says what theory expects. Starts nothing.
#include <spdlog/fmt/fmt.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "orchestrator/config_args.h"
#include "orchestrator/graph_facts.h"
#include "orchestrator/theory.h"
#include "orchestrator/verb.h"

namespace mascot {
namespace {

using Json = nlohmann::ordered_json;

std::map<std::string, int> CountModels(const Experiment& experiment) {
  std::map<std::string, int> count;
  for (const AgentConfig& agent : experiment.agents) ++count[agent.model];
  return count;
}

template <class Value>
Json OrNull(const std::optional<Value>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json ToJson(const GraphFacts& facts) {
  return {{"edges", facts.edges},           {"symmetric", facts.symmetric}, {"lambda_2", OrNull(facts.lambda_2)},
          {"components", facts.components}, {"roots", facts.roots},         {"tree_root", facts.tree_root},
          {"spanning_tree", facts.tree}};
}

Json ToJson(const Prediction& prediction) {
  Json edges = Json::array();
  for (const MinmaxEdge& edge : prediction.minmax_edges) {
    edges.push_back({{"child", edge.child}, {"parent", edge.parent}, {"time_s", edge.time_s}, {"exact", edge.exact}});
  }
  const auto& value_m = prediction.value_m;
  return {{"value_m", value_m ? Json{value_m->x(), value_m->y(), value_m->z()} : Json(nullptr)},
          {"stable", OrNull(prediction.stable)},
          {"settling_time_s", OrNull(prediction.settling_time_s)},
          {"minmax_time_s", OrNull(prediction.minmax_time_s)},
          {"minmax_edges", edges},
          {"first_command_m_per_s2", OrNull(prediction.first_command_m_per_s2)}};
}

Json ToJson(const Experiment& experiment, const GraphFacts& facts, const Prediction& prediction) {
  return {{"experiment", experiment.run.name}, {"duration_s", experiment.run.duration_s},
          {"ticks", experiment.ticks()},       {"control_rate_hz", experiment.control.rate_hz},
          {"agents", experiment.size()},       {"models", CountModels(experiment)},
          {"law", experiment.law.name},        {"axes", experiment.law.axes == Axes::kXyz ? "xyz" : "xy"},
          {"leader", experiment.law.leader},   {"graph", ToJson(facts)},
          {"predicted", ToJson(prediction)},   {"warnings", prediction.warnings}};
}

void PrintLine(std::string_view label, std::string_view text) { std::cout << fmt::format("  {:<15}{}\n", label, text); }

void PrintExperiment(const Experiment& experiment) {
  std::string models;
  for (const auto& [model, count] : CountModels(experiment)) {
    models += fmt::format("{}{} {}", models.empty() ? "" : ", ", count, model);
  }
  const int leader = experiment.law.leader;
  PrintLine("experiment", experiment.run.name);
  PrintLine("agents", models);
  PrintLine("law", fmt::format("{}, {}, axes {}", experiment.law.name,
                               leader > 0 ? fmt::format("leader {}", leader) : "no leader",
                               experiment.law.axes == Axes::kXyz ? "xyz" : "xy"));
  PrintLine("duration", fmt::format("{:g} s, {} ticks at {} Hz", experiment.run.duration_s, experiment.ticks(),
                                    experiment.control.rate_hz));
}

void PrintGraph(const GraphFacts& facts) {
  PrintLine("graph", fmt::format("{} edges, {}", facts.edges, facts.symmetric ? "symmetric" : "directed"));
  if (facts.lambda_2) PrintLine("lambda_2", fmt::format("{:.6g}", *facts.lambda_2));
  PrintLine("components", fmt::format("{} strongly connected", facts.components.size()));
  PrintLine("roots", facts.roots.empty() ? "none: no spanning tree" : IdRanges(facts.roots));
}

void PrintPrediction(const Experiment& experiment, const Prediction& prediction) {
  const bool chains = !experiment.graph.IsSymmetric();  // their modes do not stay apart
  if (const auto& value_m = prediction.value_m) {
    PrintLine("meeting point", fmt::format("({:.4g}, {:.4g}, {:.4g}) m{}", value_m->x(), value_m->y(), value_m->z(),
                                           experiment.law.axes == Axes::kXy ? ", heights held" : ""));
  }
  if (prediction.stable) PrintLine("stable", *prediction.stable ? "yes" : "no");
  if (prediction.settling_time_s)
    PrintLine("settles in", fmt::format("{:.4g} s (2 %, slowest mode{})", *prediction.settling_time_s,
                                        chains ? "; later along chains" : ""));
  for (const MinmaxEdge& edge : prediction.minmax_edges) {
    PrintLine(fmt::format("edge {} -> {}", edge.child, edge.parent),
              fmt::format("{} {:.4g} s", edge.exact ? "meets in" : "meets within", edge.time_s));
  }
  if (prediction.first_command_m_per_s2) {
    PrintLine("first command", fmt::format("{:.4g} m/s^2 of {:g} allowed", *prediction.first_command_m_per_s2,
                                           *prediction.first_command_limit_m_per_s2));
  }
}

int Check(const ConfigArgs& args, bool json) {
  Experiment experiment = args.Load();
  const GraphFacts facts = FactsOf(experiment.graph, experiment.law.leader);
  const Prediction prediction = Predict(experiment);
  if (json) {
    std::cout << ToJson(experiment, facts, prediction).dump(2) << "\n";
    return 0;
  }
  std::cout << args.path << ": valid\n";
  PrintExperiment(experiment);
  PrintGraph(facts);
  PrintPrediction(experiment, prediction);
  for (const std::string& warning : prediction.warnings) std::cout << "warning: " << warning << "\n";
  return 0;
}

}  // namespace

std::function<int()> SetUpCheck(CLI::App& command) {
  const auto args = std::make_shared<ConfigArgs>();
  const auto json = std::make_shared<bool>(false);
  args->AddTo(command);
  command.add_flag("--json", *json, "print JSON and nothing else");
  return [args, json] { return Check(*args, *json); };
}

}  // namespace mascot

// `orchestrator graph CONFIG`: prints the graph of an experiment: matrices, eigenvalues, components, spanning tree.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "experiment/agent_ids.h"
#include "orchestrator/report/dot.h"
#include "orchestrator/report/json.h"
#include "orchestrator/theory/graph_facts.h"
#include "orchestrator/theory/theory.h"
#include "orchestrator/verbs/config_args.h"
#include "orchestrator/verbs/verb.h"

namespace mascot {
namespace {

constexpr int kLargestPrinted = 40;  // agents; wider matrices do not fit on a screen

Eigen::MatrixXd Adjacency(const Graph& graph) {
  Eigen::MatrixXd a = -graph.Laplacian();
  a.diagonal().setZero();
  return a.array() + 0.0;  // -0 becomes 0
}

Json Rows(const Eigen::MatrixXd& matrix) {
  Json rows = Json::array();
  for (const auto& row : matrix.rowwise()) rows.push_back(std::vector<double>(row.begin(), row.end()));
  return rows;
}

/// The graphs of the schedule; edges as in [[graph.schedule]]: [i, j, weight], where i hears j.
Json Phases(const Schedule& schedule) {
  Json phases = Json::array();
  for (const Schedule::Phase& phase : schedule.phases()) {
    Json edges = Json::array();
    for (int id = 1; id <= phase.graph.size(); ++id)
      for (const Graph::Neighbour& heard : phase.graph.HeardBy(id)) edges.push_back({id, heard.id, heard.weight});
    phases.push_back({{"at_s", phase.at_s}, {"edges", edges}});
  }
  return phases;
}

Json PositiveOrNull(double value) { return value > 0 ? Json(value) : Json(nullptr); }

Json ToJson(const Experiment& experiment, const GraphFacts& facts) {
  const Graph& graph = experiment.graph;
  Json json = {{"agents", graph.size()}, {"edges", facts.edges}, {"symmetric", facts.symmetric}};
  if (graph.size() <= kLargestSpectrum) {
    json["adjacency"] = Rows(Adjacency(graph));
    json["laplacian"] = Rows(graph.Laplacian());
    json["eigenvalues"] = Json::array();
    for (const auto& lambda : graph.Eigenvalues()) json["eigenvalues"].push_back({lambda.real(), lambda.imag()});
    json["lambda_2"] = *facts.lambda_2;
  }
  json["components"] = facts.components;
  json["roots"] = facts.roots;
  json["tree_root"] = facts.tree_root;
  json["spanning_tree"] = facts.tree;
  json["schedule"] = Phases(experiment.schedule);
  json["repeat_s"] = PositiveOrNull(experiment.schedule.repeat_s());
  json["range_m"] = PositiveOrNull(experiment.schedule.range_m());
  return json;
}

void PrintMatrix(std::string_view title, const Eigen::MatrixXd& matrix) {
  std::size_t width = 1;
  for (const double value : matrix.reshaped()) width = std::max(width, fmt::format("{:.4g}", value).size());
  std::cout << title << "\n";
  for (const auto& row : matrix.rowwise()) {
    std::cout << " ";
    for (const double value : row) std::cout << fmt::format(" {:>{}}", fmt::format("{:.4g}", value), width);
    std::cout << "\n";
  }
}

void PrintSpectrum(const Graph& graph) {
  std::cout << "eigenvalues of the laplacian\n ";
  for (const auto& lambda : graph.Eigenvalues()) {
    std::cout << " " << fmt::format("{:.6g}", std::abs(lambda.real()) < 1e-12 ? 0.0 : lambda.real());
    if (lambda.imag() != 0) std::cout << fmt::format("{:+.6g}i", lambda.imag());
  }
  std::cout << "\n";
}

void PrintTree(const GraphFacts& facts) {
  if (facts.tree_root == 0) {
    std::cout << "spanning tree  none\n";
    return;
  }
  std::cout << "spanning tree  root " << facts.tree_root << "; follows:";
  for (std::size_t i = 0; i < facts.tree.size(); ++i) {
    if (facts.tree[i] != 0) std::cout << " " << i + 1 << "->" << facts.tree[i];
  }
  std::cout << "\n";
}

/// Text on when edges work (schedule, range); empty: all the time.
std::string WhenEdgesWork(const Schedule& schedule) {
  std::string text;
  if (schedule.phases().size() > 1) {
    text = fmt::format("union of {} graphs that take turns, from", schedule.phases().size());
    for (const Schedule::Phase& phase : schedule.phases())
      text += fmt::format("{} {}", &phase == schedule.phases().data() ? "" : ",", phase.at_s);
    text += " s";
    if (schedule.repeat_s() > 0) text += fmt::format(", again every {} s", schedule.repeat_s());
  }
  if (schedule.range_m() > 0)
    text += fmt::format("{}edges work within {} m", text.empty() ? "" : "; ", schedule.range_m());
  return text;
}

void Print(const Graph& graph, const GraphFacts& facts, const Schedule& schedule) {
  std::cout << fmt::format("{} agents, {} edges, {}\n", graph.size(), facts.edges,
                           facts.symmetric ? "symmetric" : "directed");
  if (const std::string when = WhenEdgesWork(schedule); !when.empty()) std::cout << when << "\n";
  if (graph.size() <= kLargestPrinted) {
    PrintMatrix("adjacency (row i: the agents that agent i hears)", Adjacency(graph));
    PrintMatrix("laplacian", graph.Laplacian());
    PrintSpectrum(graph);
  }
  if (facts.lambda_2) std::cout << fmt::format("lambda_2       {:.6g}\n", *facts.lambda_2);
  std::cout << "components    ";
  for (const auto& component : facts.components) std::cout << " {" << IdRanges(component) << "}";
  std::cout << "\nroots          " << (facts.roots.empty() ? "none" : IdRanges(facts.roots)) << "\n";
  PrintTree(facts);
}

int ShowGraph(ConfigArgs& args, bool json, bool dot) {
  const Experiment experiment = args.Load(UserCode::kNeverRuns);
  if (dot) {
    std::cout << ToDot(experiment.graph, experiment.law.leader, WhenEdgesWork(experiment.schedule));
    return 0;
  }
  const GraphFacts facts = FactsOf(experiment.graph, experiment.law.leader);
  if (json) {
    std::cout << JsonText(ToJson(experiment, facts));
  } else {
    Print(experiment.graph, facts, experiment.schedule);
  }
  return 0;
}

}  // namespace

std::function<int()> SetUpGraph(CLI::App& command) {
  const auto args = std::make_shared<ConfigArgs>();
  const auto json = std::make_shared<bool>(false), dot = std::make_shared<bool>(false);
  args->AddTo(command);
  command.add_flag("--json", *json, "print JSON and nothing else");
  command.add_flag("--dot", *dot, "print the graph for Graphviz and nothing else")->excludes("--json");
  return [args, json, dot] { return ShowGraph(*args, *json, *dot); };
}

}  // namespace mascot

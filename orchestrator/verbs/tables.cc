// `orchestrator laws [NAME]` and `orchestrator models`: print the laws and models that an experiment may name.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <memory>

#include "agent/laws/laws.h"
#include "experiment/model_traits.h"
#include "orchestrator/report/json.h"
#include "orchestrator/verbs/one_of.h"
#include "orchestrator/verbs/print_wrapped.h"
#include "orchestrator/verbs/verb.h"

namespace mascot {
namespace {

Json ToJson(const LawEntry& law) {
  const auto symbol_of = [&](const Key& parameter) -> Json {
    const auto symbol = std::ranges::find(law.symbols, parameter.name, &KeySymbol::key);
    return symbol == law.symbols.end() ? Json() : Json(symbol->tex);
  };
  Json parameters = Json::array();
  for (const Key& parameter : law.parameters) {
    parameters.push_back({{"name", parameter.name},
                          {"symbol", symbol_of(parameter)},
                          {"required", parameter.required},
                          {"default", DefaultJson(parameter)},
                          {"range", ValueText(parameter)},
                          {"live", parameter.live},
                          {"meaning", parameter.meaning}});
  }
  Json figures = Json::array();
  for (const LawFigure& figure : law.figures)
    figures.push_back({{"name", figure.name}, {"each", figure.each}, {"meaning", figure.meaning}});
  return {{"name", law.name},         {"summary", law.summary}, {"equation", law.equation},
          {"tex", FormulasOf(law)},   {"graph", law.graph},     {"details", law.details},
          {"theory", law.theory},     {"source", law.source},   {"axes", kAxes.Name(law.axes)},
          {"parameters", parameters}, {"figures", figures}};
}

void Print(const LawEntry& law) {
  std::cout << law.name << "\n";
  PrintWrapped("", law.summary, 2);
  PrintWrapped("  equation", law.equation, 12);
  for (const std::string_view paragraph : DetailsOf(law)) PrintWrapped("", paragraph, 12);
  PrintWrapped("  graph", law.graph, 12);
  PrintWrapped("  theory", law.theory, 12);
  PrintWrapped("  source", law.source, 12);
  PrintWrapped(
      "", fmt::format("keys of [law]; axes = \"{}\" unless said otherwise; * required, ~ live", kAxes.Name(law.axes)),
      2);
  for (const Key& parameter : law.parameters) {
    const std::string_view mark = parameter.required ? "*" : parameter.fallback.empty() ? "" : " = ";
    const std::string key =
        fmt::format("{}{}{}{}", parameter.name, parameter.live ? "~" : "", mark, parameter.fallback);
    PrintWrapped("", fmt::format("{:<30} {}", key, ValueText(parameter)), 4);
    PrintWrapped("", parameter.meaning, 8);
  }
  if (!law.figures.empty()) std::cout << "  figures of its own, in summary.json and sweeps\n";
  for (const LawFigure& figure : law.figures) {
    const std::string each = figure.each.empty() ? "" : fmt::format(", for each {}", figure.each);
    PrintWrapped(fmt::format("    {:<30} ", figure.name), std::string(figure.meaning) + each, 35);
  }
}

/// The laws to show: the one called `name`, or all if that is empty. Throws ConfigError for a name that is none.
std::span<const LawEntry> LawsCalled(const std::string& name) {
  if (name.empty()) return Laws();
  RequireOneOf("laws", "a law", name, LawNames());
  return {std::ranges::find(Laws(), name, &LawEntry::name), 1};
}

int ShowLaws(const std::string& name, bool json) {
  const std::span<const LawEntry> laws = LawsCalled(name);
  Json table = Json::array();
  for (const LawEntry& law : laws) {
    if (json) {
      table.push_back(ToJson(law));
    } else {
      std::cout << (law.name == laws.front().name ? "" : "\n");
      Print(law);
    }
  }
  if (json) std::cout << JsonText(table);
  return 0;
}

int ShowModels(bool json) {
  Json table = Json::array();
  for (const ModelTraits& model : Models()) {
    if (json) {
      table.push_back({{"name", model.name}, {"summary", model.summary}, {"actuator", model.actuator}});
    } else {
      std::cout << fmt::format("{}\n  {}\n  actuator  {}\n", model.name, model.summary, model.actuator);
    }
  }
  if (json) std::cout << JsonText(table);
  return 0;
}

struct TableArgs {
  std::string name;
  bool json = false;
};

std::shared_ptr<TableArgs> AddJsonFlag(CLI::App& command) {
  auto args = std::make_shared<TableArgs>();
  command.add_flag("--json", args->json, "print JSON and nothing else");
  return args;
}

}  // namespace

std::function<int()> SetUpLaws(CLI::App& command) {
  const auto args = AddJsonFlag(command);
  command.add_option("name", args->name, "the law to show (default: all)")->type_name("NAME");
  return [args] { return ShowLaws(args->name, args->json); };
}

std::function<int()> SetUpModels(CLI::App& command) {
  const auto args = AddJsonFlag(command);
  return [args] { return ShowModels(args->json); };
}

}  // namespace mascot

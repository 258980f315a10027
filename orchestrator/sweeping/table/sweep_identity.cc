#include "orchestrator/sweeping/table/sweep_identity.h"

#include <algorithm>
#include <map>

#include "orchestrator/formats/outside_json.h"
#include "orchestrator/sweeping/table/metrics.h"
#include "orchestrator/sweeping/table/sweep_json.h"
#include "orchestrator/sweeping/table/table.h"

namespace mascot {

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(SweepPlan::Words, sets, randoms, samples, seeds, zip)

namespace {

constexpr int kPlanFormat = 2;

/// Known laws, each with the runs that have it: there may be many runs, but of few laws.
nlohmann::json ToJson(const KnownLaws& known) {
  std::map<nlohmann::json, std::vector<std::size_t>> runs_of;
  for (const auto& [run, laws] : known.of_run) runs_of[laws].push_back(run);
  nlohmann::json list = nlohmann::json::array();
  for (auto& [laws, runs] : runs_of) {
    std::ranges::sort(runs);
    list.push_back({{"laws", laws}, {"runs", runs}});
  }
  return {{"alike_in_values", known.alike == SweepPlan::Alike::kInValues}, {"known", list}};
}

KnownLaws KnownLawsFrom(const nlohmann::json& json) {
  KnownLaws known;
  known.alike = json.at("alike_in_values") ? SweepPlan::Alike::kInValues : SweepPlan::Alike::kInWords;
  for (const nlohmann::json& entry : json.at("known"))
    for (const std::size_t run : entry.at("runs")) known.of_run[run] = entry.at("laws").get<RunLaws>();
  return known;
}

}  // namespace

std::string SweepIdentity::Text() const {
  nlohmann::json json;
  json["format"] = kPlanFormat;
  json["build"] = build;
  json["experiment"] = experiment;
  json["first_run"] = first_run;
  json["metric_file"] = metric_file;
  json["plan"] = words;
  json["metrics"] = own;
  json["law_names"] = law_names;
  json["laws"] = ToJson(laws);
  if (!search.empty()) json["search"] = search;
  return json.dump(1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

std::optional<SweepIdentity> SweepIdentity::FromText(const std::string& text) {
  try {
    const auto json = ReadJson<nlohmann::json>(text);
    if (json.at("format") != kPlanFormat) return std::nullopt;
    return SweepIdentity{.build = json.at("build"),
                         .experiment = json.at("experiment"),
                         .first_run = json.at("first_run"),
                         .metric_file = json.at("metric_file"),
                         .words = json.at("plan").get<SweepPlan::Words>(),
                         .own = json.at("metrics").get<std::vector<PythonMetric>>(),
                         .law_names = json.at("law_names"),
                         .laws = KnownLawsFrom(json.at("laws")),
                         .search = json.value("search", "")};
  } catch (const nlohmann::json::exception&) {
    return std::nullopt;
  } catch (const JsonError&) {
    return std::nullopt;
  }
}

std::vector<std::string> SweepIdentity::Metrics() const {
  std::vector<std::string> metrics = SweepMetricNames(law_names);
  for (const PythonMetric& metric : own) metrics.insert(metrics.end() - kWallClockColumns, metric.name);
  return metrics;
}

std::vector<std::string> SweepColumns(const SweepPlan& plan, const std::vector<std::string>& metrics) {
  std::vector<std::string> columns{"run"};
  columns.insert(columns.end(), plan.keys().begin(), plan.keys().end());
  columns.emplace_back(kErrorColumn);
  columns.insert(columns.end(), metrics.begin(), metrics.end());
  return columns;
}

}  // namespace mascot

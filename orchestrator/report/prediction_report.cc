#include "orchestrator/report/prediction_report.h"

#include <fmt/format.h>

namespace mascot {
namespace {

Json ToJson(const std::optional<Persistence>& persistence) {
  if (!persistence) return nullptr;
  return {{"joint", persistence->joint},
          {"always", persistence->always},
          {"never_alone", persistence->never_alone},
          {"window_s", OrNull(persistence->window_s)},
          {"from_s", OrNull(persistence->from_s)},
          {"in_range_at_start", OrNull(persistence->in_range_at_start)}};
}

Json ToJson(const std::optional<Trembling>& trembling) {
  if (!trembling) return nullptr;
  return {{"lag_s", trembling->lag_s}, {"radius_m", trembling->radius_m}, {"time_s", OrNull(trembling->time_s)}};
}

Json ToJson(const std::vector<MinmaxEdge>& edges) {
  Json json = Json::array();
  for (const MinmaxEdge& edge : edges)
    json.push_back({{"child", edge.child},
                    {"parent", edge.parent},
                    {"time_s", edge.time_s},
                    {"exact", edge.exact},
                    {"trembling", ToJson(edge.trembling)}});
  return json;
}

std::string SecondsText(double time_s) { return fmt::format("{:.4g} s", time_s); }

/// Text on both delay margins, as far as they are known.
std::string DelayText(const Prediction& prediction) {
  std::string text;
  if (const auto& margin = prediction.delay_margin)
    text = margin->independent ? "of neighbours' samples: any"
                               : "of neighbours' samples: below " + SecondsText(*margin->margin_s);
  if (prediction.own_delay_margin_s)
    text += fmt::format("{}of these and the own: below {}", text.empty() ? "" : "; ",
                        SecondsText(*prediction.own_delay_margin_s));
  return text;
}

/// "meets in 8.5 s; with a lag of 0.06 s it trembles by 0.01 m, within 0.02 m from 8.1 s on"
std::string EdgeText(const MinmaxEdge& edge) {
  std::string text = fmt::format("{} {}", edge.exact ? "meets in" : "meets within", SecondsText(edge.time_s));
  if (!edge.trembling) return text;
  const Trembling& trembling = *edge.trembling;
  text += fmt::format("; with a lag of {:.2g} s it trembles by {:.2g} m", trembling.lag_s, trembling.radius_m);
  if (trembling.time_s)
    text += fmt::format(", within {:.2g} m from {} on", 2 * trembling.radius_m, SecondsText(*trembling.time_s));
  return text;
}

}  // namespace

std::string RateBasis(const Prediction& prediction) {
  if (prediction.rate_per_s == prediction.slowest_rate_per_s) return "slowest mode";
  if (!prediction.slowest_rate_per_s) return "from this start";
  return fmt::format("from this start; slowest mode {:.4g}", *prediction.slowest_rate_per_s);
}

std::string SlowestRateText(const Prediction& prediction) {
  return fmt::format("in the long run at {:.4g} 1/s or faster (slowest mode)", *prediction.slowest_rate_per_s);
}

std::string SettlingBasis(const Experiment& experiment, const Prediction& prediction) {
  if (prediction.from_start) return "from this start";
  return experiment.graph.IsSymmetric() ? "slowest mode" : "slowest mode; later along chains";
}

void AddPrediction(const Prediction& prediction, const std::string& prefix, Figures& figures) {
  const auto& margin = prediction.delay_margin;
  const auto add = [&](const char* name, const auto& value) { figures.Add(prefix + name, value); };
  const auto asked = [](const std::optional<FirstCommand>& first) {
    return first ? FigureValue(first->asked) : FigureValue();
  };
  figures.AddVector(prefix + "value_m", prediction.value_m);
  add("on_average", prediction.on_average);
  add("stable", prediction.stable);
  add("slowest_rate_per_s", prediction.slowest_rate_per_s);
  add("from_start", prediction.from_start);
  add("rate_per_s", prediction.rate_per_s);
  add("settling_time_s", prediction.settling_time_s);
  add("control_period_bound_s", prediction.control_period_bound_s);
  add("delay_margin_s", margin ? margin->margin_s : std::nullopt);
  add("delay_independent", margin ? FigureValue(margin->independent) : FigureValue());
  add("own_delay_margin_s", prediction.own_delay_margin_s);
  add("minmax_time_s", prediction.minmax_time_s);
  add("minmax_edges", [&prediction] { return ToJson(prediction.minmax_edges); });
  add("persistence", [&prediction] { return ToJson(prediction.persistence); });
  add("first_command_m_per_s2", asked(prediction.first_acceleration));
  add("first_speed_m_per_s", asked(prediction.first_speed));
  figures.AddWords(prefix + "silent", prediction.silent);
  figures.AddWords(prefix + "figures_silent", prediction.figures_silent);
}

Json PredictionJson(const Prediction& prediction) {
  Figures figures;
  AddPrediction(prediction, "", figures);
  return JsonOf(figures);
}

std::string SafetyText(const SafetyPrediction& safety) {
  if (!safety.silent.empty()) return "no distance, because " + safety.silent;
  if (!safety.min_separation_m) return "nothing: there is one agent";
  return fmt::format("at least {:.4f} m{} (law.safety){}", *safety.min_separation_m,
                     safety.axes == Axes::kXy ? " in the plane" : "",
                     safety.assumes.empty() ? "" : ", if " + safety.assumes);
}

void AddSafetyPrediction(const SafetyPrediction& safety, const std::string& prefix, Figures& figures) {
  figures.Add(prefix + "min_separation_m", safety.min_separation_m);
  // What is kept along the axes is kept in space, too.
  figures.Add(prefix + "min_separation_along_axes_m", safety.min_separation_m);
  figures.AddWords(prefix + "assumes", safety.assumes);
  figures.AddWords(prefix + "silent", safety.silent);
}

Json SafetyPredictionJson(const Prediction& prediction) {
  if (!prediction.safety) return nullptr;
  Figures figures;
  AddSafetyPrediction(*prediction.safety, "", figures);
  return JsonOf(figures);
}

std::vector<std::pair<std::string, std::string>> PredictionLines(const Experiment& experiment,
                                                                 const Prediction& prediction) {
  std::vector<std::pair<std::string, std::string>> lines;
  const std::string average = prediction.on_average ? ", on average" : "";
  if (prediction.persistence && (!experiment.schedule.IsConstant() || !prediction.persistence->always))
    lines.emplace_back("spanning tree", Describe(*prediction.persistence));
  if (const auto& value_m = prediction.value_m)
    lines.emplace_back("meeting point",
                       fmt::format("({:.4g}, {:.4g}, {:.4g}) m{}{}", value_m->x(), value_m->y(), value_m->z(),
                                   experiment.law.axes == Axes::kXy ? ", heights held" : "", average));
  if (prediction.stable) lines.emplace_back("stable", *prediction.stable ? "yes" : "no");
  if (prediction.rate_per_s)
    lines.emplace_back("decays",
                       fmt::format("at {:.4g} 1/s ({}){}", *prediction.rate_per_s, RateBasis(prediction), average));
  else if (prediction.slowest_rate_per_s)
    lines.emplace_back("decays", SlowestRateText(prediction) + average);
  if (prediction.settling_time_s)
    lines.emplace_back("settles in", fmt::format("{} (2 %, {}){}", SecondsText(*prediction.settling_time_s),
                                                 SettlingBasis(experiment, prediction), average));
  if (prediction.control_period_bound_s)
    lines.emplace_back("control period",
                       fmt::format("below {} (now {})", SecondsText(*prediction.control_period_bound_s),
                                   SecondsText(experiment.period_s())));
  if (const std::string delay = DelayText(prediction); !delay.empty()) lines.emplace_back("delay", delay);
  for (const MinmaxEdge& edge : prediction.minmax_edges)
    lines.emplace_back(fmt::format("edge {} -> {}", edge.child, edge.parent), EdgeText(edge));
  if (const auto& first = prediction.first_acceleration)
    lines.emplace_back("first command", fmt::format("{:.4g} m/s^2 of {:g} allowed", first->asked, first->limit));
  if (const auto& first = prediction.first_speed)
    lines.emplace_back("first command", fmt::format("{:.4g} m/s of {:g} allowed", first->asked, first->limit));
  if (prediction.safety) lines.emplace_back("separation", SafetyText(*prediction.safety));
  if (!prediction.figures_silent.empty())
    lines.emplace_back("figures", "not predicted, because " + prediction.figures_silent);
  if (!prediction.silent.empty()) lines.emplace_back("theory", "silent, because " + prediction.silent);
  return lines;
}

}  // namespace mascot

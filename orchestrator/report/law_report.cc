#include "orchestrator/report/law_report.h"

#include <fmt/format.h>

#include <algorithm>

#include "agent/laws.h"

namespace mascot {
namespace {

Json ToJson(const LawFigure& figure, const FigureValues& values) {
  if (figure.each.empty()) return OrNull(values.front());
  Json list = Json::array();
  for (const std::optional<double>& value : values) list.push_back(OrNull(value));
  return list;
}

/// "4.5", "2.1, 4.3, never"
std::string Text(const FigureValues& values) {
  std::string text;
  for (const std::optional<double>& value : values)
    text += (text.empty() ? "" : ", ") + (value ? fmt::format("{:.4g}", *value) : "none");
  return text.empty() ? "none" : text;
}

std::string Text(const PredictedFigure& figure) {
  const std::string_view bound = figure.bound == Bound::kEqual    ? ""
                                 : figure.bound == Bound::kAtMost ? "at most "
                                                                  : "at least ";
  return std::string(bound) + Text(figure.values);
}

/// Whether theory says anything of the figure.
bool Says(const PredictedFigure& figure) {
  return std::ranges::any_of(figure.values, [](const std::optional<double>& value) { return value.has_value(); });
}

/// "; theory: 4.5, +1.2 % off", "; theory: at most 9.3"; empty if theory is silent.
std::string TheoryText(const LawFigure& figure, const FigureValues& measured, const PredictedFigure& predicted) {
  if (!Says(predicted)) return "";
  const std::string text = fmt::format("; theory: {}", Text(predicted));
  const bool comparable = predicted.bound == Bound::kEqual && figure.each.empty() && measured.front();
  const double value = predicted.values.front().value_or(0);
  if (!comparable || value == 0) return text;
  return text + fmt::format(", {:+.3g} % off", 100 * (*measured.front() / value - 1));
}

/// The prediction of figure `k` of `law`; empty if theory is silent.
PredictedFigure Predicted(const Experiment& experiment, const LawEntry& law, std::size_t k,
                          const Prediction& prediction) {
  const bool speaks = &law == &EntryOf(experiment.law) && !prediction.law_figures.empty();
  return speaks ? prediction.law_figures[k] : PredictedFigure();
}

}  // namespace

Json LawsJson(const Experiment& experiment, std::span<const LawMeasured> measured, const Prediction& prediction) {
  Json json = Json::object();
  for (const auto& [law, figures] : measured) {
    Json& entry = json[std::string(law->name)];
    for (std::size_t k = 0; k < figures.size(); ++k) {
      const LawFigure& figure = law->figures[k];
      const std::string name(figure.name);
      entry[name] = ToJson(figure, figures[k]);
      const PredictedFigure predicted = Predicted(experiment, *law, k, prediction);
      entry["predicted"][name] = Says(predicted) ? ToJson(figure, predicted.values) : Json(nullptr);
      entry["bounds"][name] = Says(predicted) ? Json(kBounds.Name(predicted.bound)) : Json(nullptr);
    }
  }
  return json;
}

std::string LawsText(const Experiment& experiment, std::span<const LawMeasured> measured,
                     const Prediction& prediction) {
  std::string text;
  for (const auto& [law, figures] : measured)
    for (std::size_t k = 0; k < figures.size(); ++k) {
      const LawFigure& figure = law->figures[k];
      text += fmt::format("{:<14} {} ({}){}\n", figure.name, Text(figures[k]), figure.meaning,
                          TheoryText(figure, figures[k], Predicted(experiment, *law, k, prediction)));
    }
  return text;
}

Json PredictedFiguresJson(const Experiment& experiment, const Prediction& prediction) {
  Json json = Json::object();
  const LawEntry& law = EntryOf(experiment.law);
  for (std::size_t k = 0; k < prediction.law_figures.size(); ++k)
    json[std::string(law.figures[k].name)] =
        Says(prediction.law_figures[k]) ? ToJson(law.figures[k], prediction.law_figures[k].values) : Json(nullptr);
  return json;
}

std::vector<std::pair<std::string, std::string>> PredictedFigureLines(const Experiment& experiment,
                                                                      const Prediction& prediction) {
  std::vector<std::pair<std::string, std::string>> lines;
  const LawEntry& law = EntryOf(experiment.law);
  for (std::size_t k = 0; k < prediction.law_figures.size(); ++k) {
    const PredictedFigure& predicted = prediction.law_figures[k];
    if (Says(predicted))
      lines.emplace_back(law.figures[k].name, fmt::format("{} ({})", Text(predicted), law.figures[k].meaning));
  }
  return lines;
}

}  // namespace mascot

#include "orchestrator/report/law_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "agent/laws/laws.h"

namespace mascot {
namespace {

/// One number, or the list.
FigureValue ValueOf(const LawFigure& figure, const FigureValues& values) {
  if (!figure.each.empty()) return values;
  return values.front() ? FigureValue(*values.front()) : FigureValue();
}

/// "4.5", "2.1, 4.3, never"
std::string Text(const FigureValues& values) {
  std::string text;
  for (const std::optional<double>& value : values)
    text += (text.empty() ? "" : ", ") + (value ? fmt::format("{:.4g}", *value) : "none");
  return text.empty() ? "none" : text;
}

/// "4.5 +- 0.1", "2.1 +- 0.1, 4.3 +- 0.2, none"
std::string BandText(const PredictedFigure& figure) {
  std::string text;
  for (std::size_t k = 0; k < figure.values.size(); ++k)
    text += (k == 0 ? "" : ", ") + (figure.values[k] && figure.tolerances[k]
                                        ? fmt::format("{:.4g} +- {:.2g}", *figure.values[k], *figure.tolerances[k])
                                        : "none");
  return text;
}

std::string Text(const PredictedFigure& figure) {
  const std::string_view bound = figure.bound == Bound::kEqual    ? ""
                                 : figure.bound == Bound::kAtMost ? "at most "
                                 : figure.bound == Bound::kWithin ? "within "
                                                                  : "at least ";
  const bool is_band = figure.bound == Bound::kWithin;
  const std::string text = std::string(bound) + (is_band ? BandText(figure) : Text(figure.values));
  return figure.why.empty() ? text : fmt::format("{}, because {}", text, figure.why);
}

/// "; slowest mode 5.1"; empty if there is nothing beside the figure.
std::string BesideText(const PredictedFigure& figure) { return figure.beside.empty() ? "" : "; " + figure.beside; }

/// Whether theory says anything of the figure.
bool Says(const PredictedFigure& figure) {
  return std::ranges::any_of(figure.values, [](const std::optional<double>& value) { return value.has_value(); });
}

/// ", +1.2 % off"; ", but for rounding" where that may be all of the difference; empty if the two are not comparable.
std::string OffText(const LawFigure& figure, const FigureValues& measured, const PredictedFigure& predicted) {
  if (predicted.bound != Bound::kEqual || !figure.each.empty() || !measured.front()) return "";
  const double value = *predicted.values.front(), off = *measured.front() - value;
  if (off != 0 && std::abs(off) <= predicted.rounding) return ", but for rounding";
  return value == 0 ? "" : fmt::format(", {:+.3g} % off", 100 * off / value);
}

/// "; theory: 4.5, +1.2 % off", "; theory: at most 9.3"; "; not predicted, because ..." if theory is silent about the
/// figure alone.
std::string TheoryText(const LawFigure& figure, const FigureValues& measured, const PredictedFigure& predicted) {
  if (Says(predicted))
    return fmt::format("; theory: {}{}{}", Text(predicted), OffText(figure, measured, predicted),
                       BesideText(predicted));
  return predicted.why.empty() ? "" : "; not predicted, because " + predicted.why;
}

/// How wide a band is; nothing: it is none.
FigureValue ToleranceOf(const LawFigure& figure, const PredictedFigure& predicted) {
  const bool is_band = Says(predicted) && predicted.bound == Bound::kWithin;
  return is_band ? ValueOf(figure, predicted.tolerances) : FigureValue();
}

/// What theory says of figure `k` of `law`. Where it is silent about all of them, that is the reason.
PredictedFigure Predicted(const Experiment& experiment, const LawEntry& law, std::size_t k,
                          const Prediction& prediction) {
  if (&law != &EntryOf(experiment.law)) return NotPredicted("agents have laws of their own");
  if (!prediction.law_figures.empty()) return prediction.law_figures[k];
  return NotPredicted(prediction.figures_silent.empty() ? prediction.silent : prediction.figures_silent);
}

/// Whether theory says anything of the figures of the law, or why it does not of some.
bool SaysSome(const Prediction& prediction) { return !prediction.law_figures.empty(); }

/// The tables by figure of what theory says: the value, its bound, how wide a band is, what rounding may put the
/// measured value off, and why a value is missing.
struct Tables {
  const char *value, *bound, *tolerance, *rounding, *reason;
};
constexpr Tables kInSummary{"predicted", "bounds", "tolerances", "rounding", "reasons"};
constexpr Tables kInCheck{"figures", "figure_bounds", "figure_tolerances", "figure_rounding", "figure_reasons"};

/// `prefix`: in front of the names of the tables.
void AddPredicted(const LawFigure& figure, const PredictedFigure& predicted, const Tables& tables,
                  const std::string& prefix, Figures& figures) {
  const bool says = Says(predicted);
  const auto in = [&](const char* table) { return fmt::format("{}{}.{}", prefix, table, figure.name); };
  figures.Add(in(tables.value), says ? ValueOf(figure, predicted.values) : FigureValue());
  figures.Add(in(tables.bound), says ? FigureValue(std::string(kBounds.Name(predicted.bound))) : FigureValue());
  figures.Add(in(tables.tolerance), ToleranceOf(figure, predicted));
  figures.Add(in(tables.rounding), says ? FigureValue(predicted.rounding) : FigureValue());
  figures.AddWords(in(tables.reason), predicted.why);
}

}  // namespace

void AddLaws(const Experiment& experiment, std::span<const LawMeasured> measured, const Prediction& prediction,
             Figures& figures) {
  for (const auto& [law, values] : measured) {
    const std::string prefix = fmt::format("laws.{}.", law->name);
    for (std::size_t k = 0; k < values.size(); ++k) {
      const LawFigure& figure = law->figures[k];
      figures.Add(prefix + std::string(figure.name), ValueOf(figure, values[k]));
      AddPredicted(figure, Predicted(experiment, *law, k, prediction), kInSummary, prefix, figures);
    }
  }
}

std::string LawsText(const Experiment& experiment, std::span<const LawMeasured> measured,
                     const Prediction& prediction) {
  std::string text;
  for (const auto& [law, figures] : measured)
    for (std::size_t k = 0; k < figures.size(); ++k) {
      const LawFigure& figure = law->figures[k];
      const PredictedFigure predicted =
          SaysSome(prediction) ? Predicted(experiment, *law, k, prediction) : PredictedFigure();
      text += fmt::format("{:<14} {} ({}){}\n", figure.name, Text(figures[k]), figure.meaning,
                          TheoryText(figure, figures[k], predicted));
    }
  return text;
}

void AddPredictedFigures(const Experiment& experiment, const Prediction& prediction, Json& json) {
  const LawEntry& law = EntryOf(experiment.law);
  for (const char* table : {kInCheck.value, kInCheck.bound, kInCheck.tolerance, kInCheck.rounding, kInCheck.reason})
    json[table] = Json::object();
  Figures figures;
  for (std::size_t k = 0; k < law.figures.size(); ++k)
    AddPredicted(law.figures[k], Predicted(experiment, law, k, prediction), kInCheck, "", figures);
  AddTo(json, figures);
}

std::vector<std::pair<std::string, std::string>> PredictedFigureLines(const Experiment& experiment,
                                                                      const Prediction& prediction) {
  std::vector<std::pair<std::string, std::string>> lines;
  const LawEntry& law = EntryOf(experiment.law);
  for (std::size_t k = 0; k < prediction.law_figures.size(); ++k) {
    const PredictedFigure& predicted = prediction.law_figures[k];
    const std::string text = Says(predicted) ? Text(predicted) : "not predicted, because " + predicted.why;
    lines.emplace_back(law.figures[k].name,
                       fmt::format("{} ({}{})", text, law.figures[k].meaning, BesideText(predicted)));
  }
  return lines;
}

}  // namespace mascot

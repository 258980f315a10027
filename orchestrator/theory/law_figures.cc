#include "orchestrator/theory/law_figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "agent/laws/parts/rounding.h"

namespace mascot {
namespace {

/// The magnitude of what a figure is computed from if its law does not say: lengths are of positions.
double UsualMagnitude(const Experiment& experiment, std::string_view name) {
  const double start_m = SizeOfStart_m(experiment);
  return name.ends_with("_m") ? start_m : name.ends_with("_m2") ? start_m * start_m : 0;
}

void AddRounding(double share, double usual_magnitude, PredictedFigure& figure) {
  double magnitude = std::max(figure.magnitude, usual_magnitude);
  for (const std::optional<double>& value : figure.values)
    if (value) magnitude = std::max(magnitude, std::abs(*value));
  figure.rounding = share * magnitude;
  const double wider = figure.bound == Bound::kAtMost    ? figure.rounding
                       : figure.bound == Bound::kAtLeast ? -figure.rounding
                                                         : 0;
  for (std::optional<double>& value : figure.values)
    if (value) *value += wider;
}

/// Why a value says nothing of the figure; empty: it says something.
std::string WhyNothing(const LawFigure& row, const PredictedFigure& figure, double value) {
  if (!std::isfinite(value)) return "no finite value follows";
  if (figure.bound == Bound::kAtLeast && value <= row.least)
    return fmt::format("the bound that follows, {:.3g}, is not above {:g}", value, row.least);
  if (figure.bound == Bound::kAtMost && value >= row.most)
    return fmt::format("the bound that follows, {:.3g}, is not below {:g}", value, row.most);
  return "";
}

void TakeBackWhatSaysNothing(const LawFigure& row, PredictedFigure& figure) {
  for (std::optional<double>& value : figure.values) {
    if (!value) continue;
    std::string why = WhyNothing(row, figure, *value);
    if (why.empty()) continue;
    value.reset();
    if (figure.why.empty()) figure.why = std::move(why);
  }
}

}  // namespace

void Complete(const Experiment& experiment, const LawEntry& law, std::vector<PredictedFigure>& figures) {
  const double share = RoundingShare(experiment);
  for (std::size_t k = 0; k < figures.size(); ++k) {
    if (figures[k].values.empty() && figures[k].why.empty()) figures[k].why = law.figures[k].unpredicted;
    AddRounding(share, UsualMagnitude(experiment, law.figures[k].name), figures[k]);
    TakeBackWhatSaysNothing(law.figures[k], figures[k]);
  }
}

}  // namespace mascot

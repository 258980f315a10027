#include "orchestrator/measuring/law_curve.h"

#include <fmt/format.h>

#include <iterator>

namespace mascot {

void LawCurveRecord::Add(const FlownRow& row) {
  if (row.tick() % every_ != 0) return;
  const std::optional<double> value = meter_.curve();
  if (!value) return;
  points_.emplace_back(row.tick(), *value);
  if (points_.size() <= kMaxPoints) return;
  every_ *= 2;
  std::erase_if(points_, [this](const auto& point) { return point.first % every_ != 0; });
}

std::string LawCurveRecord::Csv() const {
  std::string csv = "t_s,value\n";
  for (const auto& [tick, value] : points_)
    fmt::format_to(std::back_inserter(csv), "{},{}\n", experiment_.time_s(tick), value);
  return csv;
}

}  // namespace mascot

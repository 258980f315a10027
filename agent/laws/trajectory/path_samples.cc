#include "agent/laws/trajectory/path_samples.h"

#include <algorithm>
#include <vector>

namespace mascot {
namespace {

constexpr std::size_t kWidth[] = {4};

}  // namespace

std::string PathSamples::Read(const std::string& text, TextPlace& place) {
  std::vector<NumberRow> rows;
  if (std::string mistake = ReadNumberRows(text, kWidth, "four numbers in [-1e+06, 1e+06], t,x,y,z", rows, place);
      !mistake.empty())
    return mistake;
  for (const NumberRow& row : rows) {
    const double t_s = row.numbers[0];
    if (!knots_.empty() && t_s <= knots_.back().t_s) {
      place = {.line = row.line};
      return "expected times that increase, got " + row.text;
    }
    knots_.push_back({.t_s = t_s, .p_W = {row.numbers[1], row.numbers[2], row.numbers[3]}});
  }
  if (knots_.size() < 2) return "expected at least two lines t,x,y,z, got " + std::to_string(knots_.size());
  FindVelocities();
  return "";
}

// The acceleration is continuous at knot i, with u = 1 / (t_i - t_{i-1}) before and w = 1 / (t_{i+1} - t_i) after it:
//   u v_{i-1} + 2 (u + w) v_i + w v_{i+1} = 3 [u^2 (p_i - p_{i-1}) + w^2 (p_{i+1} - p_i)],  v_0 = v_n = 0
void PathSamples::FindVelocities() {
  std::vector<double> share(knots_.size(), 0);  // v_i = v_i (found so far) - share_i v_{i+1}
  for (std::size_t i = 1; i + 1 < knots_.size(); ++i) {
    Knot &before = knots_[i - 1], &knot = knots_[i], &after = knots_[i + 1];
    const double u = 1 / (knot.t_s - before.t_s), w = 1 / (after.t_s - knot.t_s);
    const double pivot = 2 * (u + w) - u * share[i - 1];
    const Eigen::Vector3d right = 3 * (u * u * (knot.p_W - before.p_W) + w * w * (after.p_W - knot.p_W));
    knot.v_W = (right - u * before.v_W) / pivot;
    share[i] = w / pivot;
  }
  for (std::size_t i = knots_.size() - 1; i-- > 1;) knots_[i].v_W -= share[i] * knots_[i + 1].v_W;
}

PathPoint PathSamples::At(double t_s) const {
  if (t_s <= knots_.front().t_s) return {.p_W = knots_.front().p_W};
  if (t_s >= knots_.back().t_s) return {.p_W = knots_.back().p_W};
  const auto after = std::ranges::upper_bound(knots_, t_s, {}, &Knot::t_s);
  const Knot &a = *(after - 1), &b = *after;
  const double h = b.t_s - a.t_s, s = (t_s - a.t_s) / h;
  const Eigen::Vector3d way = b.p_W - a.p_W, bend = h * (a.v_W + b.v_W) - 2 * way, turn = way - h * a.v_W - bend;
  // p = p_a + h v_a s + turn s^2 + bend s^3
  return {.p_W = a.p_W + s * (h * a.v_W + s * (turn + s * bend)),
          .v_W = (h * a.v_W + s * (2 * turn + 3 * s * bend)) / h,
          .a_W = (2 * turn + 6 * s * bend) / (h * h)};
}

}  // namespace mascot

#include "agent/laws/trajectory/path_samples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <sstream>
#include <string_view>

#include "base/number.h"
#include "base/utf8.h"

namespace mascot {
namespace {

constexpr double kLargestSample = 1e6;
constexpr std::size_t kLongestSampleQuote = 60;

bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

/// Reads the four numbers of a line "t,x,y,z", with blanks around them, into `numbers`. Returns at which character of
/// the line it is something else; nothing: it is that.
std::optional<std::size_t> ReadFour(std::string_view line, std::array<double, 4>& numbers) {
  std::size_t begin = 0;
  for (std::size_t n = 0; n < numbers.size(); ++n) {
    const std::size_t end = n + 1 < numbers.size() ? line.find(',', begin) : line.size();
    std::string_view cell = line.substr(begin, std::min(end, line.size()) - begin);
    const std::size_t at = begin + static_cast<std::size_t>(std::ranges::find_if_not(cell, IsBlank) - cell.begin());
    cell.remove_prefix(std::min(at - begin, cell.size()));
    while (!cell.empty() && IsBlank(cell.back())) cell.remove_suffix(1);
    const auto number = NumberFrom<double>(cell);
    if (!number || !(std::abs(*number) <= kLargestSample)) return at;
    if (end == line.npos) return line.size();
    numbers[n] = *number;
    begin = end + 1;
  }
  return std::nullopt;
}

/// A line as a message quotes it.
std::string Quote(std::string_view line) { return "'" + std::string(CutUtf8(line, kLongestSampleQuote)) + "'"; }

}  // namespace

std::string PathSamples::Read(const std::string& text, Place& place) {
  std::istringstream lines(text);
  place = {};
  for (std::string row; std::getline(lines, row);) {
    ++place.line;
    place.column = 1;
    if (std::ranges::all_of(row, IsBlank)) continue;
    std::array<double, 4> numbers{};
    const auto wrong = ReadFour(row, numbers);
    if (wrong && knots_.empty() && row.find_first_of("0123456789") == std::string::npos) continue;  // a heading
    if (wrong) {
      place.column = static_cast<int>(*wrong) + 1;
      return "expected four numbers in [-1e+06, 1e+06], t,x,y,z, got " + Quote(row);
    }
    const auto& [t_s, x, y, z] = numbers;
    if (!knots_.empty() && t_s <= knots_.back().t_s) return "expected times that increase, got " + Quote(row);
    knots_.push_back({.t_s = t_s, .p_W = {x, y, z}});
  }
  place.line = std::max(place.line, 1);  // of an empty text, too
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

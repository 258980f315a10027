#include "agent/laws/platoon/string_stability.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace mascot {
namespace {

using Complex = std::complex<double>;

constexpr double kMaxHeadway_s = 100;
constexpr double kRounding = 1e-9;  // of the largest gain

/// Calls visit(w) for frequencies from far below all that the loop does up to half the control rate: 2 % apart, and
/// near enough for what delays do.
template <class Visit>
void ForEachFrequency(const Following& law, const Visit& visit) {
  const double slow = std::min(std::sqrt(law.p), law.p / (law.d + law.p * law.headway_s + 1e-9));
  const double step = 0.2 / (law.h * (law.delay_ticks + law.message_ticks + 1)), end = std::numbers::pi / law.h;
  double w = 1e-3 * std::min(slow, end);
  while (w < end) {
    visit(w);
    w += std::min(0.02 * w, step);
  }
  visit(end);
}

/// The largest value of f near `middle`, which is no smaller than those at `low` and `high`: by golden section.
template <class Function>
double LargestNear(double low, double high, const Function& f) {
  constexpr int kSections = 40;
  const double golden = (std::sqrt(5.0) - 1) / 2;
  double a = high - golden * (high - low), b = low + golden * (high - low), at_a = f(a), at_b = f(b);
  for (int n = 0; n < kSections; ++n) {
    if (at_a > at_b) {
      high = std::exchange(b, a);
      at_b = at_a;
      a = high - golden * (high - low);
      at_a = f(a);
    } else {
      low = std::exchange(a, b);
      at_a = at_b;
      b = low + golden * (high - low);
      at_b = f(b);
    }
  }
  return std::max(at_a, at_b);
}

}  // namespace

StringStability::Point StringStability::At(double w) const {
  const double h = law_.h, angle = w * h, half_sin = std::sin(angle / 2);
  const Complex y(-2 * half_sin * half_sin, std::sin(angle)), z = 1.0 + y;  // y = z - 1, without cancellation
  const auto late = [angle](int ticks) { return std::polar(1.0, -angle * ticks); };
  const double k = law_.Approach(), b = law_.Answer(), g = law_.MeanOfOld();
  const Complex c = k * z / (y + k), f = late(law_.delay_ticks) * (1 - g + g * b / (y + b));
  const Complex pull = law_.p * h * h / 2 * (z + 1.0), rate = law_.d + law_.dd * y / (h * z), v = h * y;
  const Complex ahead = law_.feed_forward ? late(law_.message_ticks) * y * y : Complex(0);
  const Complex below = y * y + c * (pull + law_.p * law_.headway_s * v + rate * (v + law_.headway_s * y * y / z)) * f;
  return {c * ((pull + rate * v) * f + ahead) / below, below};
}

// The denominator's poles lie within the unit circle, all but the two that (z - 1)^2 takes away, and it grows as z^2
// far outside: all its zeros lie within, too, if it turns twice about 0 on the way around the circle (argument
// principle).
bool StringStability::Decays() const {
  constexpr int kMaxHalvings = 40;
  const auto turn = [this](const auto& self, double from, Complex at_from, double to, Complex at_to,
                           int halvings) -> double {
    const double angle = std::arg(at_to * std::conj(at_from));
    if (std::abs(angle) < 0.5 || halvings == 0) return angle;
    const double middle = (from + to) / 2;
    const Complex at_middle = At(middle).below;
    return self(self, from, at_from, middle, at_middle, halvings - 1) +
           self(self, middle, at_middle, to, at_to, halvings - 1);
  };
  double turned = 0, before = 0;
  Complex at_before = At(0).below;
  ForEachFrequency(law_, [&](double w) {
    const Complex at_w = At(w).below;
    turned += turn(turn, before, at_before, w, at_w, kMaxHalvings);
    before = w;
    at_before = at_w;
  });
  return std::abs(turned - 2 * std::numbers::pi) < 0.1;  // on the upper half of the circle
}

double StringStability::LargestGain() const {
  double largest = 1, low = 0, middle = 0, at_low = 0, at_middle = 1;
  ForEachFrequency(law_, [&](double w) {
    const double at_w = Gain(w);
    largest = std::max(largest, at_w);
    if (at_middle >= at_low && at_middle >= at_w && at_middle > 0.95 * largest)
      largest = std::max(largest, LargestNear(low, w, [this](double near) { return Gain(near); }));
    low = std::exchange(middle, w);
    at_low = std::exchange(at_middle, at_w);
  });
  return largest <= 1 + kRounding ? 1 : largest;
}

std::optional<double> StringStability::MinHeadway_s() const {
  constexpr int kHalvings = 40;
  const auto is_stable = [this](double headway_s) {
    Following law = law_;
    law.headway_s = headway_s;
    const StringStability string(law);
    return string.Decays() && string.LargestGain() == 1;
  };
  double low = 0, high = 0.1;
  while (!is_stable(high)) {
    if (high == kMaxHeadway_s) return std::nullopt;
    low = std::exchange(high, std::min(2 * high, kMaxHeadway_s));
  }
  for (int n = 0; n < kHalvings && high - low > 1e-5 * high; ++n) {
    const double middle = (low + high) / 2;
    (is_stable(middle) ? high : low) = middle;
  }
  return high;
}

}  // namespace mascot

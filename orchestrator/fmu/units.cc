#include "orchestrator/fmu/units.h"

#include <cmath>
#include <numbers>

#include "base/number.h"

namespace mascot {
namespace {

struct Symbol {
  std::string_view name;
  BaseUnit unit;
};
constexpr Symbol kSymbols[] = {
    {"1", {}},
    {"kg", {.exponents = {1, 0, 0, 0}}},
    {"m", {.exponents = {0, 1, 0, 0}}},
    {"s", {.exponents = {0, 0, 1, 0}}},
    {"rad", {.exponents = {0, 0, 0, 1}}},
    {"deg", {.factor = std::numbers::pi / 180, .exponents = {0, 0, 0, 1}}},
    {"Hz", {.exponents = {0, 0, -1, 0}}},
    {"N", {.exponents = {1, 1, -2, 0}}},
};

/// A symbol with a power: "s^2".
std::optional<BaseUnit> PowerOf(std::string_view text) {
  const std::size_t caret = std::min(text.find('^'), text.size());
  const auto power = caret == text.size() ? std::optional<int>(1) : NumberFrom<int>(text.substr(caret + 1));
  for (const Symbol& symbol : kSymbols) {
    if (!power || symbol.name != text.substr(0, caret)) continue;
    BaseUnit unit = symbol.unit;
    unit.factor = std::pow(unit.factor, *power);
    for (int& exponent : unit.exponents) exponent *= *power;
    return unit;
  }
  return std::nullopt;
}

}  // namespace

std::optional<BaseUnit> BaseUnitOf(std::string_view unit) {
  BaseUnit product;
  int sign = 1;  // of the powers of the next symbol
  while (true) {
    const std::size_t end = std::min(unit.find_first_of("/*"), unit.size());
    const auto power = PowerOf(unit.substr(0, end));
    if (!power) return std::nullopt;
    product.factor *= sign > 0 ? power->factor : 1 / power->factor;
    for (std::size_t n = 0; n < product.exponents.size(); ++n) product.exponents[n] += sign * power->exponents[n];
    if (end == unit.size()) return product;
    sign = unit[end] == '/' ? -1 : 1;
    unit.remove_prefix(end + 1);
  }
}

}  // namespace mascot

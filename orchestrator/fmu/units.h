#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace mascot {

/// A unit by the base units of FMI: a number in it is `factor` times that in kg^a m^b s^c rad^d.
struct BaseUnit {
  double factor = 1;
  std::array<int, 4> exponents = {};  ///< of kg, m, s, rad

  bool operator==(const BaseUnit&) const = default;
};

/// What a unit as text ("m/s^2", "1/s", "deg") is; nullopt: it is unknown, as that of a user's law may be.
std::optional<BaseUnit> BaseUnitOf(std::string_view unit);

}  // namespace mascot

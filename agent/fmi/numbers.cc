#include "agent/fmi/numbers.h"

#include <cmath>
#include <limits>
#include <type_traits>

namespace mascot {

std::size_t FmuNumbers::Add(std::uint32_t reference, std::size_t size) {
  const std::size_t first = values_.size();
  references_.push_back(reference);
  values_.resize(first + size);
  room_.resize(first + size);
  return first;
}

template <class T>
T NumberAs(double number) {
  if constexpr (std::is_same_v<T, bool>) {
    return number != 0;
  } else if constexpr (std::is_integral_v<T>) {
    const double rounded = std::floor(number + 0.5);
    // The largest value of 64 bits rounds up to a double that is out of range.
    if (!(rounded > static_cast<double>(std::numeric_limits<T>::min()))) return std::numeric_limits<T>::min();
    if (rounded >= static_cast<double>(std::numeric_limits<T>::max())) return std::numeric_limits<T>::max();
    return static_cast<T>(rounded);
  } else {
    return static_cast<T>(number);
  }
}

template <class T>
std::span<T> FmuNumbers::As() {
  const std::span<T> room = Room<T>();
  for (std::size_t k = 0; k < room.size(); ++k) room[k] = NumberAs<T>(values_[k]);
  return room;
}

// The types of VisitNumberType(), and int, which are the booleans of FMI 2.
template std::span<double> FmuNumbers::As();
template std::span<float> FmuNumbers::As();
template std::span<std::int8_t> FmuNumbers::As();
template std::span<std::uint8_t> FmuNumbers::As();
template std::span<std::int16_t> FmuNumbers::As();
template std::span<std::uint16_t> FmuNumbers::As();
template std::span<std::int32_t> FmuNumbers::As();
template std::span<std::uint32_t> FmuNumbers::As();
template std::span<std::int64_t> FmuNumbers::As();
template std::span<std::uint64_t> FmuNumbers::As();
template std::span<bool> FmuNumbers::As();

}  // namespace mascot

#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "agent/fmi/model_description.h"

namespace mascot {

/// Values of variables of one numeric type, as doubles and as the type that the FMU has. After the constructor, and as
/// long as no array grows, no function allocates.
class FmuNumbers {
 public:
  explicit FmuNumbers(FmuType type) : type_(type) {}
  /// Adds a variable with `size` values, all 0. Returns the place of the first of them in values().
  std::size_t Add(std::uint32_t reference, std::size_t size);

  FmuType type() const { return type_; }
  bool empty() const { return references_.empty(); }
  std::span<const std::uint32_t> references() const { return references_; }
  std::span<double> values() { return values_; }
  std::span<const double> values() const { return values_; }

  /// The values as numbers of type T, which belongs to type(). Integers are rounded to the nearest, and numbers beyond
  /// the range of T become its ends; any number but 0 is true.
  template <class T>
  std::span<T> As();
  /// Memory for as many values of type T.
  template <class T>
  std::span<T> Room() {
    return {reinterpret_cast<T*>(room_.data()), values_.size()};
  }
  /// Takes what Room<T>() has as the values.
  template <class T>
  void TakeRoom() {
    const std::span<T> room = Room<T>();
    for (std::size_t k = 0; k < room.size(); ++k) values_[k] = static_cast<double>(room[k]);
  }

 private:
  FmuType type_;
  std::vector<std::uint32_t> references_;
  std::vector<double> values_;
  std::vector<std::uint64_t> room_;  // one of these has room for a value of any type
};

/// `number` as a T: see FmuNumbers::As().
template <class T>
T NumberAs(double number);

/// Calls `visit` with a value of the C++ type that stands for a numeric type of FMI 3: double{}, float{}, ..., bool{}.
template <class Visit>
void VisitNumberType(FmuType type, Visit visit) {
  switch (type) {
    case FmuType::kFloat64:
      return visit(double{});
    case FmuType::kFloat32:
      return visit(float{});
    case FmuType::kInt8:
      return visit(std::int8_t{});
    case FmuType::kUInt8:
      return visit(std::uint8_t{});
    case FmuType::kInt16:
      return visit(std::int16_t{});
    case FmuType::kUInt16:
      return visit(std::uint16_t{});
    case FmuType::kInt32:
      return visit(std::int32_t{});
    case FmuType::kUInt32:
      return visit(std::uint32_t{});
    case FmuType::kInt64:
      return visit(std::int64_t{});
    case FmuType::kUInt64:
      return visit(std::uint64_t{});
    case FmuType::kBoolean:
      return visit(bool{});
    case FmuType::kString:
    case FmuType::kOther:
      break;
  }
}

}  // namespace mascot

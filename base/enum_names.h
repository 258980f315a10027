#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <span>
#include <string_view>

namespace mascot {

/// Names of the values of an enum in experiment files and reports: one table for reading and for writing.
template <class Enum, std::size_t n>
class EnumNames {
 public:
  struct Entry {
    Enum value;
    std::string_view name;
  };
  constexpr explicit EnumNames(const Entry (&entries)[n]) {
    for (std::size_t i = 0; i < n; ++i) {
      values_[i] = entries[i].value;
      names_[i] = entries[i].name;
    }
  }

  /// All names, in the order of the table.
  constexpr std::span<const std::string_view> names() const { return names_; }
  /// The value of `name`, which must be one of names(), as Section::OneOf() returns it.
  constexpr Enum Value(std::string_view name) const {
    std::size_t i = 0;
    while (i + 1 < n && names_[i] != name) ++i;
    assert(names_[i] == name);
    return values_[i];
  }
  /// The name of `value`, which must be in the table.
  constexpr std::string_view Name(Enum value) const {
    std::size_t i = 0;
    while (i + 1 < n && values_[i] != value) ++i;
    assert(values_[i] == value);
    return names_[i];
  }

 private:
  std::array<Enum, n> values_{};
  std::array<std::string_view, n> names_{};
};

}  // namespace mascot

#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace mascot {

/// A range of legal numbers.
struct Range {
  double min = 0;
  double max = 0;
  bool open_min = false;  ///< `min` itself is refused

  bool Holds(double value) const { return (open_min ? value > min : value >= min) && value <= max; }
  /// A legal value to go on with after a mistake.
  double Legal() const { return Holds(0) ? 0 : max < 0 ? max : open_min ? max : min; }
  std::string Text() const;  ///< "[0, 100]" or "(0, 100]"
};
/// The range (min, max].
constexpr Range Above(double min, double max) { return {min, max, true}; }

/// What kind of value a key holds.
enum class ValueKind {
  kNone,
  kNumber,
  kInteger,
  kBoolean,
  kText,
  kOneOf,       ///< one of some names
  kTexts,       ///< a list of strings
  kVector3,     ///< [x, y, z]
  kNumbers,     ///< a list of numbers
  kRows,        ///< a list of lists of numbers
  kPoints,      ///< a list of [x, y, z]
  kPointLists,  ///< a list of lists of [x, y, z]
  kTable,
  kTables,  ///< [[...]]
  kAny,     ///< a table whose keys the user chooses
};

/// One key of the experiment file: what it may hold and what it means. Section reads a key by its row, and
/// docs/configuration.md, the JSON schema for editors and `orchestrator laws` are made from the same rows.
struct Key {
  std::string_view name;
  ValueKind kind = ValueKind::kNone;
  std::string_view meaning;
  Range range = {};  ///< range of numbers, also of those inside lists
  std::int64_t min_integer = 0;
  std::int64_t max_integer = 0;
  std::span<const std::string_view> names = {};  ///< legal values of kOneOf
  std::span<const Key> keys = {};                ///< keys inside kTable and kTables
  ValueKind or_kind = ValueKind::kNone;          ///< another kind that the value may have
  std::string_view fallback = {};                ///< the default, as a TOML value; empty: none
  std::string_view otherwise = {};               ///< what holds without the key, in words, if that is not a fixed value
  std::string_view unit = {};                    ///< the unit, if the name does not end in it
  bool required = false;
  bool live = false;  ///< an event may change it while a run goes on

  /// A copy in which one member is `value`.
  template <class Member, class Value>
  constexpr Key With(Member Key::*member, Value value) const {
    Key key = *this;
    key.*member = value;
    return key;
  }
  constexpr Key Default(std::string_view toml) const { return With(&Key::fallback, toml); }
  constexpr Key Otherwise(std::string_view words) const { return With(&Key::otherwise, words); }
  constexpr Key Unit(std::string_view symbol) const { return With(&Key::unit, symbol); }
  constexpr Key Required() const { return With(&Key::required, true); }
  constexpr Key Live() const { return With(&Key::live, true); }
  constexpr Key Or(ValueKind other) const { return With(&Key::or_kind, other); }
};

/// The legal values of a key as text: "[0, 1000], 1/s^2", "ring | path".
std::string ValueText(const Key& key);

/// A name as what is before its unit, and the unit in which it ends: "headway_s" is "headway", "s". Without one: the
/// name, "".
struct NameAndUnit {
  std::string_view name, unit;
};
NameAndUnit SplitUnit(std::string_view name);
/// The unit of a key's numbers, "m/s^2": that of its row, or else of its name; "": it has none.
std::string_view UnitOf(const Key& key);

/// Rows of tables of keys: key::Number("loss", {0, 1}, "probability that a sample is lost").Default("0.0").
namespace key {

using Name = std::string_view;

constexpr Key Number(Name name, Range range, std::string_view meaning) {
  return {.name = name, .kind = ValueKind::kNumber, .meaning = meaning, .range = range};
}
constexpr Key Integer(Name name, std::int64_t min, std::int64_t max, std::string_view meaning) {
  return {.name = name, .kind = ValueKind::kInteger, .meaning = meaning, .min_integer = min, .max_integer = max};
}
constexpr Key Boolean(Name name, std::string_view meaning) {
  return {.name = name, .kind = ValueKind::kBoolean, .meaning = meaning};
}
constexpr Key Text(Name name, std::string_view meaning) {
  return {.name = name, .kind = ValueKind::kText, .meaning = meaning};
}
constexpr Key OneOf(Name name, std::span<const std::string_view> names, std::string_view meaning) {
  return {.name = name, .kind = ValueKind::kOneOf, .meaning = meaning, .names = names};
}
constexpr Key Texts(Name name, std::string_view meaning) {
  return {.name = name, .kind = ValueKind::kTexts, .meaning = meaning};
}
constexpr Key Vector3(Name name, Range range, std::string_view meaning) {
  return {.name = name, .kind = ValueKind::kVector3, .meaning = meaning, .range = range};
}
constexpr Key Numbers(Name name, Range range, std::string_view meaning) {
  return {.name = name, .kind = ValueKind::kNumbers, .meaning = meaning, .range = range};
}
constexpr Key Rows(Name name, Range range, std::string_view meaning) {
  return {.name = name, .kind = ValueKind::kRows, .meaning = meaning, .range = range};
}
constexpr Key Points(Name name, Range range, std::string_view meaning) {
  return {.name = name, .kind = ValueKind::kPoints, .meaning = meaning, .range = range};
}
constexpr Key PointLists(Name name, Range range, std::string_view meaning) {
  return {.name = name, .kind = ValueKind::kPointLists, .meaning = meaning, .range = range};
}
constexpr Key Table(Name name, std::span<const Key> keys, std::string_view meaning) {
  return {.name = name, .kind = ValueKind::kTable, .meaning = meaning, .keys = keys};
}
constexpr Key Tables(Name name, std::span<const Key> keys, std::string_view meaning) {
  return {.name = name, .kind = ValueKind::kTables, .meaning = meaning, .keys = keys};
}
constexpr Key Any(Name name, std::string_view meaning) {
  return {.name = name, .kind = ValueKind::kAny, .meaning = meaning};
}

}  // namespace key

/// The rows of two tables in one.
template <std::size_t n, std::size_t m>
constexpr std::array<Key, n + m> Joined(const std::array<Key, n>& a, const std::array<Key, m>& b) {
  std::array<Key, n + m> all;
  for (std::size_t i = 0; i < n; ++i) all[i] = a[i];
  for (std::size_t i = 0; i < m; ++i) all[n + i] = b[i];
  return all;
}

}  // namespace mascot

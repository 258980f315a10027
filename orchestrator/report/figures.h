#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "agent/laws/law_figures.h"
#include "orchestrator/report/json.h"

namespace mascot {

/// The value of a figure. std::monostate: the figure does not apply, or its value was never reached. FigureValues: one
/// value for each waypoint or the like. A string: why there is no number, or what a number means. A function makes a
/// table, such as that of all edges; it is called only when the table is printed.
using FigureValue =
    std::variant<std::monostate, bool, std::int64_t, double, FigureValues, std::string, std::function<Json()>>;

/// A figure, as measured or as predicted.
struct Figure {
  /// Its place in summary.json, with its unit: "consensus.settling_time_s". A vector is three figures, ".x", ".y",
  /// ".z".
  std::string name;
  FigureValue value;
};

/// The figures of a run, or of a part of it, in the order in which they are printed. All that print the same figure
/// (JSON, terminal, tables) take it from here, by its name.
class Figures {
 public:
  /// Adds a figure. No other one may have this name.
  void Add(std::string name, FigureValue value);
  template <class Value>
  void Add(std::string name, const std::optional<Value>& value) {
    Add(std::move(name), value ? FigureValue(*value) : FigureValue());
  }
  void AddVector(const std::string& name, const Eigen::Vector3d& value);
  /// A vector; if there is none, one figure called `name` without a value.
  void AddVector(const std::string& name, const std::optional<Eigen::Vector3d>& value);
  /// Adds words; with empty ones, a figure without a value.
  void AddWords(std::string name, const std::string& words);
  /// Adds all figures of `part`.
  void Add(const Figures& part);

  const std::vector<Figure>& all() const { return all_; }
  /// The number of a figure; nothing: it has none. Here and below, there must be a figure of this name.
  std::optional<double> Number(std::string_view name) const;
  /// The number of a figure that always has one. Throws std::bad_optional_access if it has none.
  double Known(std::string_view name) const { return Number(name).value(); }
  /// The number of a figure that always is a count. Throws std::bad_variant_access if it is none.
  std::int64_t Count(std::string_view name) const { return std::get<std::int64_t>(Find(name)); }
  /// The vector that AddVector() added under this name; nothing: it was added without a value.
  std::optional<Eigen::Vector3d> Vector(const std::string& name) const;
  /// The words of a figure; empty: it has none.
  std::string Words(std::string_view name) const;

 private:
  bool Has(std::string_view name) const;
  const FigureValue& Find(std::string_view name) const;

  std::vector<Figure> all_;
};

/// The figures as a JSON object: each step of a dotted name is an object in it, each vector a list of three.
Json JsonOf(const Figures& figures);
/// Adds the figures to a JSON object, in the form of JsonOf().
void AddTo(Json& object, const Figures& figures);

}  // namespace mascot

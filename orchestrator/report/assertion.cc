#include "orchestrator/report/assertion.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "base/number.h"
#include "experiment/toml/section.h"

namespace mascot {
namespace {

using Relation = Assertion::Relation;

// Those of two characters first: "<=" begins as "<" does.
constexpr std::pair<std::string_view, Relation> kRelations[] = {{"<=", Relation::kAtMost}, {">=", Relation::kAtLeast},
                                                                {"==", Relation::kEqual},  {"!=", Relation::kNotEqual},
                                                                {"<", Relation::kLess},    {">", Relation::kGreater}};

std::string_view Trimmed(std::string_view text) {
  const std::size_t begin = text.find_first_not_of(' ');
  return begin == text.npos ? "" : text.substr(begin, text.find_last_not_of(' ') - begin + 1);
}

std::optional<double> NumberIn(std::string_view text) {
  if (text == "true" || text == "false") return text == "true";
  return NumberFrom<double>(text);
}

bool Holds(double value, Relation relation, double number) {
  switch (relation) {
    case Relation::kLess:
      return value < number;
    case Relation::kAtMost:
      return value <= number;
    case Relation::kGreater:
      return value > number;
    case Relation::kAtLeast:
      return value >= number;
    case Relation::kEqual:
      return value == number;
    case Relation::kNotEqual:
      return value != number;
  }
  return false;
}

/// Why the claim fails for the value of a figure; empty: it holds.
struct Failing {
  const Assertion& claim;

  std::string operator()(std::monostate) const {
    return claim.name.find(".predicted.") != std::string::npos
               ? "theory predicts no value of it"
               : "the run has no value of it: it has not happened by the end, or not for good";
  }
  std::string operator()(bool value) const {
    return Holds(value, claim.relation, claim.number) ? "" : value ? "it is true" : "it is false";
  }
  std::string operator()(std::int64_t value) const { return (*this)(static_cast<double>(value)); }
  std::string operator()(double value) const {
    return Holds(value, claim.relation, claim.number) ? "" : fmt::format("it is {:.6g}", value);
  }
  std::string operator()(const FigureValues& values) const {
    if (values.empty()) return (*this)(std::monostate());
    for (std::size_t k = 0; k < values.size(); ++k) {
      const std::string why = values[k] ? (*this)(*values[k]) : (*this)(std::monostate());
      if (!why.empty()) return fmt::format("value {} of {}: {}", k + 1, values.size(), why);
    }
    return "";
  }
  std::string operator()(const std::string& words) const { return "the run has no number of it: " + words; }
  std::string operator()(const std::function<Json()>& /*table*/) const { return "it is a table"; }
};

/// Whether one name is the other, or a table or vector that holds it.
bool IsPartOf(std::string_view a, std::string_view b) {
  if (a.size() > b.size()) std::swap(a, b);
  return b.starts_with(a) && (a.size() == b.size() || b[a.size()] == '.');
}

}  // namespace

Assertion ReadAssertion(const std::string& text) {
  const auto refuse = [&] {
    throw ConfigError(
        {fmt::format("--assert: expected a figure of summary.json, a relation and a number, as in "
                     "\"consensus.settling_time_s < 10\", got \"{}\"",
                     text)});
  };
  const std::size_t at = text.find_first_of("<>=!");
  if (at == text.npos) refuse();
  const std::string_view rest = std::string_view(text).substr(at), name = Trimmed(std::string_view(text).substr(0, at));
  const auto* relation =
      std::ranges::find_if(kRelations, [&](const auto& each) { return rest.starts_with(each.first); });
  if (relation == std::end(kRelations) || name.empty()) refuse();
  const auto number = NumberIn(Trimmed(rest.substr(relation->first.size())));
  if (!number) refuse();
  return {.text = text, .name = std::string(name), .relation = relation->second, .number = *number};
}

void ExpectFigure(const Assertion& assertion, const Figures& figures) {
  std::vector<std::string_view> names;
  for (const Figure& figure : figures.all()) {
    if (IsPartOf(figure.name, assertion.name)) return;
    names.push_back(figure.name);
  }
  const auto nearest = DidYouMean(assertion.name, names);
  throw ConfigError({fmt::format("--assert: expected a figure of this experiment's summary.json, got {}{}",
                                 assertion.name, nearest ? fmt::format(" (did you mean \"{}\"?)", *nearest) : "")});
}

std::string WhyItFails(const Assertion& assertion, const Figures& figures) {
  const auto figure = std::ranges::find(figures.all(), assertion.name, &Figure::name);
  if (figure == figures.all().end()) return "the run has no such figure";
  return std::visit(Failing{assertion}, figure->value);
}

}  // namespace mascot

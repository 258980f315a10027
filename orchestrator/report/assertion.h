#pragma once

#include <string>

#include "orchestrator/report/figures.h"

namespace mascot {

/// A claim about a figure of a run, for marking and for tests: "consensus.settling_time_s < 10".
struct Assertion {
  enum class Relation { kLess, kAtMost, kGreater, kAtLeast, kEqual, kNotEqual };

  std::string text;  ///< as the user has written it
  std::string name;  ///< of a figure, as in summary.json
  Relation relation = Relation::kLess;
  double number = 0;
};

/// Reads NAME RELATION NUMBER, with a relation of <, <=, >, >=, == and !=. A number may be true or false. Throws
/// ConfigError, with "--assert: expected ..., got ...".
Assertion ReadAssertion(const std::string& text);
/// Throws ConfigError, perhaps with another name that was meant, if a run cannot have the figure. `figures`: those of
/// the run before it flies.
void ExpectFigure(const Assertion& assertion, const Figures& figures);
/// Why it does not hold, "it is 15.33"; empty: it does. A list holds if all of its values do.
std::string WhyItFails(const Assertion& assertion, const Figures& figures);

}  // namespace mascot

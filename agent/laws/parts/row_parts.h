#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "agent/laws/laws.h"
#include "agent/laws/parts/rounding.h"
#include "base/enum_names.h"

namespace mascot {

// What rows of laws (LawEntry) have in common.

/// LawEntry::make for a law that is made of its agent's configuration alone.
template <class OneLaw>
std::unique_ptr<Law> MakeOf(const Experiment& experiment, int id) {
  return std::make_unique<OneLaw>(experiment.agent(id));
}

/// LawEntry::make for a law that knows the control period, too.
template <class OneLaw>
std::unique_ptr<Law> MakeWithPeriod(const Experiment& experiment, int id) {
  return std::make_unique<OneLaw>(experiment.agent(id), experiment.period_s());
}

/// LawEntry::meter.
template <class Meter>
std::unique_ptr<LawMeter> MeterOf(const Experiment& experiment, std::span<const int> ids) {
  return std::make_unique<Meter>(experiment, ids);
}

/// Figures that theory predicts exactly.
inline std::vector<PredictedFigure> Equal(std::vector<FigureValues> figures) {
  std::vector<PredictedFigure> predicted;
  for (FigureValues& values : figures) predicted.push_back({.values = std::move(values)});
  return predicted;
}

/// LawEntry::wanted for a law that always wants a velocity.
inline Wanted WantsVelocity(const LawConfig& /*law*/) { return Wanted::kVelocity; }

/// Names of what a law wants that lets the user choose it (law.output).
inline constexpr EnumNames<Wanted, 2> kOutputs({{Wanted::kAcceleration, "acceleration"},
                                                {Wanted::kVelocity, "velocity"}});

/// Whether the law has one of two keys. Else notes a mistake: at the key `twice` if it has both, at `none` ("": the
/// table) if it has none.
inline bool HasOneOf(Section& law, std::string_view one, std::string_view other, std::string_view twice,
                     std::string_view none = "") {
  const bool has_one = law.Has(one), has_other = law.Has(other);
  if (has_one != has_other) return true;
  law.Fail(has_one ? twice : none,
           "expected one of " + std::string(one) + ", " + std::string(other) + ", got " + (has_one ? "both" : "none"));
  return false;
}

/// Notes a mistake if law.leader names an agent, in laws that have no single leader.
inline void ExpectNoLeader(const LawConfig& law, Section& section) {
  if (law.leader != 0)
    section.Fail("leader", "expected 0 (this law has no single leader), got " + std::to_string(law.leader));
}

}  // namespace mascot

#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "agent/laws/law.h"
#include "agent/laws/law_figures.h"

namespace mascot {

/// A run of a string of vehicles, each of which hears only the one before it, flown ahead on double integrators.
struct StringAhead {
  std::vector<FigureValues> figures;  ///< as `meter` has them at the end
  bool is_cut = false;                ///< an agent wanted more than its limit of the acceleration
};

/// Flies the whole experiment with `laws`, of all agents, by id - 1. Nullopt: it is too long for so many agents.
std::optional<StringAhead> FlyString(const Experiment& experiment, std::span<const std::unique_ptr<Law>> laws,
                                     LawMeter& meter);

}  // namespace mascot

#pragma once

#include <span>
#include <string_view>

#include "experiment/motion.h"

namespace mascot {

/// What anybody needs to know of a kind of agent. How its body moves is in physics_server/models/, how it is flown in
/// agent/controllers/; both have a row for each name here.
struct ModelTraits {
  std::string_view name;
  std::string_view summary;
  std::string_view actuator;  ///< what the four actuator values are, with units
  Wanted driven_by = Wanted::kAcceleration;
  /// A body with rotors, which feels gravity and air, leans to accelerate, and has an airframe's box. Others are
  /// spheres of kBallRadius_m that feel neither.
  bool has_airframe = false;
  /// Turns to control.heading_rad. Others keep the heading that they start with, or steer by it.
  bool turns_to_heading = false;
  /// Rolls in a horizontal plane and turns before it goes where it is wanted; the ground, where there is one, is what
  /// it stands on.
  bool rolls = false;
};

/// Every model there is. `orchestrator models` prints this.
std::span<const ModelTraits> Models();
std::span<const std::string_view> ModelNames();
/// The default of agents.model, as a TOML value.
std::string_view DefaultModel();
/// Throws std::invalid_argument for a name that is not in the table.
const ModelTraits& TraitsOf(std::string_view model);

}  // namespace mascot

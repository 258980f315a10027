#pragma once

#include <span>
#include <string_view>

#include "base/motion.h"

namespace mascot {

/// Properties of a model of agents. Its dynamics are in physics_server/models/, its controller in agent/controllers/;
/// both have a row for each name here.
struct ModelTraits {
  std::string_view name;
  std::string_view summary;
  std::string_view actuator;  ///< what the four actuator values are, with units
  Wanted driven_by = Wanted::kAcceleration;
  /// The body has rotors, feels gravity and air, tilts to accelerate, and collides as its airframe's box. Other bodies
  /// are spheres of kBallRadius_m that feel neither gravity nor air.
  bool has_airframe = false;
  /// The body turns to control.heading_rad. Other bodies keep their initial heading, or steer by it.
  bool turns_to_heading = false;
  /// The body rolls in a horizontal plane, on the ground if there is one, and must turn before it moves in a wanted
  /// direction.
  bool rolls = false;
};

/// All models. `orchestrator models` prints this table.
std::span<const ModelTraits> Models();
std::span<const std::string_view> ModelNames();
/// The default of agents.model, as a TOML value.
std::string_view DefaultModel();
/// The row of a model. Throws std::invalid_argument for a name that is not in the table.
const ModelTraits& TraitsOf(std::string_view model);

}  // namespace mascot

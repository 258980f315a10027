#include "experiment/model_traits.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <stdexcept>
#include <string>

namespace mascot {
namespace {

constexpr std::string_view kDefaultModel = "\"quadrotor\"";
constexpr ModelTraits kModels[] = {
    {.name = "quadrotor",
     .summary = "rigid body with four rotors, linear drag and the airframe's limits",
     .actuator = "speeds of rotors 1..4 (rad/s)",
     .driven_by = Wanted::kAcceleration,
     .has_airframe = true,
     .turns_to_heading = true},
    {.name = "double_integrator",
     .summary = "point of 1 kg without gravity: p'' = u",
     .actuator = "force x, y, z in W (N), unused",
     .driven_by = Wanted::kAcceleration},
    {.name = "single_integrator",
     .summary = "point with the velocity it is told: p' = u",
     .actuator = "velocity x, y, z in W (m/s), unused",
     .driven_by = Wanted::kVelocity},
    {.name = "unicycle",
     .summary = "rolls forward and turns in a horizontal plane: x' = v cos a, y' = v sin a, a' = w",
     .actuator = "forward speed (m/s), turning speed (rad/s), unused, unused",
     .driven_by = Wanted::kVelocity,
     .rolls = true},
};

constexpr auto kModelNames = [] {
  std::array<std::string_view, std::size(kModels)> names{};
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = kModels[i].name;
  return names;
}();

}  // namespace

std::span<const ModelTraits> Models() { return kModels; }

std::span<const std::string_view> ModelNames() { return kModelNames; }

std::string_view DefaultModel() { return kDefaultModel; }

const ModelTraits& TraitsOf(std::string_view model) {
  const ModelTraits* traits = std::ranges::find(kModels, model, &ModelTraits::name);
  if (traits == std::end(kModels)) throw std::invalid_argument("no such model: " + std::string(model));
  return *traits;
}

}  // namespace mascot

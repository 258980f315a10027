// A point that accelerates as it is told: m dv/dt = u, no gravity, no drag. What the laws' theory is about.
#include "physics_server/model.h"

namespace mascot {
namespace {

class DoubleIntegrator final : public Model {
 public:
  double mass_kg() const override { return kDoubleIntegratorMass_kg; }
  // Of a solid sphere of 0.1 m. Nothing turns it, unless it is hit.
  Eigen::Vector3d inertia_kg_m2() const override {
    return Eigen::Vector3d::Constant(0.4 * kDoubleIntegratorMass_kg * 0.1 * 0.1);
  }
  Eigen::Vector3d half_size_m() const override { return Eigen::Vector3d::Zero(); }
  bool feels_gravity() const override { return false; }

  Wrench Apply(const Actuation& command, const Motion& /*self*/, double /*dt_s*/) override {
    return {.f_W = {command[0], command[1], command[2]}, .tau_B = Eigen::Vector3d::Zero()};
  }
};

}  // namespace

std::unique_ptr<Model> MakeDoubleIntegrator(const Experiment& /*experiment*/, int /*id*/) {
  return std::make_unique<DoubleIntegrator>();
}

}  // namespace mascot

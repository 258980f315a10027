// A body that is moved from outside: a real vehicle, as it was measured. World gives it the velocity that takes it to
// its next place. Others bounce off it, and it does not feel them: its mass is beyond theirs by far.
#include "physics_server/model.h"

namespace mascot {
namespace {

constexpr double kMass_kg = 1e9;

class MovedBody final : public Model {
 public:
  explicit MovedBody(const AgentConfig& agent)
      : half_size_m_(agent.traits().has_airframe ? (agent.airframe.size_m / 2).eval()
                                                 : Eigen::Vector3d::Zero().eval()) {}
  double mass_kg() const override { return kMass_kg; }
  Eigen::Vector3d inertia_kg_m2() const override { return Eigen::Vector3d::Constant(kMass_kg); }
  Eigen::Vector3d half_size_m() const override { return half_size_m_; }
  bool feels_gravity() const override { return false; }
  bool touches_ground() const override { return false; }  // a measured height is never exact
  Push Apply(const Actuation& command, const BodyNow& /*self*/, const Surroundings& /*around*/) override {
    return {.velocity = Push::Velocity{{command[0], command[1], command[2]}, Eigen::Vector3d::Zero()}};
  }
  PushLimit LimitOf(const Actuation& command) const override {
    return {.speed_m_per_s = Eigen::Vector3d(command[0], command[1], command[2]).norm()};
  }

 private:
  Eigen::Vector3d half_size_m_;
};

}  // namespace

std::unique_ptr<Model> MakeMovedBody(const Experiment& experiment, int id) {
  return std::make_unique<MovedBody>(experiment.agent(id));
}

}  // namespace mascot

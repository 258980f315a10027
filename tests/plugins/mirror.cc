// A law whose parameters select its behaviour, for tests of everything that a plug-in may do, right or wrong.
#include <limits>
#include <stdexcept>
#include <string>

#include "agent/laws/plugin/plugin.h"

namespace {

class Mirror final : public mascot::Law {
 public:
  explicit Mirror(const mascot::PluginSetup& setup)
      : made_for_(setup.id + 10 * setup.agents + 100 * setup.leader, setup.rate_hz, static_cast<double>(setup.seed)),
        leader_(setup.leader),
        does_(setup.params.String("does", "consensus")),
        from_s_(setup.params.Number("from_s", 0, 1000, 0.0)),
        gain_(setup.params.Number("gain", 0, 10, 1.0)),
        velocity_(setup.params.Boolean("velocity", false)) {
    for (const double gain : setup.params.Numbers("more_gains", 0, 10)) gain_ += gain;
    if (const mascot::Value* bonus = setup.params.Find("bonus")) gain_ += bonus->Number();
    gain_ *= static_cast<double>(setup.params.Integer("times", 1, 9, 1));
    if (does_ == "refuse") throw std::invalid_argument("gains and\nmass do not fit");
    if (does_ == "refuse 2" && setup.id == 2) mascot::PluginParams::Fail("does", "expected a law for 2, got none");
    if (does_ == "break") throw std::runtime_error("no map for agent " + std::to_string(setup.id));
    if (does_ == "break oddly") throw 42;
  }

  mascot::Wanted wanted() const override {
    return velocity_ ? mascot::Wanted::kVelocity : mascot::Wanted::kAcceleration;
  }

  void See(std::span<const Eigen::Vector3d> nearest_W) override {
    felt_W_.setZero();
    for (const Eigen::Vector3d& point_W : nearest_W) felt_W_ += point_W;
  }

  Eigen::Vector3d Want_W(double t_s, const mascot::Motion& self, std::span<const mascot::Heard> heard) override {
    if (does_ == "tell") return made_for_;
    if (does_ == "feel") return felt_W_;
    const bool fails = t_s >= from_s_;
    if (fails && does_ == "nan") return {0, std::numeric_limits<double>::quiet_NaN(), 0};
    if (fails && does_ == "throw") throw std::domain_error("the map ends here");
    if (fails && does_ == "throw oddly") throw 42;
    Eigen::Vector3d want_W(0.1 * leader_, 0, 0);
    if (!velocity_) want_W -= self.v_WB;
    for (const mascot::Heard& j : heard) want_W += gain_ * j.weight * (j.motion.p_WB - self.p_WB);
    return want_W;
  }

  void Set(mascot::PluginParams& params) { gain_ = params.Number("gain", 0, 10, 1.0); }

 private:
  Eigen::Vector3d made_for_;
  Eigen::Vector3d felt_W_ = Eigen::Vector3d::Zero();  // the sum of the points that it sees
  int leader_;
  std::string does_;
  double from_s_;  // time from which on it fails, if does_ is a failure
  double gain_;
  bool velocity_;
};

}  // namespace

MASCOT_PLUGIN_LAW(Mirror)

#pragma once

#include <cmath>
#include <span>

#include "agent/laws/cyclic_pursuit/unicycle_pursuit.h"
#include "agent/laws/laws.h"

namespace mascot {

/// How an agent pursues the next one: by a velocity towards it or, if it is a unicycle, by its own speed and steering.
enum class PursuitKind { kLinear, kConstantSpeed, kProportionalSpeed };
inline constexpr EnumNames<PursuitKind, 3> kPursuits({{PursuitKind::kLinear, "linear"},
                                                      {PursuitKind::kConstantSpeed, "constant_speed"},
                                                      {PursuitKind::kProportionalSpeed, "proportional_speed"}});

struct CyclicPursuitParams final : LawParams {
  PursuitKind pursuit = PursuitKind::kLinear;
  double gain = 0;  ///< 1/s
  double alpha_rad = 0;
  SteeredPursuit steered;
};

/// The law of one agent, which pursues `next`.
class CyclicPursuit final : public Law {
 public:
  CyclicPursuit(const AgentConfig& agent, int next) : next_(next), look_ahead_m_(agent.control.look_ahead_m) {
    Adopt(agent);
  }
  Wanted wanted() const override { return Wanted::kVelocity; }
  void Adopt(const AgentConfig& agent) override {
    params_ = &ParamsOf<CyclicPursuitParams>(agent.law);
    const CyclicPursuitParams& params = *params_;
    const double c = std::cos(params.alpha_rad), s = std::sin(params.alpha_rad);
    turn_ << params.gain * c, params.gain * s, 0, -params.gain * s, params.gain * c, 0, 0, 0, params.gain;
  }

  Eigen::Vector3d Want_W(double /*t_s*/, const Motion& self, std::span<const Heard> heard) override {
    for (const Heard& j : heard)
      if (j.id == next_) return After_W(self, j.motion.p_WB - self.p_WB);
    return Eigen::Vector3d::Zero();
  }

 private:
  Eigen::Vector3d After_W(const Motion& self, const Eigen::Vector3d& way_W) const {
    return params_->pursuit == PursuitKind::kLinear ? turn_ * way_W
                                                    : params_->steered.Want_W(self, way_W, look_ahead_m_);
  }

  int next_;
  double look_ahead_m_;
  const CyclicPursuitParams* params_ = nullptr;  // the experiment owns them
  Eigen::Matrix3d turn_;                         // gain R(alpha)
};

}  // namespace mascot

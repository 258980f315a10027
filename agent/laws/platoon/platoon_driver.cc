// A platoon of vehicles that follow their predecessors; Ploeg, Scheepers, van Nunen, van de Wouw & Nijmeijer (2011) and
// Ploeg, van de Wouw & Nijmeijer (2014). Agent i follows agent i - 1, along x: its controller
//   headway u_i' = -u_i + p_gain e_i + d_gain e_i' + dd_gain e_i'' + u_{i-1}(t - theta)
//   e_i = x_{i-1} - x_i - spacing - headway v_i,  e_i' = v_{i-1} - v_i - headway a_i
// tells its vehicle u_i, whose acceleration then is tau a_i' = -a_i + u_i(t - phi). u_{i-1} comes by message:
// cooperative adaptive cruise control (CACC); without it, and without messages, it is adaptive cruise control (ACC).
// theta is at least a tick, which a message takes. Bodies know no lag tau and no delay phi: the law has them, so that
// what it wants is the vehicle's acceleration. Agent 1 drives a speed with a disturbance, v_r = speed + disturbance
// sin(w t), by
//   u_1 = v_r'(t + phi) + tau v_r''(t + phi) + d_gain (v_r - v_1)
// All keep to their line, a_y = p_gain (y_{i-1} - y_i) + d_gain (v_y,{i-1} - v_y,i). Each vehicle passes on what its
// predecessor does times Gamma of string_stability.h; the string is stable if |Gamma| <= 1 at all frequencies. With
// p_gain = 0.2, d_gain = 0.7, tau = 0.1 s it takes a headway of 3.16 s, or 0.67 s with messages that are 0.15 s old, as
// published; never a constant spacing.
#include <algorithm>

#include "agent/laws/laws.h"
#include "agent/laws/platoon/platoon.h"

namespace mascot {

Platoon::Platoon(const AgentConfig& agent)
    : id_(agent.id),
      params_(&ParamsOf<PlatoonParams>(agent.law)),
      control_(params_->following.message_ticks),
      vehicle_(params_->following.delay_ticks) {}

void Platoon::Adopt(const AgentConfig& agent) { params_ = &ParamsOf<PlatoonParams>(agent.law); }

Eigen::Vector3d Platoon::Want_W(double t_s, const Motion& self, std::span<const Heard> heard) {
  Eigen::Vector3d a_W = id_ == 1 ? Lead_W(t_s, self) : Follow_W(self, heard);
  a_W.x() = vehicle_.MeanAcceleration(params_->following, u_);
  return a_W;
}

Eigen::Vector3d Platoon::Lead_W(double t_s, const Motion& self) {
  const PlatoonParams& law = *params_;
  const double middle_s = t_s + law.following.h * (0.5 + law.following.delay_ticks);  // of the tick in which it acts
  u_ = law.forward * law.Push(middle_s) + law.following.d * (law.forward * law.Speed(t_s) - self.v_WB.x());
  return -law.following.d * self.v_WB;
}

Eigen::Vector3d Platoon::Follow_W(const Motion& self, std::span<const Heard> heard) {
  const PlatoonParams& law = *params_;
  const auto before = std::ranges::find(heard, id_ - 1, &Heard::id);
  if (before == heard.end()) {
    control_.LetGo(law.following);
    u_ = control_.u();
    return Eigen::Vector3d::Zero();
  }
  if (!before->message.empty()) u_before_ = before->message.front();
  const Eigen::Vector3d way_W = before->motion.p_WB - self.p_WB, speed_W = before->motion.v_WB - self.v_WB;
  const double headway_s = law.following.headway_s;
  control_.Follow(law.following, way_W.x() - law.forward * law.spacing_m - headway_s * self.v_WB.x(),
                  speed_W.x() - headway_s * self.a_WB.x(), u_before_);
  u_ = control_.u();
  return law.following.p * way_W + law.following.d * speed_W;
}

}  // namespace mascot

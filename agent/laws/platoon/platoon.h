#pragma once

#include <cmath>
#include <memory>
#include <span>

#include "agent/laws/law.h"
#include "agent/laws/law_figures.h"
#include "agent/laws/platoon/following.h"

namespace mascot {

/// The parameters of the law platoon, as its meter and its theory know them, too.
struct PlatoonParams final : LawParams {
  Following following;
  double forward = 1;  ///< 1: east, -1: west
  double spacing_m = 0, speed = 0, swing = 0, w = 0;

  /// v_r' + tau v_r'' at `t_s`.
  double Push(double t_s) const { return swing * w * (std::cos(w * t_s) - following.lag_s * w * std::sin(w * t_s)); }
  double Speed(double t_s) const { return speed + swing * std::sin(w * t_s); }
};

/// Drives one vehicle of a platoon.
class Platoon final : public Law {
 public:
  explicit Platoon(const AgentConfig& agent);
  void Adopt(const AgentConfig& agent) override;
  Eigen::Vector3d Want_W(double t_s, const Motion& self, std::span<const Heard> heard) override;
  std::span<const double> Message() override { return {&u_, 1}; }

 private:
  // Both functions set u_, the command along x, and return the accelerations across.
  Eigen::Vector3d Lead_W(double t_s, const Motion& self);
  Eigen::Vector3d Follow_W(const Motion& self, std::span<const Heard> heard);

  int id_;
  const PlatoonParams* params_;  // the experiment owns them
  FollowingControl control_;
  LaggedVehicle vehicle_;
  double u_ = 0, u_before_ = 0;  // what this vehicle, and the one before, is told (m/s^2)
};

/// LawEntry::predict and LawEntry::meter.
LawTheory PredictPlatoon(const Experiment& experiment);
std::unique_ptr<LawMeter> MakePlatoonMeter(const Experiment& experiment, std::span<const int> ids);

}  // namespace mascot

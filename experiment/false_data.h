#pragma once

#include <Eigen/Core>
#include <span>

#include "base/enum_names.h"
#include "experiment/toml/section.h"

namespace mascot {

enum class FalseDataKind { kConstant, kOscillating, kRandom };
inline constexpr EnumNames<FalseDataKind, 3> kFalseDataKinds({{FalseDataKind::kConstant, "constant"},
                                                              {FalseDataKind::kOscillating, "oscillating"},
                                                              {FalseDataKind::kRandom, "random"}});

/// `lie` of [[agents.override]]: from a time on, what others hear of the agent is false. The agent itself, its body and
/// the recording have the truth.
struct FalseDataConfig {
  FalseDataKind kind = FalseDataKind::kConstant;
  double from_s = 0;
  Eigen::Vector3d offset_m = Eigen::Vector3d::Zero();
  double period_s = 0;  ///< period of an oscillating lie

  /// Whether it is told at `t_s`, a tick divided by the rate.
  bool IsToldAt(double t_s) const {
    constexpr double kRounding_s = 1e-9;
    return t_s >= from_s - kRounding_s;
  }
};

/// The keys of `lie`.
std::span<const Key> FalseDataKeys();
FalseDataConfig ReadFalseData(Section& lie);

}  // namespace mascot

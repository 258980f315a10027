#include "orchestrator/recording/state_arrays.h"

namespace mascot {
namespace {

/// Indices into kStateArrays.
enum ArrayIndex : std::size_t {
  kTime,
  kPosition,
  kVelocity,
  kOrientation,
  kAngularVelocity,
  kAccelerationCommand,
  kActuator,
  kFlags
};
static_assert(kStateArrays[kTime].name == "t" && kStateArrays[kFlags].name == "flags");

}  // namespace

StateRow::StateRow(int agents) {
  for (std::size_t a = 0; a < values_.size(); ++a)
    values_[a].resize(kStateArrays[a].row_values(static_cast<std::size_t>(agents)));
}

void StateRow::Set(double t_s, const DecodedRow& decoded) {
  auto put = [this](ArrayIndex array, std::size_t agent, const auto& components) {
    const std::size_t width = kStateArrays[array].components.size();
    for (std::size_t c = 0; c < width; ++c) values_[array][agent * width + c] = components[c];
  };
  values_[kTime][0] = t_s;
  for (std::size_t i = 0; i < decoded.motions.size(); ++i) {
    const Motion& motion = decoded.motions[i];
    const double wxyz[] = {motion.q_WB.w(), motion.q_WB.x(), motion.q_WB.y(), motion.q_WB.z()};
    put(kPosition, i, motion.p_WB);
    put(kVelocity, i, motion.v_WB);
    put(kOrientation, i, wxyz);
    put(kAngularVelocity, i, motion.w_WB_B);
    put(kAccelerationCommand, i, decoded.commands[i].a_limited_W);
    put(kActuator, i, decoded.commands[i].actuator);
    put(kFlags, i, std::array{static_cast<double>(decoded.commands[i].flags)});
  }
}

}  // namespace mascot

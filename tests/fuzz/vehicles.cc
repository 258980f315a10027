// Fuzzer: any bytes as a message of a vehicle, or of a script that flies Crazyflies. They are refused, or are what the
// headers promise; whatever a script asks for, its Crazyflie is given numbers.
#include <cmath>
#include <span>
#include <vector>

#include "orchestrator/crazyswarm/commander.h"
#include "orchestrator/crazyswarm/requests.h"
#include "tests/fuzz/fuzz.h"
#include "vehicle/ardupilot/messages.h"
#include "vehicle/crazyswarm/messages.h"
#include "vehicle/px4/messages.h"

namespace mascot {
namespace {

using Sample = std::span<const std::uint8_t>;

template <class Read>
void ExpectPx4(Sample sample, const Read& read) {
  px4::UnknownSample unknown;
  const auto message = read(sample, unknown);
  Require(message.has_value() == unknown.words.empty(), "refused without words, or read with some");
}

void ReadPx4(FuzzedDataProvider& input, Sample sample) {
  const std::string_view topic = px4::kStatusTopics[input.ConsumeIntegralInRange<std::size_t>(0, 2)];
  ExpectPx4(sample, [&](Sample s, px4::UnknownSample& unknown) { return px4::ReadStatus(topic, s, unknown); });
  ExpectPx4(sample, [](Sample s, px4::UnknownSample& unknown) { return px4::ReadOdometry(s, unknown); });
  ExpectPx4(sample, [](Sample s, px4::UnknownSample& unknown) { return px4::ReadLandDetected(s, unknown); });
  const std::string_view ack = px4::kAckTopics[input.ConsumeIntegralInRange<std::size_t>(0, 1)];
  ExpectPx4(sample, [&](Sample s, px4::UnknownSample& unknown) { return px4::ReadAck(ack, s, unknown); });
}

void ReadRos(Sample sample) {
  ardupilot::ReadPose(sample);
  ardupilot::ReadTwist(sample);
  ardupilot::ReadStatus(sample);
  ardupilot::ReadBattery(sample);
  ardupilot::ReadReply(sample);
  crazyswarm::ReadPose(sample);
  crazyswarm::ReadPoses(sample);
  crazyswarm::ReadStatus(sample);
  crazyswarm::ReadNames(sample);
  if (const auto count = crazyswarm::ReadCount(sample)) crazyswarm::NotSetReply(*count);
}

/// A Crazyflie in the air does what the sample asks for; before, meanwhile and after it has numbers.
void Obey(FuzzedDataProvider& input, Sample sample) {
  crazyswarm::Commander commander(Eigen::Vector3d::Zero());
  const Eigen::Vector3d p_W(1, 2, 3);
  commander.TakeOff(1, 1, p_W, 0);
  crazyswarm::Trajectory trajectory({{.axes = {{{0, 1}, {0, 1}, {0, 1}}}, .duration_s = 2}});
  double duration_s = 10;
  if (const auto height = crazyswarm::ReadHeight(sample)) {
    if (input.ConsumeBool()) commander.TakeOff(height->height_m, height->duration_s, p_W, 5);
    commander.Land(height->height_m, height->duration_s, p_W, 5);
  }
  if (const auto go = crazyswarm::ReadGoTo(sample)) commander.GoTo(go->goal, go->relative, go->duration_s, p_W, 5);
  if (const auto upload = crazyswarm::ReadUpload(sample)) {
    trajectory = crazyswarm::Trajectory(upload->pieces);
    duration_s = trajectory.duration_s();
    commander.Follow(trajectory, 2, input.ConsumeBool(), input.ConsumeBool(), p_W, 5);
  }
  if (const auto follow = crazyswarm::ReadFollow(sample))
    commander.Follow(trajectory, follow->timescale, follow->reversed, follow->relative, p_W, 5);
  for (const auto& streamed : {crazyswarm::ReadFullState(sample), crazyswarm::ReadPosition(sample),
                               crazyswarm::ReadVelocityWorld(sample), crazyswarm::ReadHover(sample, 1)})
    if (streamed && input.ConsumeBool()) commander.Stream(*streamed, 5);
  for (const double now : {5.0, 5.4, 6.0, 5 + duration_s / 3, 5 + duration_s, 1e9})
    if (const auto setpoint = commander.At(now))
      for (const Eigen::Vector3d& vector : {setpoint->p_W, setpoint->v_W, setpoint->a_W})
        Require(!vector.array().isInf().any(), "a set-point without bounds");
}

}  // namespace
}  // namespace mascot

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzedDataProvider input(data, size);
  const auto choices = input.ConsumeIntegral<std::uint8_t>();
  const std::vector<std::uint8_t> sample = input.ConsumeRemainingBytes<std::uint8_t>();
  FuzzedDataProvider from_choices(&choices, 1);
  FuzzedDataProvider again(&choices, 1);
  mascot::ReadPx4(from_choices, sample);
  mascot::ReadRos(sample);
  mascot::Obey(again, sample);
  return 0;
}

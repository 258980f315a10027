#include "vehicle/px4/messages.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

namespace mascot::px4 {
namespace {

static_assert(std::endian::native == std::endian::little);

constexpr std::array<std::uint8_t, 4> kEncapsulation = {0, 1, 0, 0};  // CDR, little-endian

/// A release's length of a message (bytes), on a topic.
struct Length {
  std::string_view topic;
  std::size_t bytes;
  Release release;
};
constexpr Length kStatusLengths[] = {{"vehicle_status", 71, Release::k1_14},
                                     {"vehicle_status", 82, Release::k1_15},
                                     {"vehicle_status_v1", 80, Release::k1_16_or_1_17},
                                     {"vehicle_status_v4", 83, Release::k1_18}};
constexpr Length kAckLengths[] = {{"vehicle_command_ack", 23, Release::k1_14},
                                  {"vehicle_command_ack", 25, Release::k1_15},
                                  {"vehicle_command_ack_v1", 25, Release::k1_18}};
constexpr Length kOdometryLengths[] = {{"vehicle_odometry", 114, Release::k1_14}};
constexpr Length kLandDetectedLengths[] = {{"vehicle_land_detected", 20, Release::k1_14}};

/// Whether a sample of `size` bytes holds a message of `message` bytes, perhaps padded.
bool Fits(std::size_t size, std::size_t message) {
  return size >= kEncapsulation.size() + message && size <= (kEncapsulation.size() + message + 3) / 4 * 4;
}

std::string ListOf(std::span<const Length> known, std::string_view topic) {
  std::string list;
  for (const Length& each : known)
    if (each.topic == topic) list += fmt::format("{}{} ({})", list.empty() ? "" : ", ", each.bytes, Name(each.release));
  return list;
}

/// The row of the sample; null and `unknown`, if there is none.
const Length* RowOf(std::string_view topic, std::span<const std::uint8_t> sample, std::span<const Length> known,
                    UnknownSample& unknown) {
  // The first two bytes are the encoding; big-endian CDR and others are not what an autopilot's bridge sends.
  const bool is_cdr = sample.size() >= kEncapsulation.size() &&
                      std::equal(kEncapsulation.begin(), kEncapsulation.begin() + 2, sample.begin());
  const auto row = std::ranges::find_if(
      known, [&](const Length& each) { return each.topic == topic && is_cdr && Fits(sample.size(), each.bytes); });
  if (row != known.end()) return &*row;
  const std::string list = ListOf(known, topic);
  const std::size_t bytes = sample.size() - std::min(sample.size(), kEncapsulation.size());
  unknown.words = list.empty() ? fmt::format("{}: no release that is known has this topic", topic)
                  : is_cdr || sample.size() < kEncapsulation.size()
                      ? fmt::format("{} bytes of {}: the known lengths are {}", bytes, topic, list)
                      : fmt::format("{}: an encoding other than little-endian CDR", topic);
  return nullptr;
}

/// A message's fields at places that are known.
class Fields {
 public:
  explicit Fields(std::span<const std::uint8_t> sample) : body_(sample.subspan(kEncapsulation.size())) {}
  template <class T>
  T At(std::size_t place) const {
    T value;
    std::memcpy(&value, body_.subspan(place, sizeof value).data(), sizeof value);
    return value;
  }
  Eigen::Vector3d Vector(std::size_t place) const {
    return {double{At<float>(place)}, double{At<float>(place + 4)}, double{At<float>(place + 8)}};
  }

 private:
  std::span<const std::uint8_t> body_;
};

/// Appends a message's fields, each aligned to its own size.
class Message {
 public:
  Message() : bytes_(kEncapsulation.begin(), kEncapsulation.end()) {}
  template <class T>
  Message& Add(T value) {
    while ((bytes_.size() - kEncapsulation.size()) % sizeof value != 0) bytes_.push_back(0);
    const std::size_t place = bytes_.size();
    bytes_.resize(place + sizeof value);
    std::memcpy(&bytes_[place], &value, sizeof value);
    return *this;
  }
  Message& Add(const Eigen::Vector3d& vector) {
    for (const double number : vector) Add(static_cast<float>(number));
    return *this;
  }
  /// The sample, padded as RTPS pads it.
  Bytes Done() {
    bytes_.resize((bytes_.size() + 3) / 4 * 4);
    return std::move(bytes_);
  }

 private:
  Bytes bytes_;
};

}  // namespace

std::string_view Name(Release release) {
  switch (release) {
    case Release::k1_14:
      return "1.14";
    case Release::k1_15:
      return "1.15";
    case Release::k1_16_or_1_17:
      return "1.16 or 1.17";
    case Release::k1_18:
      return "1.18";
  }
  return "";
}

std::optional<Status> ReadStatus(std::string_view topic, std::span<const std::uint8_t> sample, UnknownSample& unknown) {
  const Length* const row = RowOf(topic, sample, kStatusLengths, unknown);
  if (row == nullptr) return std::nullopt;
  constexpr std::size_t kArmingState = 24, kNavState = 41;
  const Fields fields(sample);
  return Status{.release = row->release,
                .arming_state = fields.At<std::uint8_t>(kArmingState),
                .nav_state = fields.At<std::uint8_t>(kNavState)};
}

std::optional<Odometry> ReadOdometry(std::span<const std::uint8_t> sample, UnknownSample& unknown) {
  if (RowOf("vehicle_odometry", sample, kOdometryLengths, unknown) == nullptr) return std::nullopt;
  constexpr std::size_t kPoseFrame = 16, kPosition = 20, kOrientation = 32, kVelocityFrame = 48, kVelocity = 52,
                        kAngular = 64, kResetCounter = 112;
  const Fields fields(sample);
  const auto q = [&](std::size_t k) { return double{fields.At<float>(kOrientation + 4 * k)}; };
  return Odometry{.timestamp_us = fields.At<std::uint64_t>(0),
                  .pose_frame = Odometry::PoseFrame{fields.At<std::uint8_t>(kPoseFrame)},
                  .velocity_frame = Odometry::VelocityFrame{fields.At<std::uint8_t>(kVelocityFrame)},
                  .p_N = fields.Vector(kPosition),
                  .q_NF = Eigen::Quaterniond(q(0), q(1), q(2), q(3)),
                  .v = fields.Vector(kVelocity),
                  .w_F = fields.Vector(kAngular),
                  .reset_counter = fields.At<std::uint8_t>(kResetCounter)};
}

std::optional<Ack> ReadAck(std::string_view topic, std::span<const std::uint8_t> sample, UnknownSample& unknown) {
  if (RowOf(topic, sample, kAckLengths, unknown) == nullptr) return std::nullopt;
  constexpr std::size_t kCommand = 8, kResult = 12;
  const Fields fields(sample);
  return Ack{.command = fields.At<std::uint32_t>(kCommand), .result = fields.At<std::uint8_t>(kResult)};
}

std::optional<LandDetected> ReadLandDetected(std::span<const std::uint8_t> sample, UnknownSample& unknown) {
  if (RowOf("vehicle_land_detected", sample, kLandDetectedLengths, unknown) == nullptr) return std::nullopt;
  constexpr std::size_t kLanded = 11;
  return LandDetected{.landed = Fields(sample).At<std::uint8_t>(kLanded) != 0};
}

Bytes OffboardControlMode(Release release, Controlled controlled) {
  Message message;
  message.Add(std::uint64_t{0});
  for (const Controlled each : {Controlled::kPosition, Controlled::kVelocity, Controlled::kAcceleration})
    message.Add(static_cast<std::uint8_t>(each == controlled));
  // Attitude, body rates, and what is below these.
  const int others = release == Release::k1_14 ? 3 : 4;
  for (int k = 0; k < others; ++k) message.Add(std::uint8_t{0});
  return message.Done();
}

Bytes TrajectorySetpoint(const Setpoint& setpoint) {
  constexpr double kNotControlled = std::numeric_limits<double>::quiet_NaN();
  return Message()
      .Add(std::uint64_t{0})
      .Add(setpoint.p_N)
      .Add(setpoint.v_N)
      .Add(setpoint.a_N)
      .Add(Eigen::Vector3d::Constant(kNotControlled).eval())  // jerk, which is for logs
      .Add(static_cast<float>(setpoint.yaw_rad))
      .Add(static_cast<float>(kNotControlled))  // yaw rate
      .Done();
}

Bytes VehicleCommand(Release release, const Command& command) {
  constexpr std::uint8_t kAutopilot = 1, kUs = 1;
  Message message;
  message.Add(std::uint64_t{0}).Add(command.param1).Add(command.param2).Add(0.0F).Add(0.0F);
  message.Add(0.0).Add(0.0).Add(0.0F);  // parameters 5 and 6, which may be degrees, then 7
  message.Add(static_cast<std::uint32_t>(command.order));
  message.Add(command.target_system).Add(kAutopilot).Add(kUs);
  if (release == Release::k1_14)
    message.Add(kUs);
  else
    message.Add(std::uint16_t{kUs});
  message.Add(std::uint8_t{0});  // confirmation
  message.Add(std::uint8_t{1});  // it comes from outside
  return message.Done();
}

}  // namespace mascot::px4

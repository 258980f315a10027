#include "orchestrator/crazyswarm/requests.h"

#include <cmath>
#include <limits>
#include <utility>

#include "bus/ros_cdr.h"

namespace mascot::crazyswarm {
namespace {

using eprosima::fastcdr::exception::BadParamException;
using ros::Cdr;
using ros::Fields;
using ros::ReadAs;
using ros::Written;

constexpr double kFree = std::numeric_limits<double>::quiet_NaN();
const Eigen::Vector3d kFreeVector = Eigen::Vector3d::Constant(kFree);
constexpr std::uint32_t kMostPieces = 1000, kMostNames = 100;
constexpr std::size_t kLongestReply = 65'536;
constexpr std::string_view kFrame = "world";
constexpr float kFullBattery_V = 4.1F;

// Numbers that a Crazyflie can be sent to. Refused is what is no number, or beyond all reason.
double Sane(double number) {
  constexpr double kBeyondReason = 1e6;  // m, m/s, m/s^2, s
  if (!(std::abs(number) < kBeyondReason)) throw BadParamException("no number, or one beyond reason");
  return number;
}
double Number(Fields& fields) { return Sane(double{fields.Next<float>()}); }
Eigen::Vector3d Vector(Fields& fields) { return fields.Vector().unaryExpr(&Sane); }
double Duration(Fields& fields) {
  const double duration_s = fields.Duration();
  if (duration_s < 0) throw BadParamException("a negative duration");
  return Sane(duration_s);
}

std::array<double, Trajectory::kCoefficients> Coefficients(Fields& fields) {
  std::array<double, Trajectory::kCoefficients> coefficients{};
  const auto read = fields.Sequence(Trajectory::kCoefficients, [&] { return Number(fields); });
  std::ranges::copy(read, coefficients.begin());
  return coefficients;
}

void WriteHeader(Cdr& cdr, double time_s) {
  const double seconds = std::floor(time_s);
  cdr << static_cast<std::int32_t>(seconds)
      << static_cast<std::uint32_t>(std::lround(1e9 * (time_s - seconds)) % 1'000'000'000) << std::string(kFrame);
}

void WritePose(Cdr& cdr, const Motion& motion) {
  ros::Write(cdr, motion.p_WB);
  for (const double x : motion.q_WB.coeffs()) cdr << x;  // x, y, z, w
}

/// rcl_interfaces/ParameterValue.
void WriteParameter(Cdr& cdr, const Parameter& parameter) {
  constexpr std::uint8_t kNotSet = 0, kString = 4, kDoubles = 8;
  cdr << (parameter.position ? kDoubles : parameter.text ? kString : kNotSet);
  cdr << false << std::int64_t{0} << 0.0 << parameter.text.value_or("");
  cdr << std::uint32_t{0} << std::uint32_t{0} << std::uint32_t{0};  // octets, booleans, integers
  cdr << std::uint32_t{parameter.position ? 3U : 0U};
  if (parameter.position) ros::Write(cdr, *parameter.position);
  cdr << std::uint32_t{0};  // strings
}

}  // namespace

std::optional<bool> ReadArm(std::span<const std::uint8_t> sample) {
  return ReadAs<bool>(sample, [](Fields& fields) { return fields.Next<bool>(); });
}

std::optional<HeightRequest> ReadHeight(std::span<const std::uint8_t> sample) {
  return ReadAs<HeightRequest>(sample, [](Fields& fields) {
    fields.Next<std::uint8_t>();  // group
    const double height_m = Number(fields);
    return HeightRequest{height_m, Duration(fields)};
  });
}

std::optional<GoToRequest> ReadGoTo(std::span<const std::uint8_t> sample) {
  return ReadAs<GoToRequest>(sample, [](Fields& fields) {
    GoToRequest request;
    fields.Next<std::uint8_t>();  // group
    request.relative = fields.Next<bool>();
    request.goal = Vector(fields);
    fields.Next<float>();  // yaw
    request.duration_s = Duration(fields);
    return request;
  });
}

std::optional<UploadRequest> ReadUpload(std::span<const std::uint8_t> sample) {
  return ReadAs<UploadRequest>(sample, [](Fields& fields) {
    UploadRequest request;
    request.trajectory = fields.Next<std::uint8_t>();
    request.offset = fields.Next<std::uint32_t>();
    request.pieces = fields.Sequence(kMostPieces, [&] {
      Trajectory::Piece piece;
      for (auto& axis : piece.axes) axis = Coefficients(fields);
      Coefficients(fields);  // of yaw
      piece.duration_s = Duration(fields);
      return piece;
    });
    return request;
  });
}

std::optional<FollowRequest> ReadFollow(std::span<const std::uint8_t> sample) {
  return ReadAs<FollowRequest>(sample, [](Fields& fields) {
    FollowRequest request;
    fields.Next<std::uint8_t>();  // group
    request.trajectory = fields.Next<std::uint8_t>();
    request.timescale = Number(fields);
    if (!(request.timescale > 0)) throw BadParamException("no timescale");
    request.reversed = fields.Next<bool>();
    request.relative = fields.Next<bool>();
    return request;
  });
}

std::optional<Setpoint> ReadFullState(std::span<const std::uint8_t> sample) {
  return ReadAs<Setpoint>(sample, [](Fields& fields) {
    Setpoint setpoint;
    fields.Header();
    setpoint.p_W = Vector(fields);
    fields.Quaternion();
    setpoint.v_W = Vector(fields);
    fields.Vector();  // angular velocity
    setpoint.a_W = Vector(fields);
    return setpoint;
  });
}

std::optional<Setpoint> ReadPosition(std::span<const std::uint8_t> sample) {
  return ReadAs<Setpoint>(sample, [](Fields& fields) {
    Setpoint setpoint{kFreeVector, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
    fields.Header();
    for (double& x : setpoint.p_W) x = Number(fields);
    return setpoint;
  });
}

std::optional<Setpoint> ReadVelocityWorld(std::span<const std::uint8_t> sample) {
  return ReadAs<Setpoint>(sample, [](Fields& fields) {
    fields.Header();
    return Setpoint{kFreeVector, Vector(fields), Eigen::Vector3d::Zero()};
  });
}

std::optional<Setpoint> ReadHover(std::span<const std::uint8_t> sample, double yaw_rad) {
  return ReadAs<Setpoint>(sample, [yaw_rad](Fields& fields) {
    fields.Header();
    const double forward = Number(fields), left = Number(fields);
    fields.Next<float>();  // yaw rate
    const double z = Number(fields), c = std::cos(yaw_rad), s = std::sin(yaw_rad);
    return Setpoint{{kFree, kFree, z}, {c * forward - s * left, s * forward + c * left, 0}, Eigen::Vector3d::Zero()};
  });
}

std::optional<std::vector<std::string>> ReadNames(std::span<const std::uint8_t> sample) {
  return ReadAs<std::vector<std::string>>(
      sample, [](Fields& fields) { return fields.Sequence(kMostNames, [&] { return fields.Next<std::string>(); }); });
}

std::optional<std::size_t> ReadCount(std::span<const std::uint8_t> sample) {
  const auto count =
      ReadAs<std::size_t>(sample, [](Fields& fields) { return std::size_t{fields.Next<std::uint32_t>()}; });
  return count && *count <= kMostNames ? count : std::nullopt;
}

Bytes EmptyReply() {
  return Written([](Cdr& cdr) { cdr << std::uint8_t{0}; });  // a message without fields has one byte
}

Bytes ParametersReply(const std::vector<Parameter>& parameters) {
  return Written(
      [&](Cdr& cdr) {
        cdr << static_cast<std::uint32_t>(parameters.size());
        for (const Parameter& parameter : parameters) WriteParameter(cdr, parameter);
      },
      kLongestReply);
}

Bytes NoParametersReply() {
  return Written([](Cdr& cdr) { cdr << std::uint32_t{0} << std::uint32_t{0}; });
}

Bytes NoDescriptorsReply(std::size_t names) {
  return Written(
      [&](Cdr& cdr) {
        cdr << static_cast<std::uint32_t>(names);
        for (std::size_t k = 0; k < names; ++k)
          cdr << std::string() << std::uint8_t{0} << std::string() << std::string() << false << false
              << std::uint32_t{0} << std::uint32_t{0};
      },
      kLongestReply);
}

Bytes NotSetReply(std::size_t parameters) {
  return Written(
      [&](Cdr& cdr) {
        cdr << static_cast<std::uint32_t>(parameters);
        for (std::size_t k = 0; k < parameters; ++k)
          cdr << false << std::string("a simulated Crazyflie has no parameters");
      },
      kLongestReply);
}

Bytes PoseSample(const Motion& motion, double time_s) {
  return Written([&](Cdr& cdr) {
    WriteHeader(cdr, time_s);
    WritePose(cdr, motion);
  });
}

Bytes OdometrySample(const Motion& motion, const std::string& name, double time_s) {
  constexpr int kCovariances = 36;
  return Written([&](Cdr& cdr) {
    WriteHeader(cdr, time_s);
    cdr << name;
    WritePose(cdr, motion);
    for (int k = 0; k < kCovariances; ++k) cdr << 0.0;
    ros::Write(cdr, motion.q_WB.conjugate() * motion.v_WB);
    ros::Write(cdr, motion.w_WB_B);
    for (int k = 0; k < kCovariances; ++k) cdr << 0.0;
  });
}

Bytes PosesSample(const std::vector<std::pair<std::string, Motion>>& motions, double time_s) {
  constexpr std::size_t kLongestPose = 128;
  return Written(
      [&](Cdr& cdr) {
        WriteHeader(cdr, time_s);
        cdr << static_cast<std::uint32_t>(motions.size());
        for (const auto& [name, motion] : motions) {
          cdr << name;
          WritePose(cdr, motion);
        }
      },
      kLongestPose * (1 + motions.size()));
}

Bytes StatusSample(bool is_armed, bool is_flying, bool is_locked, double time_s) {
  constexpr unsigned kCanBeArmed = 1, kIsArmed = 2, kCanFly = 8, kIsFlying = 16, kIsLocked = 64;
  const unsigned supervisor = (is_armed || is_locked ? 0 : kCanBeArmed) | (is_armed ? kIsArmed | kCanFly : 0) |
                              (is_flying ? kIsFlying : 0) | (is_locked ? kIsLocked : 0);
  return Written([&](Cdr& cdr) {
    WriteHeader(cdr, time_s);
    cdr << static_cast<std::uint16_t>(supervisor) << kFullBattery_V << std::uint8_t{0} << std::uint8_t{0};
    for (int k = 0; k < 4; ++k) cdr << std::uint32_t{0};  // packets of a radio that is not there
    cdr << std::uint16_t{0};
  });
}

}  // namespace mascot::crazyswarm

#include "bus/sample_layout.h"

#include <algorithm>
#include <bit>

#include "bus/wire.h"

namespace mascot {
namespace {

static_assert(std::endian::native == std::endian::little && sizeof(Actuation) == 32);

// Places in a body.
constexpr std::size_t kNanosec = 4, kTick = 8, kAgent = 16, kMore = 20, kFields = 24;
// Of a state: position and orientation (x, y, z, w), velocity, angular velocity, acceleration.
constexpr std::size_t kPosition = kFields, kOrientation = 48, kLinear = 80, kAngular = 104, kAcceleration = 128;
static_assert(kAcceleration + 24 == kStateBody);
// Of a command.
constexpr std::size_t kActuator = kFields, kWanted = 56, kLimited = 80;
static_assert(kLimited + 24 == kCommandBody);

template <class T>
void Put(const T& value, std::uint8_t* place) {
  std::memcpy(place, &value, sizeof value);
}
template <class T>
T Get(const std::uint8_t* place) {
  T value;
  std::memcpy(&value, place, sizeof value);
  return value;
}
void PutVector(const Eigen::Vector3d& vector, std::uint8_t* place) { std::memcpy(place, vector.data(), 24); }
void GetVector(const std::uint8_t* place, Eigen::Vector3d& vector) { std::memcpy(vector.data(), place, 24); }

void PutStamp(std::int64_t tick, int rate_hz, std::uint8_t* body) {
  constexpr std::uint64_t kSecond_ns = 1'000'000'000;
  const std::uint64_t ns = StampNs(tick, rate_hz);
  Put(static_cast<std::uint32_t>(ns / kSecond_ns), body);
  Put(static_cast<std::uint32_t>(ns % kSecond_ns), body + kNanosec);
}

void PutHead(std::int64_t tick, int rate_hz, int agent, std::uint32_t more, std::uint8_t* body) {
  PutStamp(tick, rate_hz, body);
  Put(static_cast<std::uint64_t>(tick), body + kTick);
  Put(static_cast<std::uint32_t>(agent), body + kAgent);
  Put(more, body + kMore);
}

}  // namespace

std::uint8_t* BodyIn(std::vector<std::uint8_t>& sample, std::size_t size) {
  sample.resize(kEncapsulation.size() + size);
  std::ranges::copy(kEncapsulation, sample.begin());
  return sample.data() + kEncapsulation.size();
}

BodyHead HeadOf(const std::uint8_t* body) {
  return {.tick = Get<std::uint64_t>(body + kTick),
          .agent = Get<std::uint32_t>(body + kAgent),
          .more = Get<std::uint32_t>(body + kMore)};
}

void PutClock(std::int64_t tick, int rate_hz, std::uint8_t* body) { PutStamp(tick, rate_hz, body); }

void PutState(std::int64_t tick, int rate_hz, int agent, int events, const Motion& motion, std::uint8_t* body) {
  PutHead(tick, rate_hz, agent, static_cast<std::uint32_t>(events), body);
  PutVector(motion.p_WB, body + kPosition);
  std::memcpy(body + kOrientation, motion.q_WB.coeffs().data(), 32);
  PutVector(motion.v_WB, body + kLinear);
  PutVector(motion.w_WB_B, body + kAngular);
  PutVector(motion.a_WB, body + kAcceleration);
}

void PutCommand(std::int64_t tick, int rate_hz, int agent, const Command& command, std::uint8_t* body) {
  PutHead(tick, rate_hz, agent, command.flags, body);
  Put(command.actuator, body + kActuator);
  PutVector(command.a_law_W, body + kWanted);
  PutVector(command.a_limited_W, body + kLimited);
}

void PutMessage(std::int64_t tick, int rate_hz, int agent, std::span<const double> message, std::uint8_t* body) {
  PutHead(tick, rate_hz, agent, static_cast<std::uint32_t>(message.size()), body);
  if (!message.empty()) std::memcpy(body + kFields, message.data(), message.size_bytes());
}

void GetState(const std::uint8_t* body, Motion& motion) {
  GetVector(body + kPosition, motion.p_WB);
  std::memcpy(motion.q_WB.coeffs().data(), body + kOrientation, 32);
  GetVector(body + kLinear, motion.v_WB);
  GetVector(body + kAngular, motion.w_WB_B);
  GetVector(body + kAcceleration, motion.a_WB);
}

void GetCommand(const std::uint8_t* body, Command& command) {
  command = {.actuator = ActuationOf(body), .flags = Get<std::uint32_t>(body + kMore)};
  GetVector(body + kWanted, command.a_law_W);
  GetVector(body + kLimited, command.a_limited_W);
}

Actuation ActuationOf(const std::uint8_t* command_body) { return Get<Actuation>(command_body + kActuator); }

void GetMessage(const std::uint8_t* body, std::vector<double>& numbers) {
  numbers.resize(HeadOf(body).more);
  if (!numbers.empty()) std::memcpy(numbers.data(), body + kFields, sizeof(double) * numbers.size());
}

}  // namespace mascot

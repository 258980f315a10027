#include "vehicle/process/vehicle_node.h"

#include <algorithm>
#include <limits>

#include "base/utf8.h"
#include "vehicle/kinds.h"

namespace mascot {

using namespace std::chrono_literals;

namespace {

using Clock = std::chrono::steady_clock;

constexpr auto kTurn = 10ms;         // without news
constexpr auto kStreamEvery = 20ms;  // without a command
constexpr auto kSayEvery = 200ms;    // without news
constexpr std::size_t kMaxWords = 1024, kMaxRelease = 64;

}  // namespace

VehicleNode::VehicleNode(Domain& domain, Lifecycle& lifecycle, const Experiment& experiment, int agent,
                         const OutsideDomain::Options& outside)
    : lifecycle_(lifecycle),
      experiment_(experiment),
      agent_(agent),
      pilot_(PilotRulesOf(experiment, agent)),
      autopilot_(MakeAutopilot(outside, experiment.agent(agent).vehicle.value(), [&lifecycle] { lifecycle.Wake(); })),
      motions_(domain, Topic::Measured(agent)),
      statuses_(domain, Topic::Vehicle(agent)),
      commands_(domain, experiment, agent,
                [this](std::int64_t tick, const Eigen::Vector3d& a_W) { OnCommand(tick, a_W); }),
      requests_(domain, Topic::Request(), [this](const mascot_msgs::msg::Request& request, const Sender& sender) {
        if (sender.process == kOrchestrator) OnRequest(request);
      }) {
  status_.agent(static_cast<std::uint32_t>(agent));
}

bool VehicleNode::Matched() const {
  return motions_.matched() >= 1 && statuses_.matched() >= 1 && commands_.Matched() && requests_.matched() >= 1;
}

void VehicleNode::Run() {
  lifecycle_.Set(Life::kMatching);
  while (!Matched()) lifecycle_.Wait(50ms);
  lifecycle_.Set(Life::kReady);
  for (;;) {
    Turn();
    lifecycle_.Wait(kTurn);
  }
}

void VehicleNode::OnCommand(std::int64_t tick, const Eigen::Vector3d& a_W) {
  {
    const std::lock_guard lock(mutex_);
    pilot_.Command(tick, a_W, Clock::now());
    if (tick == experiment_.ticks()) pilot_.Land("the run is over");
    is_commanded_ = true;
  }
  lifecycle_.Wake();
}

void VehicleNode::OnRequest(const mascot_msgs::msg::Request& request) {
  const auto ask = static_cast<Ask>(request.kind());
  const bool to_us = std::ranges::find(request.agents(), static_cast<std::uint32_t>(agent_)) != request.agents().end();
  {
    const std::lock_guard lock(mutex_);
    if (ask == Ask::kStop) pilot_.Land("the run is stopped");
    if (ask == Ask::kStart && to_us) pilot_.Start();
    if (ask == Ask::kLand && to_us) pilot_.Land(request.reason().to_string());
    if (ask == Ask::kStopMotors && to_us) pilot_.StopMotors(request.reason().to_string());
  }
  lifecycle_.Wake();
}

void VehicleNode::Turn() {
  const VehicleReport report = autopilot_->Report();
  const Time now = Clock::now();
  Pilot::Turn turn;
  bool is_commanded = false;
  {
    const std::lock_guard lock(mutex_);
    turn = pilot_.Look(report, now);
    is_commanded = std::exchange(is_commanded_, false);
    if (pilot_.motion_W() && report.measured_at != published_at_) {
      ToWire(pilot_.reference().tick(), experiment_.control.rate_hz, agent_, /*events=*/0, *pilot_.motion_W(), motion_);
      motions_.Write(motion_);
      published_at_ = report.measured_at;
    }
    Say(report, now);
  }
  if (turn.setpoint && (is_commanded || now - streamed_at_ >= kStreamEvery)) {
    autopilot_->Stream(*turn.setpoint);
    streamed_at_ = now;
  }
  if (turn.order) autopilot_->Ask(*turn.order);
}

void VehicleNode::Say(const VehicleReport& report, Time now) {
  const std::vector<std::string> words = pilot_.TakeWords();
  if (words.empty() && now - said_at_ < kSayEvery) return;
  status_.phase(static_cast<std::uint8_t>(pilot_.phase()));
  status_.battery(report.battery.value_or(std::numeric_limits<double>::quiet_NaN()));
  status_.release(std::string(CutUtf8(report.release, kMaxRelease)));
  for (const std::string& text : words) {
    status_.number(status_.number() + 1);
    status_.words(std::string(CutUtf8(text, kMaxWords)));
    statuses_.Write(status_);
  }
  if (words.empty()) statuses_.Write(status_);
  said_at_ = now;
}

}  // namespace mascot

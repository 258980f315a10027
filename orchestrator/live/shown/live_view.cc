#include "orchestrator/live/shown/live_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>
#include <utility>

#include "bus/addresses.h"
#include "bus/wire.h"
#include "experiment/phase.h"
#include "idl/topics.h"
#include "orchestrator/formats/outside_json.h"
#include "orchestrator/live/shown/metric_curves.h"

namespace mascot {
namespace {

/// The protocol of the SDK, then the one of the clients before it.
constexpr const char* kSubprotocols[] = {"foxglove.sdk.v1", "foxglove.websocket.v1"};
constexpr int kFramesPerSecond = 30;
constexpr auto kPaceWindow = std::chrono::seconds(1);

Foxglove::Payload Shared(std::string text) { return std::make_shared<const std::string>(std::move(text)); }

SocketOptions OptionsOf(const LiveView::Options& options) {
  return {.address = options.address,
          .port = options.port,
          .subprotocols = {std::begin(kSubprotocols), std::end(kSubprotocols)},
          .allowed_origins = options.allowed_origins,
          .period = std::chrono::milliseconds(1000 / kFramesPerSecond),
          .limits = {.goodbye = options.goodbye}};
}

}  // namespace

LiveView::LiveView(const Experiment& experiment, const Prediction& prediction, const RunMeter& meter,
                   RunControl& control, const Options& options, std::function<void(const std::string&)> log)
    : LiveView(experiment, prediction, &meter, control, options, std::move(log)) {}

LiveView::LiveView(const Experiment& experiment, const Prediction& prediction, RunControl& control,
                   const Options& options, std::function<void(const std::string&)> log)
    : LiveView(experiment, prediction, nullptr, control, options, std::move(log)) {}

LiveView::LiveView(const Experiment& experiment, const Prediction& prediction, const RunMeter* meter,
                   RunControl& control, const Options& options, std::function<void(const std::string&)> log)
    : experiment_(experiment),
      prediction_(prediction),
      responses_(ResponsesOf(experiment, prediction)),
      meter_(meter),
      left_out_(experiment),
      source_(options.source),
      pages_(options.page, options.results),
      steering_(options.steering),
      newest_(experiment.size()),
      state_{.pace = options.pace},
      shown_(experiment.size()),
      shown_state_(state_),
      ros_(experiment),
      ros_channels_(ros_.channels().size()),
      latched_{Shared(ExperimentJson(experiment, TheoryOf(experiment), source_, {})),
               nullptr,
               Shared(EventsJson(experiment, {})),
               nullptr,
               Shared(MetricCurves::NoMetrics()),
               Shared(VehiclesJson({}))},
      foxglove_(
          AboutTheRun(experiment, ros_.channels(), source_.recorded ? source_.recorded->last_tick : experiment.ticks()),
          *this),
      request_queue_(control),
      server_(OptionsOf(options), *this, std::move(log)) {
  server_.Start();
}

std::vector<std::string> LiveView::addresses() const {
  std::vector<std::string> addresses;
  for (const std::string_view any : {"http://0.0.0.0:", "http://[::]:"})
    if (url().starts_with(any))
      for (const std::string& address : AddressesForOthers())
        addresses.push_back("http://" + address + ":" + url().substr(any.size()));
  return addresses.empty() ? std::vector{url()} : addresses;
}

void LiveView::Adopt(const LiveExperiment& live, std::span<const Event> /*events*/) { left_out_.Adopt(live.now()); }

void LiveView::Add(const FlownRow& row) {
  left_out_.Add(row.tick(), row.decoded().motions);
  const std::lock_guard lock(mutex_);
  newest_.tick = row.tick();
  newest_.decoded = row.decoded();
  newest_.disagreement_m = meter_->disagreement_m();
  newest_.curve = meter_->curve();
  curves_.Add(row.tick(), newest_.disagreement_m, newest_.curve, newest_.decoded.motions);
  if (experiment_.graph.edges() <= kMaxEdgesShown) {
    meter_->EdgesNow(newest_.edges);
    left_out_.Mark(newest_.edges);
  }
  row_is_new_ = is_new_ = true;
}

void LiveView::Take(const ShownRow& row) {
  const std::lock_guard lock(mutex_);
  newest_ = row;
  row_is_new_ = is_new_ = true;
}

void LiveView::SetState(const RunState& state) {
  const std::lock_guard lock(mutex_);
  state_ = state;
  is_new_ = true;
}

void LiveView::OnEvent(const ShownEvent& event, const Experiment& now, const std::vector<ShownKey>& keys) {
  if (event.by_hand.value_or(false) && !silenced_) SilenceTheory(event.tick);
  SetExperiment(now, keys);
  server_.Post([this, event] {
    events_.push_back(event);
    PublishEvents();
    const Foxglove::Payload message = Shared(ros_.Message(event));
    for (const ClientId client : foxglove_.clients())  // slow ones too: it is said once
      foxglove_.PublishTo(client, static_cast<Foxglove::ChannelId>(kFirstOfRos + ros_.event_channel()),
                          StampNs(event.tick, experiment_.control.rate_hz), message);
  });
}

void LiveView::SilenceTheory(std::int64_t tick) {
  silenced_.emplace().silent = SilentFrom(experiment_, tick);
  std::erase_if(responses_, [tick](const PartResponse& part) { return part.from >= tick; });
  if (!responses_.empty()) responses_.back().until = std::min(responses_.back().until, tick);
}

ShownTheory LiveView::TheoryOf(const Experiment& now) const {
  const std::vector<std::int64_t> begins = PhasesOf(experiment_);
  const auto begin_of = [&](std::size_t phase) { return phase == 0 ? 0 : begins.at(phase - 1); };
  const auto& later = prediction_.later;  // empty if theory does not look at the run at all
  std::size_t first = now.phase;
  while (first > 0 && first <= later.size() &&
         (first == 1 ? experiment_ : *later[first - 2].experiment).law.name == now.law.name)
    --first;
  return {silenced_ ? *silenced_ : PredictionOf(prediction_, now.phase), responses_, begin_of(now.phase),
          begin_of(first)};
}

void LiveView::SetEvents(std::vector<ShownEvent> events) {
  server_.Post([this, events = std::move(events)]() mutable {
    events_ = std::move(events);
    PublishEvents();
  });
}

void LiveView::SetCurves(const Curves& curves) {
  server_.Post(
      [this, json = CurvesJson(experiment_, curves)]() mutable { PublishLatched(kCurvesChannel, std::move(json)); });
}

void LiveView::SetMetrics(std::string json) {
  server_.Post([this, json = std::move(json)]() mutable { PublishLatched(kMetricsChannel, std::move(json)); });
}

void LiveView::OnVehicle(const VehicleNews& news) {
  server_.Post([this, news] {
    vehicles_[news.agent] = news;
    PublishLatched(kVehiclesChannel, VehiclesJson(vehicles_));
  });
}

void LiveView::PublishEvents() { PublishLatched(kEventsChannel, EventsJson(experiment_, events_)); }

void LiveView::PublishLatched(UiChannel channel, std::string json) {
  latched_[channel] = Shared(std::move(json));
  foxglove_.Publish(channel, shown_ns(), latched_[channel]);
  missed_[channel] = slow_;
}

void LiveView::SendMissed() {  // no newer message may come
  for (Foxglove::ChannelId channel = 0; channel < kFirstOfRos; ++channel)
    std::erase_if(missed_[channel], [&](ClientId client) {
      if (slow_.contains(client)) return false;
      foxglove_.PublishTo(client, channel, shown_ns(), latched_[channel]);
      return true;
    });
}

void LiveView::SetExperiment(const Experiment& now, const std::vector<ShownKey>& keys) {
  server_.Post([this, json = ExperimentJson(now, TheoryOf(now), source_, keys), keys]() mutable {
    PublishLatched(kExperimentChannel, std::move(json));
    std::vector<Foxglove::Parameter> parameters;
    for (const ShownKey& key : keys) parameters.push_back({key.name, JsonOrNull<Foxglove::Json>(key.value)});
    foxglove_.SetParameters(std::move(parameters));
  });
}

void LiveView::OnOpen(ClientId client, const std::string& subprotocol, std::string_view target) {
  ++viewers_;
  if (foxglove_.clients().empty() && TakeNewest() && shown_.tick >= 0) Show();  // no viewer watched: shown_ is old
  foxglove_.OnOpen(client, {.has_playback = subprotocol == kSubprotocols[0], .may_steer = steering_.IsGranted(target)});
}

std::string LiveView::OnMessage(ClientId client, bool is_text, std::span<const std::uint8_t> message) {
  return foxglove_.OnMessage(client, is_text, message);
}

void LiveView::OnClose(ClientId client) {
  --viewers_;
  foxglove_.OnClose(client);
  slow_.erase(client);
  for (auto& missed : missed_) missed.erase(client);
}

std::uint64_t LiveView::shown_ns() const {
  return StampNs(std::max<std::int64_t>(shown_.tick, 0), experiment_.control.rate_hz);
}

void LiveView::OnSubscribe(ClientId client, Foxglove::ChannelId channel) {
  if (channel == kCurvesChannel && meter_ != nullptr) {
    const std::lock_guard lock(mutex_);
    latched_[channel] = Shared(CurvesJson(experiment_, curves_));  // a viewer adds the rows that follow
  }
  if (channel < kFirstOfRos && latched_[channel] != nullptr)
    foxglove_.PublishTo(client, channel, shown_ns(), latched_[channel]);
  else if (channel >= kFirstOfRos && shown_.tick >= 0 && channel != kFirstOfRos + ros_.event_channel())
    foxglove_.PublishTo(client, channel, shown_ns(), Shared(ros_.FirstMessage(channel - kFirstOfRos)));
}

bool LiveView::TakeNewest() {
  const std::lock_guard lock(mutex_);
  if (!std::exchange(is_new_, false)) return false;
  if (std::exchange(row_is_new_, false)) std::swap(newest_, shown_);
  const double real_time_factor = shown_state_.real_time_factor;
  shown_state_ = state_;
  shown_state_.real_time_factor = real_time_factor;
  return true;
}

void LiveView::MeasurePace() {
  if (source_.recorded) {  // plays at its speed, and may jump
    shown_state_.real_time_factor = shown_state_.phase == RunState::Phase::kRunning ? shown_state_.pace : 0;
    return;
  }
  const auto now = WallClock::now();
  if (measured_at_ && now - *measured_at_ < kPaceWindow) return;
  if (measured_at_) {
    const double wall_s = std::chrono::duration<double>(now - *measured_at_).count();
    shown_state_.real_time_factor = experiment_.time_s(shown_.tick - measured_tick_) / wall_s;
  }
  measured_at_ = now;
  measured_tick_ = shown_.tick;
}

Foxglove::Playback LiveView::PlaybackNow() const {
  using Playing = Foxglove::Playing;
  const bool plays = shown_state_.phase == RunState::Phase::kRunning;
  const bool stands = shown_state_.phase == RunState::Phase::kPaused;
  return {.status = plays    ? Playing::kPlaying
                    : stands ? Playing::kPaused
                             : Playing::kEnded,
          .time_ns = shown_ns(),
          .speed = shown_state_.pace > 0 ? static_cast<float>(shown_state_.pace) : 1};
}

void LiveView::Show() {
  foxglove_.SendTime(shown_ns());
  PublishLatched(kFrameChannel, FrameJson(experiment_, shown_, shown_state_));
  ros_.SetRow(shown_);
  for (std::size_t i = 0; i < ros_channels_; ++i) {
    const auto channel = static_cast<Foxglove::ChannelId>(kFirstOfRos + i);
    if (!foxglove_.HasSubscriber(channel)) continue;
    if (std::string message = ros_.Message(i); !message.empty())
      foxglove_.Publish(channel, shown_ns(), Shared(std::move(message)));
  }
  foxglove_.SetPlayback(PlaybackNow());
}

void LiveView::OnTimer() {
  if (foxglove_.clients().empty()) return;
  slow_.clear();
  for (const ClientId client : foxglove_.clients())
    if (server_.Waiting(client) > 0) slow_.insert(client);
  if (TakeNewest() && shown_.tick >= 0) {
    MeasurePace();
    Show();
  }
  SendMissed();
}

void LiveView::Ask(const Request& request, Foxglove::Reply reply) {
  request_queue_.Ask(request, [this, reply = std::move(reply)](const Answer& answer) {
    server_.Post([reply, answer] { reply(answer); });
  });
}

void LiveView::AskForGoal(const Goal& goal, Foxglove::Reply reply) {
  const auto named = AgentsOf(goal.frame_id);
  const int agent = named ? named->first : experiment_.law.leader;
  const auto refuse = [&](std::string why) { server_.Post([reply, why = std::move(why)] { reply({false, why}); }); };
  if (agent == 0) return refuse("expected an agent's name as frame_id, such as agent_1, because there is no leader");
  if (agent > experiment_.size() || (named && named->size() > 1))
    return refuse(
        fmt::format("expected agent_1 to {} as frame_id, got {}", AgentName(experiment_.size()), goal.frame_id));
  // A click on the ground has height 0, and means the place, not the height.
  const auto i = static_cast<std::size_t>(agent - 1);
  const double z = goal.z != 0 || shown_.tick < 0 ? goal.z : shown_.decoded.motions[i].p_WB.z();
  const std::string position = fmt::format("[{:.6f}, {:.6f}, {:.6f}]", goal.x, goal.y, z);
  Ask({.kind = Request::Kind::kEvent, .toml = fmt::format("goto = {{ agent = {}, position_m = {} }}", agent, position)},
      std::move(reply));
}

}  // namespace mascot

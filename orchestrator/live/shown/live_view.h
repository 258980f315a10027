#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "experiment/experiment.h"
#include "orchestrator/control/request_queue.h"
#include "orchestrator/live/server/foxglove.h"
#include "orchestrator/live/server/pages.h"
#include "orchestrator/live/server/socket.h"
#include "orchestrator/live/server/steering.h"
#include "orchestrator/live/shown/about.h"
#include "orchestrator/live/shown/ros_channels.h"
#include "orchestrator/live/shown/ui_channels.h"
#include "orchestrator/measuring/left_out_meter.h"
#include "orchestrator/measuring/run_meter.h"
#include "orchestrator/team/row_sink.h"
#include "orchestrator/theory/theory.h"

namespace mascot {

/// A page to watch and steer a run, or to watch a recording, and the Foxglove WebSocket protocol, on one port. The
/// run's thread only copies each row; everything else happens in the server's thread. A slow viewer loses frames.
class LiveView final : public RowSink, private SocketUser, private Foxglove::Host {
 public:
  struct Options {
    std::string address = "127.0.0.1";
    std::uint16_t port = 8765;
    /// Origins of further pages that may watch and steer (live/server/origin.h).
    std::vector<std::string> allowed_origins = {};
    std::filesystem::path page;          ///< folder of index.html
    std::filesystem::path results = {};  ///< of a recording: the folder of its pictures and summary; empty: none
    ShownSource source = {};
    double pace = 0;  ///< simulated seconds per second that the run shall fly; 0: as fast as the machine can
    std::chrono::milliseconds goodbye{1000};  ///< SocketLimits::goodbye
    /// Who may steer; others only watch.
    Steering steering = Steering(Steering::By::kAll);
  };

  /// Listens from now on; all arguments but `options` must outlive this object. `meter` must get each row before this
  /// object does. `log` takes a line about a viewer that was dropped or refused, from any thread. Throws
  /// std::runtime_error if no port can be had.
  LiveView(const Experiment& experiment, const Prediction& prediction, const RunMeter& meter, RunControl& control,
           const Options& options, std::function<void(const std::string&)> log);
  /// As above, but for a recording, whose rows come by Take(), not by Add().
  LiveView(const Experiment& experiment, const Prediction& prediction, RunControl& control, const Options& options,
           std::function<void(const std::string&)> log);

  ~LiveView() override { request_queue_.Close(); }

  /// Address of the page.
  std::string url() const { return server_.url(); }
  std::uint16_t port() const { return server_.port(); }
  /// The addresses at which the page is reached: url(), or, if it listens at every address of this machine, those that
  /// others may type.
  std::vector<std::string> addresses() const;
  /// What to append to an address so that who opens it may steer; empty: nothing, all may.
  std::string steering_suffix() const { return steering_.token().empty() ? "" : "/#steer=" + steering_.token(); }
  /// From the run's thread.
  void Adopt(const LiveExperiment& live, std::span<const Event> events) override;
  const Steering& steering() const { return steering_; }
  /// Takes the next row, from the run's thread.
  void Add(const FlownRow& row) override;
  /// From the run's thread.
  void OnVehicle(const VehicleNews& news) override;

  // From any thread.
  /// Ends the view, because of an error in our own code, and says so in the log.
  void Fail(const std::string& why) { server_.Fail(why); }
  /// Whether an error in our own code has ended the view.
  bool has_failed() const { return server_.has_failed(); }
  /// Whether somebody watches.
  bool is_watched() const { return viewers_ > 0; }
  /// Shows this row from now on, whether it is later or earlier than the one before.
  void Take(const ShownRow& row);
  /// Says how the run goes. real_time_factor is not used: it is measured here.
  void SetState(const RunState& state);
  /// Sets the experiment to `now`.
  void SetExperiment(const Experiment& now, const std::vector<ShownKey>& keys);
  /// An event has taken effect: `now` is the experiment with it, `keys` are all that may be changed.
  /// From the first event by hand on, theory is silent, and its responses end.
  void OnEvent(const ShownEvent& event, const Experiment& now, const std::vector<ShownKey>& keys);
  /// Sets the curves of a recording: as far as they are known, if it is not read to its end yet.
  void SetCurves(const Curves& curves);
  /// Sets the curves of the user's own metrics, as MetricCurves (metric_curves.h) publishes them.
  void SetMetrics(std::string json);
  /// Sets the list of all events.
  void SetEvents(std::vector<ShownEvent> events);

 private:
  using WallClock = std::chrono::steady_clock;

  LiveView(const Experiment& experiment, const Prediction& prediction, const RunMeter* meter, RunControl& control,
           const Options& options, std::function<void(const std::string&)> log);

  // SocketUser, in the server's thread.
  HttpAnswer Get(std::string_view target) override { return pages_.Get(target); }
  void OnOpen(ClientId client, const std::string& subprotocol, std::string_view target) override;
  std::string OnMessage(ClientId client, bool is_text, std::span<const std::uint8_t> message) override;
  void OnClose(ClientId client) override;
  void OnTimer() override;

  // Foxglove::Host, in the server's thread.
  void Send(ClientId client, Frame frame) override { server_.Send(client, std::move(frame)); }
  bool IsSlow(ClientId client) const override { return slow_.contains(client); }
  void OnSubscribe(ClientId client, Foxglove::ChannelId channel) override;
  void Ask(const Request& request, Foxglove::Reply reply) override;
  void AskForGoal(const Goal& goal, Foxglove::Reply reply) override;

  void SilenceTheory(std::int64_t tick);
  ShownTheory TheoryOf(const Experiment& now) const;
  void PublishEvents();
  void PublishLatched(UiChannel channel, std::string json);
  void SendMissed();
  bool TakeNewest();
  void MeasurePace();
  Foxglove::Playback PlaybackNow() const;
  void Show();
  std::uint64_t shown_ns() const;

  const Experiment& experiment_;
  const Prediction& prediction_;
  std::optional<Prediction> silenced_;   // once an event by hand has changed the run; of the thread that calls OnEvent
  std::vector<PartResponse> responses_;  // of that thread, too
  const RunMeter* meter_;                // null: of a recording
  LeftOutMeter left_out_;                // of a run, and of its thread
  const ShownSource source_;
  const Pages pages_;
  const Steering steering_;

  std::atomic<int> viewers_ = 0;

  std::mutex mutex_;
  ShownRow newest_;          // guarded by mutex_
  bool row_is_new_ = false;  // guarded by mutex_: newest_ has changed
  bool is_new_ = false;      // guarded by mutex_: newest_ or state_ has changed
  Curves curves_;            // guarded by mutex_: of a run
  RunState state_;           // guarded by mutex_

  // The server's thread alone.
  ShownRow shown_;
  RunState shown_state_;
  RosChannels ros_;
  const std::size_t ros_channels_;
  std::set<ClientId> slow_;
  Foxglove::Payload latched_[kFirstOfRos];  // the newest message of each UiChannel
  std::set<ClientId> missed_[kFirstOfRos];  // clients that were too slow for this message
  std::vector<ShownEvent> events_;
  std::map<int, VehicleNews> vehicles_;  // the newest of each, by agent
  std::optional<WallClock::time_point> measured_at_;
  std::int64_t measured_tick_ = 0;

  Foxglove foxglove_;
  RequestQueue request_queue_;  // its thread uses server_, until it is closed
  SocketServer server_;         // its thread uses all of the above
};

}  // namespace mascot

#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "experiment/live_experiment.h"
#include "experiment/toml/section.h"
#include "orchestrator/control/run_control.h"
#include "orchestrator/team/row_sink.h"

namespace mascot {

/// What a run is doing.
struct RunStatus {
  bool paused = false;
  double pace = 0;            ///< simulated seconds a second that are asked for; 0: as fast as it goes
  std::int64_t tick = -1;     ///< newest one recorded; -1: none
  int domain = -1;            ///< DDS domain; -1: none
  std::string vehicles = {};  ///< where they are in their flights: "1 flying, 3 landing"; empty: there are none
};

/// Takes requests to a run from any thread and checks them. One after the other, they then wait until the run's own
/// thread has carried them out. As a sink, this object gets the run's rows, and so knows the experiment as events have
/// changed it.
class RunRequests final : public RunControl, public RowSink {
 public:
  using Time = std::chrono::steady_clock::time_point;

  /// How the run begins: with this pace (simulated seconds a second), and in a pause after tick 0 or not. `experiment`
  /// must outlive this object.
  RunRequests(const Experiment& experiment, double pace, bool paused = false);
  /// Throws std::invalid_argument for a pace outside of the range of run.pace.
  static void CheckPace(double pace);

  /// Returns when the request is carried out or refused. It is refused at once if it is not legal, after 5 s if the run
  /// has not begun by then, and when the run ends before the request is carried out.
  Answer Ask(const Request& request) override;
  /// From any thread.
  RunStatus status() const;
  void Adopt(const LiveExperiment& live, std::span<const Event> events) override;
  void Add(const FlownRow& row) override;
  /// `tell` is called, in the run's thread, when RunStatus::paused or RunStatus::pace has changed; null: no more calls.
  void CallWhenChanged(std::function<void(const RunStatus&)> tell);

  // For the run's thread.
  /// `wake` is called, from any thread, when a request has come; null: no thread needs to be woken.
  void CallWhenAsked(std::function<void()> wake);
  /// The run has begun: requests are taken from now on.
  void Open();
  /// A request that has been checked, for the run to carry out.
  struct Order {
    Request::Kind kind = Request::Kind::kPause;
    double number = 0;  ///< as in Request; kEvent: it must take effect before this tick
    std::optional<Event> event = {};
  };
  /// The next order, the same until Done(); nothing: there is none.
  std::optional<Order> Next() const;
  /// The order of Next() is carried out: `tick` is the first that it holds for; nullopt: the run is over.
  void Done(std::optional<std::int64_t> tick);
  /// The order of Next(), an event, cannot take effect before the tick Order::number: its request is checked again, for
  /// later ticks.
  void CheckAgain();
  /// The order of Next(), to vehicles, is passed on, as these words say.
  void Tell(std::string words);
  /// The order of Next() cannot be carried out, for these reasons.
  void Refuse(std::string words);
  void Refuse(const ConfigError& error);
  /// Vehicles take off as soon as all are there: nobody needs to ask for it.
  void LetVehiclesGo() { vehicles_go_ = true; }
  bool vehicles_go() const { return vehicles_go_; }
  /// How the ticks go on now.
  void SetStatus(bool paused, double pace);
  void SetDomain(int domain);
  /// RunStatus::vehicles.
  void SetVehicles(std::string words);
  /// The run is over: every Ask() that waits returns and says so, and no more requests are taken.
  void Close();
  /// Waits for a request, at most until `time`.
  void WaitUntil(Time time) const;

  /// Events that were given by hand and have taken effect, in order.
  std::vector<Event> by_hand() const;
  /// The numbers that these events have in the run, increasing: DecodedRow::RowEvent::number.
  std::vector<int> numbers_by_hand() const;

 private:
  /// What the request asks for. An event takes effect at tick `from` or later. Throws ConfigError or
  /// std::invalid_argument if it is not legal.
  Order Checked(const Request& request, std::int64_t from);
  /// Throws std::invalid_argument if the run cannot pause.
  void CheckPause(const std::string& what) const;
  /// Throws std::invalid_argument if a request to vehicles means none that there is.
  void CheckVehicle(const Request& request) const;
  /// Throws ConfigError if the event is not legal, or an event of the file after it. That holds for ticks before the
  /// file's next event: behind it there may be another law.
  Order CheckedEvent(const std::string& toml, std::int64_t from);
  void AnswerWith(Answer answer);
  Answer AnswerTo(const Order& order, std::optional<std::int64_t> tick) const;

  const Experiment& experiment_;
  bool vehicles_go_ = false;
  std::mutex asking_;  // held by Ask(): one request at a time; guards ahead_

  /// The run as it will be when all events that are granted have taken effect.
  struct Ahead {
    LiveExperiment live;
    std::size_t of_file = 0;  ///< how many of the file's events are in it
    std::size_t by_hand = 0;  ///< how many of those given by hand
  };
  /// Brings ahead_ up to date: each event is taken once, however many come after it. Returns the first tick at which
  /// another may take effect.
  std::int64_t LookAhead();
  /// Takes into `ahead` the file's events up to and at a tick.
  void TakeFile(Ahead& ahead, std::int64_t until) const;
  std::optional<Ahead> ahead_;  // never empty

  mutable std::mutex mutex_;  // guards what is below
  mutable std::condition_variable changed_;
  std::function<void()> wake_;
  std::function<void(const RunStatus&)> tell_;
  bool is_open_ = false, is_over_ = false;
  RunStatus status_;
  std::optional<Order> order_;
  std::optional<Answer> answer_;
  std::optional<LiveExperiment> live_;  // as of the newest row; never empty
  std::size_t of_file_ = 0;             // how many of the file's events are in live_
  std::deque<Event> granted_;           // by hand, not in live_ yet
  std::vector<Event> by_hand_;          // by hand, in live_
  std::vector<int> numbers_by_hand_;    // the numbers of these, increasing
};

}  // namespace mascot

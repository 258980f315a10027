#pragma once

#include <spdlog/logger.h>

#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "bus/bus.h"
#include "bus/wire.h"
#include "experiment/experiment.h"
#include "orchestrator/control/run_requests.h"
#include "orchestrator/engines/dds/fleet.h"
#include "orchestrator/engines/dds/process_table.h"
#include "system/log_file.h"

namespace mascot {

/// The orchestrator's readers and writers on /status, /request and /experiment (bus/lifecycle.h has those of all other
/// processes). Also sends the recorder's status. Logs what is received and sent.
class RunLinks {
 public:
  using Status = ProcessTable::Status;

  /// `peers` are the processes of the run, which are handed out with the experiment. `wake` is called, from any thread,
  /// when the loop should look without delay.
  RunLinks(Domain& domain, const Peers& peers, const Experiment& experiment, LogFile log, std::function<void()> wake);
  /// Logs which samples were not taken, and from which participants.
  ~RunLinks();

  /// Publishes the experiment if a process has asked for it, or if the places of the run's processes have changed. An
  /// agent that comes late gets what was published before, and so need not ask. Cheap to call often.
  void HandOutExperiment();
  /// Publishes the experiment, for processes that start at `from_tick`, with all events before that tick.
  void HandOutExperiment(std::int64_t from_tick, std::vector<mascot_msgs::msg::Event> events);
  /// Publishes that the recorder is ready, at most five times a second. Cheap to call often. `pace` is the pace at the
  /// start, in simulated seconds per second; 0: as fast as the machine can. `paused`: the run pauses after tick 0.
  void SayReady(double pace, bool paused);
  /// Publishes that rows 0 .. rows - 1 are recorded.
  void Confirm(std::int64_t rows);
  /// Publishes a request to all processes.
  void Ask(mascot::Ask ask, const std::string& reason);
  /// Publishes a request to processes of vehicles.
  void Ask(const Fleet::Order& order);
  /// Publishes a numbered request to the physics server: again at most five times a second. Cheap to call often.
  void Steer(const RunRequests::Order& order, std::uint32_t number);
  /// Tells the physics server that agents are lost: again at most five times a second. Cheap to call often.
  void Lose(AgentRange agents);
  /// Number of statuses that the physics server has sent.
  std::int64_t server_words() const;
  /// Number of processes that listen to requests.
  int listeners() const { return requests_.matched(); }

  /// The latest status of a process; nothing if there is none yet.
  std::optional<Status> StatusOf(const std::string& process) const;
  /// Whether every process has said that it has received the experiment of this run.
  bool HaveTheExperiment() const;
  /// What the start still waits for, as text for an error message.
  std::string Missing() const;

 private:
  void PublishExperiment();
  void OnStatus(const Status& status, const std::string& from);
  /// Writes a line to the log.
  void Note(const std::string& words);

  const Peers& peers_;
  std::function<void()> wake_;
  spdlog::logger log_;
  mascot_msgs::msg::Experiment message_;
  std::uint64_t told_ = 0;                                 // version of peers_ at the last look
  std::uint32_t newest_request_ = 0;                       // number of the last request of Steer()
  ProcessTable::Time next_request_{};                      // when it may be sent again
  std::map<std::string, ProcessTable::Time> next_losses_;  // likewise, by process
  mutable std::mutex mutex_;                               // guards what follows
  ProcessTable process_table_;
  std::int64_t server_words_ = 0;

  Writer<ExperimentType> experiments_;
  Writer<RequestType> requests_;
  Writer<StatusType> recorder_;
  Reader<StatusType> status_;  // last: its callback uses the members above
};

}  // namespace mascot

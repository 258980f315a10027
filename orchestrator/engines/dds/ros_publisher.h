#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>
#include <thread>

#include "bus/bus.h"
#include "orchestrator/engines/ros_source.h"

namespace mascot {

/// Publishes /tf and /scene for RViz2 (network.ros_view): the newest tick, at most 50 and 10 times a second, and less
/// often if samples are large. A topic without readers gets no samples. The publisher has a thread and a participant of
/// its own, so that no reader, however slow, delays the run.
class RosPublisher {
 public:
  using Clock = std::chrono::steady_clock;

  /// Joins as `options` say, and begins. `discovery`, if given, is told of all discovered participants and endpoints.
  /// If `source` throws, the publishing ends, and not the run: `log` takes a line about it, in the publisher's thread.
  /// Both must outlive this object. Throws what Domain() throws.
  RosPublisher(const DomainOptions& options, RosSource& source, std::function<void(const std::string&)> log,
               eprosima::fastdds::dds::DomainParticipantListener* discovery);

 private:
  /// A topic, and the last sample of it. A sample for a new reader is sent again once the reader has answered: it may
  /// not have known this writer when the first one came.
  struct Shown {
    RawWriter writer;
    Clock::duration period;
    std::int64_t tick = -1;
    int readers = 0;
    int pending = 0;              // number of samples that a new reader still gets
    Clock::time_point next = {};  // time before which there is no other sample
  };
  void Run(const std::stop_token& over);
  /// Publishes the sample that `make` makes of this tick, if it is time, and if there is a reader that needs it.
  void Show(Shown& topic, std::int64_t tick, RosSource::Bytes (RosSource::*make)() const);

  RosSource& source_;
  const std::function<void(const std::string&)> log_;
  Domain domain_;
  Shown tf_, scene_;
  std::jthread thread_;  // last: it uses the others
};

}  // namespace mascot

#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bus/bus.h"
#include "orchestrator/engines/dds/own_domain.h"
#include "orchestrator/formats/mcap/reader.h"
#include "system/console.h"
#include "system/stop_signal.h"

namespace mascot {

/// Puts the samples of a recording back on DDS, for programs that listen: the topics that it holds, under their names,
/// in the wire's types and with the QoS of a run without bundles, at the recorded times.
class RowPlayer {
 public:
  struct Options {
    std::string file;
    int wanted_domain = -1;          ///< -1: any that is free
    std::string transport = "auto";  ///< one of TransportNames()
    double speed = 1;                ///< recorded seconds per second; 0: as fast as reliable listeners take samples
    std::vector<std::string> await = {};  ///< topics that must have a listener before the first sample
  };
  struct Result {
    std::string failure;        ///< why it has ended before the end of the recording; empty: it has not
    int signal = 0;             ///< that has ended it
    std::uint64_t samples = 0;  ///< that were published
    double recorded_s = 0;      ///< time of the last one
  };

  /// `contents` are those of the file, and stay. All arguments must outlive this object.
  RowPlayer(const McapContents& contents, const Options& options, Console& console, StopSignal& stop);
  ~RowPlayer() { End(); }
  RowPlayer(const RowPlayer&) = delete;
  RowPlayer& operator=(const RowPlayer&) = delete;

  /// Plays until the end of the recording, a failure or a signal.
  Result Play();
  /// Leaves the domain. Returns whether the DDS library let go (OwnDomain::Leave).
  bool End();

 private:
  using Clock = std::chrono::steady_clock;

  void Join();
  bool AwaitListeners();
  void PlaySamples();
  bool WaitUntil(Clock::time_point time);
  bool LetListenersCatchUp();

  const McapContents& contents_;
  const Options& options_;
  Console& console_;
  StopSignal& stop_;
  Result result_;
  std::optional<OwnDomain> own_domain_;
  std::optional<Domain> domain_;
  std::map<std::uint16_t, RawWriter> writers_;  // by channel
  bool said_slow_ = false;
  bool ended_ = false, let_go_ = true;
};

}  // namespace mascot

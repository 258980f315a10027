#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>

#include "bus/bus.h"
#include "bus/wire.h"
#include "experiment/experiment.h"

namespace mascot {

/// Hears what one agent commands, on the topic on which its process says it.
class CommandReader {
 public:
  /// The agent's acceleration after limits (m/s^2, in W) at a tick.
  using OnCommand = std::function<void(std::int64_t tick, const Eigen::Vector3d& a_W)>;

  /// `on_command` is called in a thread of Fast DDS.
  CommandReader(Domain& domain, const Experiment& experiment, int agent, OnCommand on_command);

  bool Matched() const;

 private:
  void TakeFrom(const RawReader::Bytes& answers);
  void Take(std::uint32_t agent, std::uint64_t tick, const Eigen::Vector3d& a_W);

  const int agent_;
  const std::int64_t last_tick_;
  const OnCommand on_command_;
  std::optional<RawReader> answers_;             // of the agent's process
  std::optional<Reader<CommandType>> commands_;  // of the agent
};

}  // namespace mascot

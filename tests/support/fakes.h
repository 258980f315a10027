#pragma once

// Vehicles that are not there, for runs over DDS.

#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "orchestrator/engines/dds/machine/domain_lock.h"
#include "tests/support/folders.h"
#include "tests/support/orchestrator.h"

namespace mascot::test {

/// A DDS domain with vehicles, each a program of its own (tests/fakes).
class Airfield {
 public:
  explicit Airfield(const ScratchFolder& folder) : folder_(folder) {}

  int domain() const { return lock_.domain(); }
  /// Switches a PX4 on, for this agent. `place`: "east,north,up" (m).
  Running& AddPx4(int agent, const std::string& place, const std::vector<std::string>& more = {}) {
    return Add(
        agent, "px4",
        {"--namespace", "px4_" + std::to_string(agent), "--system-id", std::to_string(agent + 1), "--place", place},
        more);
  }
  Running& AddArdupilot(int agent, const std::string& place, const std::vector<std::string>& more = {}) {
    return Add(agent, "ardupilot", {"--place", place}, more);
  }
  /// A Crazyswarm2 server with the Crazyflie of this agent.
  Running& AddCrazyflie(int agent, const std::string& place, const std::vector<std::string>& more = {}) {
    return Add(agent, "crazyswarm", {"--crazyflie", "cf" + std::to_string(agent) + ":" + place}, more);
  }
  Running& at(int agent) { return *vehicles_.at(agent); }

 private:
  /// Starts a fake. An option that is given twice has its last value.
  Running& Add(int agent, const std::string& kind, std::vector<std::string> words,
               const std::vector<std::string>& more) {
    words.insert(words.end(), {"--domain", std::to_string(domain())});
    words.insert(words.end(), more.begin(), more.end());
    auto& vehicle = vehicles_[agent];
    vehicle = std::make_unique<Running>(BuildFolder() + "/fake_" + kind, words,
                                        folder_.File(kind + "_" + std::to_string(agent)));
    return *vehicle;
  }

  const ScratchFolder& folder_;
  const DomainLock lock_{-1};
  std::map<int, std::unique_ptr<Running>> vehicles_;
};

}  // namespace mascot::test

#pragma once

// Participants that do not belong to a run (strangers), for tests of what they can do to it.

#include <string>

#include "bus/bus.h"
#include "tests/support/orchestrator.h"

namespace mascot::test {

/// The DDS domain of a run, as `up` prints it.
inline int DomainOf(const Running& up) { return std::stoi(RestOfLine(up, "domain ")); }

/// How a participant of this name joins the domain of `up`.
inline DomainOptions Intruder(const Running& up, const std::string& name) {
  DomainOptions options;
  options.domain = DomainOf(up);
  options.name = name;
  options.loopback = true;
  return options;
}

/// Writes this sample on `topic` again and again, as a participant of this name, until the run is over. Returns the
/// exit code of `up`.
template <class PubSub>
int Harass(Running& up, const std::string& name, const Topic& topic, typename PubSub::type sample) {
  Domain domain(Intruder(up, name), [] {});
  Writer<PubSub> writer(domain, topic);
  EXPECT_TRUE(Until([&] {
    writer.Write(sample);
    return up.IsOver();
  }));
  return up.Wait();
}

}  // namespace mascot::test

// thief CREDENTIALS DOMAIN TOPIC...: joins a run as the process whose credentials it has got, and reads topics, until
// it is told to end (SIGTERM). It says who has been found, which readers it may not make, and which topics it hears.
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <vector>

#include "bus/bus.h"
#include "system/stop_signal.h"

int main(int argc, char** argv) try {
  using namespace mascot;
  if (argc < 4) return 2;
  StopSignal stop;  // before the threads of DDS: they inherit which signals are blocked
  DomainOptions options;
  options.domain = std::atoi(argv[2]);
  options.name = "thief";
  options.loopback = true;
  options.credentials = std::make_shared<const Credentials>(ReadCredentials(argv[1]));
  Domain domain(options, [] {});
  std::vector<std::unique_ptr<RawReader>> readers;
  for (int k = 3; k < argc; ++k) {
    const auto topic = Topic::Parse(argv[k]);
    if (!topic) return 2;
    try {
      readers.push_back(std::make_unique<RawReader>(
          domain, *topic,
          [name = topic->Name(), said = std::make_shared<std::atomic<bool>>(false)](const auto&, const Sender&) {
            if (!said->exchange(true)) std::cerr << "hears " + name + "\n";
          },
          Redelivery::kOnDemand));
      std::cerr << "reads " + topic->Name() + "\n";
    } catch (const BusError& refusal) {
      std::cerr << std::string("refused: ") + refusal.what() + "\n";
    }
  }
  for (bool found = false; stop.Within(std::chrono::milliseconds(10)) == 0;) {
    if (found || domain.discovered() < 2) continue;
    std::cerr << "found\n";
    found = true;
  }
} catch (const std::exception& failure) {
  std::cerr << "error: " << failure.what() << std::endl;
  return 1;
}

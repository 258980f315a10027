#pragma once

#include <CLI/CLI.hpp>
#include <limits>
#include <string>

#include "tests/fakes/quadrotor.h"

namespace mascot::fakes {

inline constexpr double kNever_s = std::numeric_limits<double>::infinity();

/// What vehicles of every kind can do wrong, on purpose. Times are those of flight: Quadrotor::flown_s().
struct Faults {
  bool refuses_arming = false;
  double silent_from_s = kNever_s, silent_to_s = kNever_s;  ///< without radio

  bool IsSilent(const Quadrotor& body) const { return body.flown_s() >= silent_from_s && body.flown_s() < silent_to_s; }
};

struct OnDds {
  int domain = 0;
  bool any_interface = false;
};

/// The command line of a fake, with the options that all have.
class FakeApp : public CLI::App {
 public:
  FakeApp(const std::string& description, const std::string& name, OnDds& on_dds, Faults& faults)
      : CLI::App(description + " Times of what goes wrong are seconds since it first left the ground.", name) {
    option_defaults()->multi_option_policy(CLI::MultiOptionPolicy::TakeLast);
    add_option("--domain", on_dds.domain, "DDS domain")->check(CLI::Range(0, 232));
    add_flag("--any-interface", on_dds.any_interface, "Not 127.0.0.1 alone");
    add_flag("--refuses-arming", faults.refuses_arming, "As one whose checks before arming fail");
    AddTime("--silent-from-s", faults.silent_from_s, "No radio from then on");
    AddTime("--silent-to-s", faults.silent_to_s, "Its radio works again");
  }
  void AddTime(const std::string& name, double& time_s, const std::string& description) {
    add_option(name, time_s, description)->default_str("never")->check(CLI::NonNegativeNumber);
  }
};

}  // namespace mascot::fakes

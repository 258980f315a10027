// A script of a user of Crazyswarm2, as a simulation behind its topics and services sees it: all Crazyflies take off,
// fly on, follow what is streamed, and land. Says each step, and where the first Crazyflie is then. Exit code 1 if an
// answer or a place does not come in time.

#include <CLI/CLI.hpp>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "ros_messagesPubSubTypes.h"
#include "tests/fakes/bridge.h"

namespace mascot::fakes {
namespace {

using Clock = std::chrono::steady_clock;
using Place = std::array<double, 3>;
namespace cf = crazyflie_interfaces;

constexpr auto kPatience = std::chrono::seconds(20);
constexpr auto kTurn = std::chrono::milliseconds(10);
constexpr double kNear_m = 0.05;

void Until(const std::string& what, const std::function<bool()>& is_so, const std::function<void()>& meanwhile = {}) {
  for (const auto deadline = Clock::now() + kPatience; !is_so(); std::this_thread::sleep_until(Clock::now() + kTurn)) {
    if (Clock::now() > deadline) throw std::runtime_error("waited in vain for " + what);
    if (meanwhile) meanwhile();
  }
}

/// A service of ROS 2, as clients with rmw_fastrtps use it.
template <class Request, class RequestType, class Response, class ResponseType>
class Service {
 public:
  Service(Bridge& bridge, const std::string& name, const std::string& type)
      : name_(name),
        requests_(bridge.Out<RequestType>("rq/" + name + "Request", type + "_Request_", dds::RELIABLE_RELIABILITY_QOS)),
        replies_(bridge.In<ResponseType>("rr/" + name + "Reply", type + "_Response_", dds::RELIABLE_RELIABILITY_QOS)) {}

  Response Call(Request request) {
    Until("the service " + name_, [&] {
      dds::PublicationMatchedStatus out;
      dds::SubscriptionMatchedStatus in;
      requests_->get_publication_matched_status(out);
      replies_->get_subscription_matched_status(in);
      return out.current_count > 0 && in.current_count > 0;
    });
    eprosima::fastrtps::rtps::WriteParams parameters;
    requests_->write(&request, parameters);
    std::optional<Response> answer;
    Until("the answer of " + name_, [&] {
      TakeAll<Response>(replies_, [&](const Response& response, const dds::SampleInfo& info) {
        if (info.related_sample_identity == parameters.sample_identity()) answer = response;
      });
      return answer.has_value();
    });
    return *answer;
  }

 private:
  const std::string name_;
  dds::DataWriter* const requests_;
  dds::DataReader* const replies_;
};

builtin_interfaces::msg::Duration Seconds(int seconds) {
  builtin_interfaces::msg::Duration duration;
  duration.sec(seconds);
  return duration;
}

class Script {
 public:
  Script(int domain, std::string name, bool talks_nonsense)
      : name_(std::move(name)),
        talks_nonsense_(talks_nonsense),
        bridge_({.domain = domain}, "script"),
        poses_(bridge_.In<geometry_msgs::msg::PoseStampedPubSubType>("rt/" + name_ + "/pose",
                                                                     "geometry_msgs::msg::dds_::PoseStamped_")),
        full_state_(bridge_.Out<cf::msg::FullStatePubSubType>("rt/" + name_ + "/cmd_full_state",
                                                              "crazyflie_interfaces::msg::dds_::FullState_",
                                                              dds::RELIABLE_RELIABILITY_QOS)) {}

  void Run() {
    Place start = InitialPlace();
    Say("begins", start);
    TakeOff();
    Reach("the height", {start[0], start[1], kHeight_m});
    GoTo();
    Reach("the goal", {start[0] + kAhead_m, start[1], kHeight_m});
    const Place aside{start[0] + kAhead_m, start[1] + kAhead_m, kHeight_m};
    Reach("what is streamed", aside, [&] { Stream(aside); });
    Land();
    Reach("the ground", {aside[0], aside[1], kLow_m});
    std::puts("done");
  }

 private:
  static constexpr double kHeight_m = 0.6, kAhead_m = 0.5, kLow_m = 0.1;

  Place InitialPlace() {
    Service<rcl_interfaces::srv::GetParameters_Request, rcl_interfaces::srv::GetParameters_RequestPubSubType,
            rcl_interfaces::srv::GetParameters_Response, rcl_interfaces::srv::GetParameters_ResponsePubSubType>
        parameters(bridge_, "crazyflie_server/get_parameters", "rcl_interfaces::srv::dds_::GetParameters");
    rcl_interfaces::srv::GetParameters_Request request;
    request.names({"robots." + name_ + ".initial_position"});
    const auto answer = parameters.Call(request);
    const std::vector<double>& place = answer.values().at(0).double_array_value();
    return {place.at(0), place.at(1), place.at(2)};
  }
  /// By `all/takeoff` or `all/land`, whose requests are alike.
  template <class Request, class RequestType, class Response, class ResponseType>
  void ToHeight(double height_m, const std::string& service, const std::string& type) {
    Service<Request, RequestType, Response, ResponseType> all(bridge_, service, type);
    Request request;
    request.height(static_cast<float>(height_m));
    request.duration(Seconds(2));
    all.Call(request);
  }
  void TakeOff() {
    ToHeight<cf::srv::Takeoff_Request, cf::srv::Takeoff_RequestPubSubType, cf::srv::Takeoff_Response,
             cf::srv::Takeoff_ResponsePubSubType>(kHeight_m, "all/takeoff", "crazyflie_interfaces::srv::dds_::Takeoff");
  }
  void GoTo() {
    Service<cf::srv::GoTo_Request, cf::srv::GoTo_RequestPubSubType, cf::srv::GoTo_Response,
            cf::srv::GoTo_ResponsePubSubType>
        go_to(bridge_, "all/go_to", "crazyflie_interfaces::srv::dds_::GoTo");
    cf::srv::GoTo_Request request;
    request.relative(true);
    request.goal().x(kAhead_m);
    request.duration(Seconds(2));
    go_to.Call(request);
  }
  void Stream(const Place& place) {
    cf::msg::FullState state;
    state.pose().position().x(place[0]);
    state.pose().position().y(place[1]);
    state.pose().position().z(place[2]);
    state.pose().orientation().w(1);
    full_state_->write(&state);
    if (!talks_nonsense_) return;
    state.pose().position().z(std::nan(""));
    full_state_->write(&state);
  }
  void Land() {
    Service<cf::srv::NotifySetpointsStop_Request, cf::srv::NotifySetpointsStop_RequestPubSubType,
            cf::srv::NotifySetpointsStop_Response, cf::srv::NotifySetpointsStop_ResponsePubSubType>
        stop(bridge_, name_ + "/notify_setpoints_stop", "crazyflie_interfaces::srv::dds_::NotifySetpointsStop");
    stop.Call({});
    ToHeight<cf::srv::Land_Request, cf::srv::Land_RequestPubSubType, cf::srv::Land_Response,
             cf::srv::Land_ResponsePubSubType>(kLow_m, "all/land", "crazyflie_interfaces::srv::dds_::Land");
  }
  void Reach(const std::string& what, const Place& place, const std::function<void()>& meanwhile = {}) {
    Place here{};
    Until(
        what,
        [&] {
          TakeAll<geometry_msgs::msg::PoseStamped>(poses_, [&](const auto& pose, const dds::SampleInfo&) {
            const auto& p = pose.pose().position();
            here = {p.x(), p.y(), p.z()};
          });
          return std::hypot(here[0] - place[0], here[1] - place[1], here[2] - place[2]) < kNear_m;
        },
        meanwhile);
    Say("reaches " + what, here);
  }
  void Say(const std::string& what, const Place& place) {
    std::printf("%s %s, at [%.2f, %.2f, %.2f]\n", name_.c_str(), what.c_str(), place[0], place[1], place[2]);
    std::fflush(stdout);
  }

  const std::string name_;
  const bool talks_nonsense_;
  Bridge bridge_;
  dds::DataReader* const poses_;
  dds::DataWriter* const full_state_;
};

}  // namespace
}  // namespace mascot::fakes

int main(int argc, char** argv) {
  CLI::App app("Flies Crazyflies as a script of a user of Crazyswarm2 does");
  int domain = 0;
  std::string name = "cf1";
  app.add_option("--domain", domain, "DDS domain")->required();
  app.add_option("--crazyflie", name, "the one that is looked at");
  bool talks_nonsense = false;
  app.add_flag("--nonsense", talks_nonsense, "streams set-points that are none, too");
  CLI11_PARSE(app, argc, argv);
  try {
    mascot::fakes::Script(domain, name, talks_nonsense).Run();
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
  }
}

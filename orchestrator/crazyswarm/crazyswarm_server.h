#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "bus/outside_domain.h"
#include "experiment/experiment.h"
#include "orchestrator/crazyswarm/commander.h"
#include "orchestrator/crazyswarm/requests.h"
#include "orchestrator/team/action_source.h"
#include "orchestrator/team/row_sink.h"

namespace mascot {

/// A Crazyswarm2 server whose Crazyflies are simulated agents (network.crazyswarm): agent i, if its law takes actions,
/// is cf<i>. It offers the topics and services by which scripts fly a swarm, and gives the agents accelerations: those
/// of an order or a streamed set-point, and what corrects position and velocity. While the motors of a Crazyflie stand,
/// so do its agent's rotors. What a script sends that cannot be read is told, once for each topic and service. Scripts
/// may call from any thread; the rest is called in one.
class CrazyswarmServer final : public ActionSource, public RowSink {
 public:
  /// `warn`: takes words for people, from any thread.
  CrazyswarmServer(const Experiment& experiment, std::function<void(const std::string&)> warn);
  ~CrazyswarmServer() override;

  void OnDomain(int domain, const std::string& address) override;
  std::span<const std::vector<double>> At(std::int64_t tick) override;
  void Add(const FlownRow& row) override;

 private:
  struct Crazyflie {
    int agent = 0;
    std::string name;
    crazyswarm::Commander commander;
    Motion motion = {};
    std::map<int, std::vector<crazyswarm::Trajectory::Piece>> trajectories = {};
  };
  using Bytes = OutsideDomain::Bytes;

  void Offer(const std::string& name, const std::vector<Crazyflie*>& whom);
  void OfferTopics(Crazyflie& crazyflie);
  void OfferParameters();
  Bytes Parameters(const Bytes& request) const;
  template <class Read, class Act>
  void Serve(const std::string& service, const std::string& type, const std::vector<Crazyflie*>& whom, const Read& read,
             const Act& act);
  template <class Read>
  void Hear(Crazyflie& crazyflie, const std::string& topic, const std::string& type, const Read& read);
  void TellOfUnread(const std::string& name);
  double now_s() const { return experiment_.time_s(tick_); }

  const Experiment& experiment_;
  const std::function<void(const std::string&)> warn_;
  mutable std::mutex mutex_;  // guards what is below but domain_
  std::vector<std::unique_ptr<Crazyflie>> crazyflies_;
  std::set<std::string> unread_;  // topics and services of which that was told
  std::int64_t tick_ = 0;
  std::vector<std::vector<double>> actions_;  // by id - 1
  std::optional<OutsideDomain> domain_;       // last, so destroyed first: its readers call the members above
};

}  // namespace mascot

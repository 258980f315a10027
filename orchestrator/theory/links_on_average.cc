#include "orchestrator/theory/links_on_average.h"

#include <algorithm>

#include "base/ticks.h"

namespace mascot {
namespace {

/// Whether `property` holds for the link of at least one edge that may ever exist.
template <class Property>
bool AnyLink(const Experiment& experiment, Property property) {
  for (int id = 1; id <= experiment.size(); ++id)
    for (const Graph::Neighbour& heard : experiment.graph.HeardBy(id))
      if (property(experiment.links.Of(id, heard.id))) return true;
  return false;
}

/// Whether the link puts an older sample in the place of a lost one.
bool Holds(const LinkConfig& link, int rate_hz) { return TicksRoundedDown(link.hold_s, rate_hz) > 0; }

}  // namespace

double Delivered(const LinkConfig& link) {
  if (!link.bursts) return 1 - link.loss;
  const GilbertElliott& bursts = *link.bursts;
  const double changes = bursts.good_to_bad + bursts.bad_to_good;
  const double bad = changes > 0 ? bursts.good_to_bad / changes : 0;  // without changes, it stays good
  return 1 - (1 - bad) * bursts.loss_good - bad * bursts.loss_bad;
}

Graph OnAverage(const Graph& graph, const LinkTable& links) {
  std::vector<std::vector<Graph::Neighbour>> heard(static_cast<std::size_t>(graph.size()));
  for (int id = 1; id <= graph.size(); ++id)
    for (const Graph::Neighbour& neighbour : graph.HeardBy(id)) {
      const double delivered = Delivered(links.Of(id, neighbour.id));
      if (delivered > 0)
        heard[static_cast<std::size_t>(id - 1)].push_back({neighbour.id, neighbour.weight * delivered});
    }
  return Graph(std::move(heard));
}

bool LosesSome(const Experiment& experiment) {
  return AnyLink(experiment, [](const LinkConfig& link) { return Delivered(link) > 0 && Delivered(link) < 1; });
}

double MinDeliveredUnheld(const Experiment& experiment) {
  double least = 1;
  AnyLink(experiment, [&](const LinkConfig& link) {
    if (!Holds(link, experiment.control.rate_hz) && Delivered(link) > 0) least = std::min(least, Delivered(link));
    return false;
  });
  return least;
}

std::int64_t DelayTicks(const Experiment& experiment, int hearer, int heard) {
  return TicksRoundedUp(experiment.links.Of(hearer, heard).delay_s, experiment.control.rate_hz);
}

std::int64_t OwnDelayTicks(const Experiment& experiment) {
  return TicksRoundedUp(experiment.sensors.own_delay_s, experiment.control.rate_hz);
}

std::int64_t LongestDelayTicks(const Experiment& experiment) {
  std::int64_t longest = OwnDelayTicks(experiment);
  for (int id = 1; id <= experiment.size(); ++id)
    for (const Graph::Neighbour& heard : experiment.graph.HeardBy(id))
      if (Delivered(experiment.links.Of(id, heard.id)) > 0)
        longest = std::max(longest, DelayTicks(experiment, id, heard.id));
  return longest;
}

std::optional<std::int64_t> CommonDelayTicks(const Experiment& experiment, const Graph& graph) {
  std::optional<std::int64_t> common;
  for (int id = 1; id <= graph.size(); ++id)
    for (const Graph::Neighbour& heard : graph.HeardBy(id)) {
      const std::int64_t ticks = DelayTicks(experiment, id, heard.id);
      if (common && *common != ticks) return std::nullopt;
      common = ticks;
    }
  return common.value_or(0);
}

double LongestDelay(const Experiment& experiment) {
  double longest_s = 0;
  AnyLink(experiment, [&](const LinkConfig& link) {
    if (Delivered(link) > 0) longest_s = std::max(longest_s, link.delay_s + link.jitter_s);
    return false;
  });
  return longest_s;
}

std::string RandomAge(const Experiment& experiment) {
  if (AnyLink(experiment, [](const LinkConfig& link) { return link.jitter_s > 0; }))
    return "link.jitter_s: delays are random";
  if (AnyLink(experiment, [](const LinkConfig& link) { return link.delay_s > 0 && link.reordering > 0; }))
    return "link.reordering: delays are random";
  const int rate_hz = experiment.control.rate_hz;
  if (AnyLink(experiment, [&](const LinkConfig& link) { return Holds(link, rate_hz) && Delivered(link) < 1; }))
    return "link.hold_s: what is heard in place of a lost sample is of a random age";
  return "";
}

}  // namespace mascot

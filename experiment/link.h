#pragma once

#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "experiment/graph/edge.h"
#include "experiment/graph/graph.h"
#include "experiment/toml/section.h"

namespace mascot {

inline constexpr double kLongestDelay_s = 60;

/// Loss in bursts: the link changes between a good and a bad state from tick to tick. Gilbert (Bell Syst. Tech. J. 39,
/// 1960), Elliott (42, 1963).
struct GilbertElliott {
  double good_to_bad = 0;  ///< probability per tick
  double bad_to_good = 1;
  double loss_good = 0;  ///< probability that a sample is lost in the good state
  double loss_bad = 1;   ///< probability that a sample is lost in the bad state
};

/// Loss and delay of samples on the way from one agent to another, in simulated time.
struct LinkConfig {
  double loss = 0;  ///< probability, independent from sample to sample; not used with `bursts`
  std::optional<GilbertElliott> bursts;
  double delay_s = 0;
  double jitter_s = 0;     ///< the delay of each sample lies within delay_s -+ jitter_s, uniformly
  double reordering = 0;   ///< probability that a sample skips the delay and so overtakes others
  bool symmetric = false;  ///< i -> j and j -> i lose and delay the same samples
  double hold_s = 0;       ///< how long the last sample is used, beyond its delay, while no newer one arrives

  bool IsPerfect() const { return loss == 0 && !bursts && delay_s == 0 && jitter_s == 0; }
};

/// [link]: the configuration of all links, and the overrides for single edges. Copies share the latter.
class LinkTable {
 public:
  using Special = std::map<Edge, LinkConfig>;
  LinkTable() : LinkTable({}, {}) {}
  LinkTable(LinkConfig common, Special special)
      : common_(common), special_(std::make_shared<const Special>(std::move(special))) {}

  /// The link on which agent `hearer` hears agent `heard`.
  const LinkConfig& Of(int hearer, int heard) const {
    const auto special = special_->find({hearer, heard});
    return special == special_->end() ? common_ : special->second;
  }
  /// True if every link of `graph` delivers every sample at once.
  bool ArePerfect(const Graph& graph) const;

 private:
  LinkConfig common_;
  std::shared_ptr<const Special> special_;  // never null
};

/// The keys of [link].
std::span<const Key> LinkKeys();
/// Reads [link] for the edges of `graph`, which has no agents if they are unknown because of a mistake elsewhere.
/// Mistakes are noted in `link`.
LinkTable ReadLinks(Section& link, const Graph& graph);

}  // namespace mascot

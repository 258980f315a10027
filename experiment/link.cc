#include "experiment/link.h"

#include <algorithm>
#include <array>

#include "experiment/toml/few_tables.h"

namespace mascot {
namespace {

constexpr std::size_t kMaxOverrides = 10000;

constexpr Key kBurstKeys[] = {
    key::Number("good_to_bad", {0, 1}, "probability per tick that a good link turns bad").Required().Live(),
    key::Number("bad_to_good", {0, 1}, "probability per tick that a bad link turns good").Required().Live(),
    key::Number("loss_good", {0, 1}, "probability of a loss while the link is good").Default("0.0").Live(),
    key::Number("loss_bad", {0, 1}, "probability of a loss while the link is bad").Default("1.0").Live(),
};

constexpr std::array kCommonKeys = {
    key::Number("loss", {0, 1}, "probability that a sample is lost, independent of all others").Default("0.0").Live(),
    key::Table("gilbert_elliott", kBurstKeys, "loss in bursts, instead of `loss` (Gilbert 1960, Elliott 1963)"),
    key::Number("delay_s", {0, kLongestDelay_s},
                "delay of samples, rounded up to whole ticks; `orchestrator check` prints the delay in effect")
        .Default("0.0")
        .Live(),
    key::Number("jitter_s", {0, kLongestDelay_s},
                "the delay of each sample is uniformly distributed within `delay_s` plus or minus this, and then "
                "rounded up; at most `delay_s`")
        .Default("0.0")
        .Live(),
    key::Number("reordering", {0, 1}, "probability that a sample skips the delay, and so overtakes others")
        .Default("0.0")
        .Live(),
    key::Boolean("symmetric", "i -> j and j -> i lose and delay the same samples").Default("false"),
    key::Number(
        "hold_s", {0, 1e6},
        "how long the last sample is used, beyond its delay, while no newer one arrives; rounded down to whole ticks")
        .Default("0.0")
        .Live(),
};

constexpr auto kOverrideKeys = Joined(
    std::array{
        key::Rows("edges", {1, 10000}, "`[i, j]`, ...: the edges that this table is about (i hears j)").Required()},
    kCommonKeys);

constexpr auto kLinkKeys =
    Joined(kCommonKeys, std::array{key::Tables("override", kOverrideKeys,
                                               "other links for some edges; keys that are left out are as in `[link]`, "
                                               "but `loss` and `gilbert_elliott` replace each other; at most 10000")});

GilbertElliott ReadBursts(Section section) {
  GilbertElliott bursts;
  bursts.good_to_bad = section.Number("good_to_bad");
  bursts.bad_to_good = section.Number("bad_to_good");
  bursts.loss_good = section.Number("loss_good");
  bursts.loss_bad = section.Number("loss_bad");
  section.Done();
  return bursts;
}

LinkConfig ReadLink(Section& section) {
  LinkConfig link;
  section.TakeOneOf({"loss", "gilbert_elliott"});
  link.loss = section.Number("loss");
  if (section.Has("gilbert_elliott")) {
    if (link.loss > 0) section.Fail("gilbert_elliott", "expected only one of loss, gilbert_elliott, got both");
    link.bursts = ReadBursts(section.Child("gilbert_elliott"));
  }
  link.delay_s = section.Number("delay_s");
  link.jitter_s = section.Number("jitter_s");
  if (!section.Wrong("delay_s") && !section.Wrong("jitter_s") && link.jitter_s > link.delay_s)
    section.Fail("jitter_s",
                 "expected at most delay_s (" + ShortestFloat(link.delay_s) + "), got " + ShortestFloat(link.jitter_s));
  link.reordering = section.Number("reordering");
  link.symmetric = section.Boolean("symmetric");
  link.hold_s = section.Number("hold_s");
  return link;
}

std::string ListOf(const std::vector<double>& numbers) {
  std::string text;
  for (const double number : numbers) {
    const std::string written = ShortestFloat(number);
    text += (text.empty() ? "" : ", ") + (written.ends_with(".0") ? written.substr(0, written.size() - 2) : written);
  }
  return "[" + text + "]";
}

/// The edges [i, j] (i hears j) that an override is for.
std::vector<std::pair<int, int>> ReadEdges(Section& section, const Graph& graph) {
  std::vector<std::pair<int, int>> edges;
  const auto rows = section.Rows("edges");
  if (rows.empty() && !section.Wrong("edges"))
    section.Fail("edges", "expected a list of [i, j] (i hears j), got nothing");
  for (std::size_t k = 0; k < rows.size() && !section.Wrong("edges") && graph.size() > 0; ++k) {
    const auto is_agent = [&](double id) { return id == static_cast<int>(id) && id <= graph.size(); };
    const bool is_edge = rows[k].size() == 2 && is_agent(rows[k][0]) && is_agent(rows[k][1]) &&
                         graph.Hears(static_cast<int>(rows[k][0]), static_cast<int>(rows[k][1]));
    if (is_edge)
      edges.emplace_back(static_cast<int>(rows[k][0]), static_cast<int>(rows[k][1]));
    else
      section.FailRow("edges", k, "expected an edge [i, j] of the graph (i hears j), got " + ListOf(rows[k]));
  }
  return edges;
}

}  // namespace

std::span<const Key> LinkKeys() { return kLinkKeys; }

bool LinkTable::ArePerfect(const Graph& graph) const {
  for (int id = 1; id <= graph.size(); ++id)
    for (const Graph::Neighbour& heard : graph.HeardBy(id))
      if (!Of(id, heard.id).IsPerfect()) return false;
  return true;
}

LinkTable ReadLinks(Section& link, const Graph& graph) {
  const LinkConfig common = ReadLink(link);
  LinkTable::Special special;
  for (Section& section : FewTables(link, "override", kMaxOverrides)) {
    section.InheritFrom(link);
    const auto edges = ReadEdges(section, graph);
    const LinkConfig config = ReadLink(section);
    section.Done();
    for (const auto& edge : edges)
      if (!special.emplace(edge, config).second)
        section.Fail("edges", EachOnce("edge", EdgeText(edge), "in one override"));
  }
  link.Done();
  return LinkTable(common, std::move(special));
}

}  // namespace mascot

#include "physics_server/bullet/contact_counter.h"

#include <algorithm>

namespace mascot {
namespace {

// The tolerance: the solver stops a body driven by velocity slightly before it touches; how far before depends on the
// curvature of its path.
bool Touches(const btPersistentManifold& manifold) {
  constexpr double kTouching_m = 1e-4;
  for (int i = 0; i < manifold.getNumContacts(); ++i)
    if (manifold.getContactPoint(i).getDistance() <= kTouching_m) return true;
  return false;
}

}  // namespace

ContactCounter::ContactCounter(std::size_t bodies) {
  for (std::vector<Pair>* pairs : {&kept_, &lasting_, &now_}) pairs->reserve(4 * bodies);
  begun_.first.reserve(kMaxContactsTold + 4 * bodies);
}

void ContactCounter::Update(btDispatcher& dispatcher, std::int64_t tick, std::span<const Body> bodies) {
  kept_.clear();
  now_.clear();
  const std::size_t told = begun_.first.size();
  const bool tells = told < kMaxContactsTold;
  for (int i = 0; i < dispatcher.getNumManifolds(); ++i) {
    const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(i);
    if (manifold.getNumContacts() == 0) continue;
    const Pair pair = std::minmax(manifold.getBody0()->getUserIndex(), manifold.getBody1()->getUserIndex());
    kept_.push_back(pair);
    const bool lasts = std::ranges::binary_search(lasting_, pair);
    if (!lasts && !Touches(manifold)) continue;
    now_.push_back(pair);
    if (!lasts) Begin(pair, tick, bodies, tells);
  }
  const auto newest = begun_.first.begin() + static_cast<std::ptrdiff_t>(told);
  std::sort(newest, begun_.first.end(), [](const Contact& a, const Contact& b) {
    return std::pair(a.agent, a.other) < std::pair(b.agent, b.other);
  });
  if (begun_.first.size() > kMaxContactsTold) begun_.first.resize(kMaxContactsTold);
  std::ranges::sort(now_);
  lasting_.swap(now_);
}

void ContactCounter::Begin(const Pair& pair, std::int64_t tick, std::span<const Body> bodies, bool tells) {
  const bool is_of_agents = pair.first > kGroundIndex;
  ++(is_of_agents ? begun_.agents : pair.first == kGroundIndex ? begun_.ground : begun_.obstacles);
  if (!tells) return;
  const int agent = is_of_agents ? pair.first : pair.second;
  const int other = is_of_agents ? pair.second : pair.first;
  // At the tick: the solver slows bodies down in the steps before they touch.
  Eigen::Vector3d v_W = bodies[static_cast<std::size_t>(agent - 1)].state.v_WB;
  if (is_of_agents) v_W -= bodies[static_cast<std::size_t>(other - 1)].state.v_WB;
  begun_.first.push_back({.tick = tick, .agent = agent, .other = other, .speed_m_per_s = v_W.norm()});
}

}  // namespace mascot

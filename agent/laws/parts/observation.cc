#include "agent/laws/parts/observation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>

#include "base/fnv.h"

namespace mascot {
namespace {

double* Put(const Eigen::Vector3d& vector, double* to) {
  for (Eigen::Index k = 0; k < 3; ++k) *to++ = vector[k];
  return to;
}

}  // namespace

std::string ObservationLayout::Text() const {
  return fmt::format("mascot observation 1: own p 3, v 3, attitude 4; {} x (p 3, v 3, weight, heard, age, message {})",
                     places, message);
}

std::string ObservationLayout::Hash() const { return fmt::format("{:016x}", Fnv1a(Text())); }

std::vector<std::string> ObservationLayout::Names() const {
  std::vector<std::string> names;
  const auto add = [&](const std::string& what, std::string_view axes) {
    for (const char axis : axes) names.push_back(fmt::format("{}.{}", what, axis));
  };
  add("p", "xyz");
  add("v", "xyz");
  add("attitude", "xyzw");
  for (std::size_t k = 0; k < places; ++k) {
    const std::string name = fmt::format("neighbour[{}]", k);
    add(name + ".p", "xyz");
    add(name + ".v", "xyz");
    for (const char* const what : {"weight", "heard", "age"}) names.push_back(name + "." + what);
    for (std::size_t n = 0; n < message; ++n) names.push_back(fmt::format("{}.message[{}]", name, n));
  }
  return names;
}

ObservationLayout LayoutOf(const Experiment& experiment, std::size_t message) {
  std::size_t places = 0;
  for (int id = 1; id <= experiment.size(); ++id) places = std::max(places, experiment.graph.HeardBy(id).size());
  return {places, message};
}

Observer::Observer(const Experiment& experiment, int id, const ObservationLayout& layout) : layout_(layout) {
  for (const Graph::Neighbour& neighbour : experiment.graph.HeardBy(id)) ids_.push_back(neighbour.id);
}

void Observer::Observe(const Motion& self, std::span<const Heard> heard, std::span<double> to) const {
  double* next = Put(self.v_WB, Put(self.p_WB, to.data()));
  const double sign = self.q_WB.w() < 0 ? -1 : 1;  // q and -q are the same attitude
  for (const double part : {self.q_WB.x(), self.q_WB.y(), self.q_WB.z(), self.q_WB.w()}) *next++ = sign * part;
  auto one = heard.begin();
  for (std::size_t k = 0; k < layout_.places; ++k) {
    double* const end = next + ObservationLayout::kOfNeighbour + layout_.message;
    if (k < ids_.size() && one != heard.end() && one->id == ids_[k]) {
      next = Put(one->motion.v_WB - self.v_WB, Put(one->motion.p_WB - self.p_WB, next));
      *next++ = one->weight;
      *next++ = 1;
      *next++ = one->age_s;
      next = std::ranges::copy(one->message.first(std::min(one->message.size(), layout_.message)), next).out;
      ++one;
    }
    std::fill(next, end, 0.0);
    next = end;
  }
}

}  // namespace mascot

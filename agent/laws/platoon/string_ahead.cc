#include "agent/laws/platoon/string_ahead.h"

#include <cstdint>

namespace mascot {
namespace {

constexpr double kMaxStringSteps = 1e7;  // of one agent: about a second

}  // namespace

std::optional<StringAhead> FlyString(const Experiment& experiment, std::span<const std::unique_ptr<Law>> laws,
                                     LawMeter& meter) {
  const std::size_t count = laws.size();
  const double h = experiment.period_s();
  if (static_cast<double>(count) * static_cast<double>(experiment.ticks()) > kMaxStringSteps) return std::nullopt;
  StringAhead ahead;
  std::vector<Motion> motions(count);
  std::vector<Eigen::Vector3d> wanted_W(count);
  std::vector<std::vector<double>> said(count);
  for (std::size_t i = 0; i < count; ++i) {
    motions[i].p_WB = experiment.agents[i].p_W;
    motions[i].v_WB = experiment.agents[i].v_W;
  }
  for (std::int64_t tick = 0; tick <= experiment.ticks(); ++tick) {
    meter.Add({.tick = tick, .motions = motions, .commands = {}, .messages = {}});
    for (std::size_t i = 0; i < count; ++i) {
      const Heard before{.id = static_cast<int>(i),
                         .weight = 1,
                         .motion = i > 0 ? motions[i - 1] : Motion(),
                         .age_s = 0,
                         .message = i > 0 ? std::span<const double>(said[i - 1]) : std::span<const double>()};
      wanted_W[i] = Along(experiment.agents[i].law.axes,
                          laws[i]->Want_W(experiment.time_s(tick), motions[i], {&before, i > 0 ? 1U : 0U}));
      const double limit = experiment.agents[i].control.max_acceleration_m_per_s2;
      ahead.is_cut = ahead.is_cut || !(wanted_W[i].cwiseAbs().maxCoeff() <= limit);
    }
    for (std::size_t i = 0; i < count; ++i) {
      if (experiment.agents[i].sends_messages) {
        const std::span<const double> message = laws[i]->Message();
        said[i].assign(message.begin(), message.end());
      }
      motions[i].p_WB += h * motions[i].v_WB + h * h / 2 * wanted_W[i];
      motions[i].v_WB += h * wanted_W[i];
      motions[i].a_WB = wanted_W[i];
    }
  }
  ahead.figures = meter.Figures();
  return ahead;
}

}  // namespace mascot

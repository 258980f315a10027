#include "orchestrator/theory/period_bound.h"

#include "orchestrator/theory/sampled_team.h"

namespace mascot {

bool PeriodBoundIsKnown(const Experiment& experiment) { return experiment.size() <= 24; }

double PeriodBound(const Experiment& experiment, const LinearTeam& team, const Timeline& timeline) {
  Experiment prompt = experiment;
  prompt.links = {};
  prompt.sensors.own_delay_s = 0;
  const auto decays = [&](double h) { return SampledTeam(prompt, team, timeline, h).Decays(); };
  constexpr double kShortest_s = 1e-5, kLongest_s = 1e5, kStep = 1.15;
  double good = kShortest_s;
  if (!decays(good)) return 0;
  while (good < kLongest_s && decays(good * kStep)) good *= kStep;
  double bad = good * kStep;
  for (int halving = 0; halving < 30; ++halving) {
    const double middle = (good + bad) / 2;
    (decays(middle) ? good : bad) = middle;
  }
  return good;
}

}  // namespace mascot

// Flocking of double integrators; Olfati-Saber (2006), Algorithm 3, which without obstacles in sight is Algorithm 2
// (and Algorithm 1, with c1_gamma = c2_gamma = 0):
//   a_i = sum_j w_ij [ c1_alpha phi_alpha(|p_j - p_i|_sigma) n_ij
//                      + c2_alpha rho_h(|p_j - p_i|_sigma / r_alpha) (v_j - v_i) ]
//         + sum_k [ c1_beta phi_beta(|p_k - p_i|_sigma) n_ik + c2_beta rho_h(|p_k - p_i|_sigma / d_beta) (v_k - v_i) ]
//         - c1_gamma (p_i - p_r) - c2_gamma (v_i - v_r)
//   |z|_sigma = (sqrt(1 + epsilon |z|^2) - 1) / epsilon,  n_ij = (p_j - p_i) / sqrt(1 + epsilon |p_j - p_i|^2)
// Alpha agents keep the distance d from each other, and do nothing to each other from the range r = range_ratio d on.
// phi_alpha = rho_h phi, where rho_h fades from 1 to 0 between the share `bump` of the range and the range, and phi is
// the paper's with a = b = 1. The gamma agent (p_r, v_r) has a constant velocity. Beta agents (p_k, v_k)
// are on the obstacles within sensors.range_m, of which the law sees the nearest points and knows the shapes
// (beta_agents.h).
// On an undirected graph and away from obstacles the forces between agents cancel: the centre of mass obeys
//   x'' = -c1_gamma (x - p_r) - c2_gamma (x' - v_r)
// and the structural energy about it, potentials and kinetic energy, never grows: agents end at one velocity.
#include "agent/laws/flocking/flocking.h"

#include <memory>
#include <string>
#include <utility>

#include "agent/laws/flocking/flock_meter.h"
#include "agent/laws/parts/ideal.h"
#include "agent/laws/parts/row_parts.h"

namespace mascot {
namespace {

constexpr Key kFlockingParameters[] = {
    key::Number("distance_m", Above(0, 1e4), "wanted distance between neighbours").Default("2.0").Live(),
    key::Number("range_ratio", Above(1, 100), "from this many distances on, agents do nothing to each other")
        .Default("1.2")
        .Live(),
    key::Number("epsilon", Above(0, 1000), "of the smooth norm").Default("0.1").Unit("1/m^2").Live(),
    key::Number("bump", {0, 0.99}, "share of the range, in the smooth norm, from which on neighbours count less")
        .Default("0.2")
        .Live(),
    key::Number("c1_alpha", {0, 1000}, "attraction and repulsion of neighbours").Default("1.0").Unit("1/s^2").Live(),
    key::Number("c2_alpha", {0, 1000}, "pull towards the neighbours' velocities").Default("1.0").Unit("1/s").Live(),
    key::Number("obstacle_distance_m", Above(0, 1e4), "obstacles nearer than this, and within sensors.range_m, push")
        .Otherwise("0.6 distance_m")
        .Live(),
    key::Number("c1_beta", {0, 1000}, "repulsion by these").Default("10.0").Unit("1/s^2").Live(),
    key::Number("c2_beta", {0, 1000}, "damping of the velocity towards them").Default("6.0").Unit("1/s").Live(),
    key::Number("c1_gamma", {0, 1000}, "pull towards the gamma agent").Default("0.2").Unit("1/s^2").Live(),
    key::Number("c2_gamma", {0, 1000}, "pull towards its velocity").Default("1.0").Unit("1/s").Live(),
    key::Vector3("target_m", {-1e6, 1e6}, "where the gamma agent is at the time 0").Default("[0.0, 0.0, 1.0]").Live(),
    key::Vector3("target_velocity_m_per_s", {-1000, 1000}, "its velocity, which it keeps")
        .Default("[0.0, 0.0, 0.0]")
        .Live(),
};

class Flocking final : public Law {
 public:
  explicit Flocking(const AgentConfig& agent) { Adopt(agent); }
  void Adopt(const AgentConfig& agent) override {
    params_ = &ParamsOf<FlockParams>(agent.law);
    axes_ = agent.law.axes;
  }

  void See(std::span<const Eigen::Vector3d> nearest_W) override { seen_W_ = nearest_W; }

  Eigen::Vector3d Want_W(double t_s, const Motion& self, std::span<const Heard> heard) override {
    const FlockParams& law = *params_;
    Eigen::Vector3d a_W = -law.c1_gamma * (self.p_WB - law.Target_W(t_s));
    a_W -= law.c2_gamma * (self.v_WB - law.target_velocity_W);
    for (const Heard& j : heard) {
      const Eigen::Vector3d way_W = Along(axes_, j.motion.p_WB - self.p_WB);
      const double l = way_W.norm();
      if (l >= law.pair.range_m()) continue;
      a_W += j.weight * law.c1_alpha * law.pair.Stiffness(l) * way_W;
      a_W += j.weight * law.c2_alpha * law.pair.Weight(l) * (j.motion.v_WB - self.v_WB);
    }
    if (!seen_W_.empty()) a_W += law.beta.Push_W(self, seen_W_);
    return a_W;
  }

 private:
  const FlockParams* params_ = nullptr;  // the experiment owns them
  Axes axes_ = Axes::kXy;
  std::span<const Eigen::Vector3d> seen_W_;
};

std::shared_ptr<const LawParams> ReadFlocking(const Experiment& experiment, const LawConfig& law, Section& section) {
  ExpectNoLeader(law, section);
  auto params = std::make_shared<FlockParams>();
  const double distance_m = section.Number("distance_m"), range_m = distance_m * section.Number("range_ratio");
  const double epsilon = section.Number("epsilon"), bump = section.Number("bump");
  params->pair = AlphaPair(distance_m, range_m, epsilon, bump);
  params->beta = {.distance_m = section.Number("obstacle_distance_m", 0.6 * distance_m),
                  .epsilon = epsilon,
                  .c1 = section.Number("c1_beta"),
                  .c2 = section.Number("c2_beta"),
                  .obstacles = experiment.physics.obstacles};
  params->c1_alpha = section.Number("c1_alpha");
  params->c2_alpha = section.Number("c2_alpha");
  params->c1_gamma = section.Number("c1_gamma");
  params->c2_gamma = section.Number("c2_gamma");
  params->target_W = section.Vector3("target_m");
  params->target_velocity_W = section.Vector3("target_velocity_m_per_s");
  return params;
}

LawTheory PredictFlocking(const Experiment& experiment) {
  const auto& params = ParamsOf<FlockParams>(experiment.law);
  Experiment anywhere = experiment;  // two agents are in range of each other or are not: their forces cancel
  anywhere.schedule = experiment.schedule.WithRange(0);
  LawTheory theory{.silent = WhyNotIdeal(anywhere, Wanted::kAcceleration),
                   .unlimited = true,
                   .warnings = params.beta.Warnings(experiment)};
  if (!theory.silent.empty()) return theory;
  if (!experiment.graph.IsSymmetric()) theory.silent = "the closed forms are of undirected graphs";
  if (params.beta.MayPush(experiment)) theory.silent = "obstacles push the agents that see them";
  if (theory.silent.empty()) theory.figures = PredictFlock(experiment);
  return theory;
}

}  // namespace

LawEntry FlockingLaw() {
  return {
      .name = "flocking",
      .summary = "agents fly as a flock: near each other, at one velocity, with a target or without, around obstacles",
      .equation =
          "a_i = sum_j a_ij [c1_alpha phi_alpha(|p_j - p_i|_s) n_ij + c2_alpha rho_h(|p_j - p_i|_s / r_alpha) "
          "(v_j - v_i)] + sum_k [c1_beta phi_beta(|p_k - p_i|_s) n_ik + c2_beta rho_h(|p_k - p_i|_s / d_beta) "
          "(v_k - v_i)] - c1_gamma (p_i - p_r) - c2_gamma (v_i - v_r)",
      .tex =
          R"(a_i = \sum_j a_{ij} \bigl[ c_1^\alpha\, \phi_\alpha(\lvert p_j - p_i \rvert_s)\, n_{ij} + c_2^\alpha\, \rho_h(\lvert p_j - p_i \rvert_s / r_\alpha)\, (v_j - v_i) \bigr] \\
\quad {} + \sum_k \bigl[ c_1^\beta\, \phi_\beta(\lvert p_k - p_i \rvert_s)\, n_{ik} + c_2^\beta\, \rho_h(\lvert p_k - p_i \rvert_s / d_\beta)\, (v_k - v_i) \bigr] \\
\quad {} - c_1^\gamma (p_i - p_r) - c_2^\gamma (v_i - v_r))",
      .symbols = {{"c1_alpha", R"(c_1^\alpha)"},
                  {"c2_alpha", R"(c_2^\alpha)"},
                  {"c1_beta", R"(c_1^\beta)"},
                  {"c2_beta", R"(c_2^\beta)"},
                  {"c1_gamma", R"(c_1^\gamma)"},
                  {"c2_gamma", R"(c_2^\gamma)"}},
      .graph = "undirected: agents that are near each other hear each other, as with graph.range_m",
      .details =
          "|z|_s = (sqrt(1 + epsilon |z|^2) - 1) / epsilon, n_ij = (p_j - p_i) / sqrt(1 + epsilon |p_j - p_i|^2), "
          "r_alpha "
          "= |range_ratio distance_m|_s, d_alpha = |distance_m|_s, d_beta = |obstacle_distance_m|_s.\n"
          "phi_alpha(s) = rho_h(s / r_alpha) phi(s - d_alpha) with the paper's phi for a = b = 1: phi(s) = s / sqrt(1 "
          "+ "
          "s^2). rho_h is 1 up to the share bump, 0 from 1 on, and (1 + cos(pi (s - bump) / (1 - bump))) / 2 between. "
          "phi_beta(s) = rho_h(s / d_beta) (phi(s - d_beta) - 1), where rho_h has the share 0.9.\n"
          "Distances between agents are along law.axes. The gamma agent is at p_r = target_m + t "
          "target_velocity_m_per_s, with the constant velocity v_r.\n"
          "p_k is the nearest point, in space, of each obstacle that is seen, within sensors.range_m; v_k is how fast "
          "that point moves as the agent flies past. Beta agents at least obstacle_distance_m away do nothing.",
      .theory =
          "undirected, no obstacle in sight: the centre of mass obeys x'' = -c1_gamma (x - p_r) - c2_gamma (x' - "
          "v_r); the structural energy about it never grows, but for what holding a command costs; agents end at one "
          "velocity",
      .source =
          "Olfati-Saber, Flocking for multi-agent dynamic systems: algorithms and theory, IEEE Trans. Autom. "
          "Control 51 (2006)",
      .parameters = kFlockingParameters,
      .figures = kFlockFigures,
      .curve = LawCurve{.name = "velocity mismatch", .unit = "m/s", .meaning = "the largest, from the mean velocity"},
      .sees_obstacles = true,
      .drawing = {},
      .read = ReadFlocking,
      .make = MakeOf<Flocking>,
      .predict = PredictFlocking,
      .meter = MeterOf<FlockMeter>};
}

}  // namespace mascot

// Flight to a goal among obstacles and other agents, by an artificial potential; Khatib (1986):
//   f_i = [gain (w_i - p_i) + sum_j push(|p_i - p_j| - 2 R_i)]_s
//   v_i = [f_i + sum_k push(|p_i - q_k| - R_i)]_s
//   push(c) = repulsion (1/c - 1/c0) / c^2 for clearances c < c0, away from the other, else 0
// w_i is the goal, q_k the nearest point of an obstacle that is seen, R_i the radius of the body; [.]_s has at most the
// length s = speed_m_per_s, and c0 = influence_m - R_i for obstacles, influence_m - 2 R_i for agents. A body that is
// driven by acceleration gets k_v (v_i - v): Khatib's force with the damping k_v. What goal and agents ask for is
// limited before obstacles push: so where one obstacle pushes at a time the clearance stays above a bound, however many
// agents push (clearance_bound.h). Nothing is promised about arrival: the potential may have a minimum in front of an
// obstacle, and there the agent stays (Koren & Borenstein 1991).
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "agent/laws/avoidance/clearance_bound.h"
#include "agent/laws/avoidance/goals.h"
#include "agent/laws/avoidance/repulsion.h"
#include "agent/laws/parts/row_parts.h"

namespace mascot {
namespace {

constexpr Key kAvoidanceParameters[] = {
    kGoalsKey,
    key::Number("gain", Above(0, 1000), "pull towards the goal").Default("1.0").Unit("1/s").Live(),
    key::Number("speed_m_per_s", Above(0, 1000), "largest speed").Default("0.7").Live(),
    key::Number("repulsion", {0, 1000}, "of obstacles, and of agents that are heard")
        .Default("0.5")
        .Unit("m^4/s")
        .Live(),
    key::Number("influence_m", Above(0, 1000), "obstacles and agents push that are nearer than this to the position")
        .Default("2.0")
        .Live(),
};

struct AvoidanceParams final : LawParams {
  std::vector<Eigen::Vector3d> goals_W;  // by id - 1
  double gain = 0, speed = 0, repulsion = 0, influence_m = 0;

  const Eigen::Vector3d& goal_W(int id) const { return goals_W[static_cast<std::size_t>(id - 1)]; }
  Repulsion From(double radii_m) const { return {.gain = repulsion, .reach = influence_m - radii_m}; }
};

const AvoidanceParams& AvoidanceOf(const AgentConfig& agent) { return ParamsOf<AvoidanceParams>(agent.law); }

class Avoidance final : public Law {
 public:
  explicit Avoidance(const AgentConfig& agent) { Adopt(agent); }
  Wanted wanted() const override { return Wanted::kVelocity; }
  void Adopt(const AgentConfig& agent) override { agent_ = &agent; }
  void See(std::span<const Eigen::Vector3d> nearest_W) override { seen_W_ = nearest_W; }

  Eigen::Vector3d Want_W(double /*t_s*/, const Motion& self, std::span<const Heard> heard) override {
    const AvoidanceParams& params = AvoidanceOf(*agent_);
    const double radius_m = agent_->radius_m();
    Eigen::Vector3d f_W = params.gain * (params.goal_W(agent_->id) - self.p_WB);
    for (const Heard& j : heard) f_W += Push_W(params, self.p_WB - j.motion.p_WB, 2 * radius_m);
    Eigen::Vector3d v_W = Limited(Along(agent_->law.axes, f_W), params.speed);
    for (const Eigen::Vector3d& q_W : seen_W_)
      v_W += Along(agent_->law.axes, Push_W(params, self.p_WB - q_W, radius_m));
    return Limited(v_W, params.speed);
  }

 private:
  /// The push by something from which the vector `away_W` leads here.
  static Eigen::Vector3d Push_W(const AvoidanceParams& params, const Eigen::Vector3d& away_W, double radii_m) {
    const double l = away_W.norm();
    if (l == 0) return Eigen::Vector3d::Zero();  // inside of it: there is no direction
    return params.From(radii_m).Push(l - radii_m) / l * away_W;
  }

  const AgentConfig* agent_ = nullptr;  // the experiment owns it
  std::span<const Eigen::Vector3d> seen_W_;
};

std::shared_ptr<const LawParams> ReadAvoidance(const Experiment& experiment, const LawConfig& law, Section& section) {
  ExpectNoLeader(law, section);
  auto params = std::make_shared<AvoidanceParams>();
  params->goals_W = ReadGoals(experiment, section);
  params->gain = section.Number("gain");
  params->speed = section.Number("speed_m_per_s");
  params->repulsion = section.Number("repulsion");
  params->influence_m = section.Number("influence_m");
  const double range_m = experiment.sensors.range_m;
  if (!experiment.physics.obstacles.empty() && range_m < params->influence_m)
    section.Fail("name",
                 "expected sensors.range_m of at least law.influence_m = " + ShortestFloat(params->influence_m) +
                     ", so that obstacles are seen in time, got " + ShortestFloat(range_m));
  for (const AgentConfig& agent : experiment.agents)
    if (agent.law.name == law.name && params->influence_m <= 2 * agent.radius_m() && !section.Wrong("influence_m"))
      section.Fail("influence_m", "expected more than the diameter of the bodies, " +
                                      ShortestFloat(2 * agent.radius_m()) + ", got " +
                                      ShortestFloat(params->influence_m));
  return params;
}

const Eigen::Vector3d& GoalOfAvoidance(const AgentConfig& agent) { return AvoidanceOf(agent).goal_W(agent.id); }

std::span<const Eigen::Vector3d> WaypointOfAvoidance(const AgentConfig& agent) { return {&GoalOfAvoidance(agent), 1}; }

std::map<std::string, Value> GoToOfAvoidance(const AgentConfig& agent, const Eigen::Vector3d& p_W, double /*t_s*/) {
  return GoToGoal(AvoidanceOf(agent).goals_W, agent.id, p_W);
}

LawTheory PredictAvoidance(const Experiment& experiment) {
  const auto& params = ParamsOf<AvoidanceParams>(experiment.law);
  ClearanceBound bound{.gain = params.repulsion, .influence_m = params.influence_m, .speed = params.speed};
  if (std::string why = bound.WhyNot(experiment); !why.empty()) return {.silent = std::move(why)};
  LawTheory theory{.figures = {bound.Predicted(experiment), {}}};
  if (theory.figures[0].values.empty())
    theory.warnings.emplace_back(
        "law.repulsion: too weak for law.speed_m_per_s: an agent that flies straight at an obstacle may touch it");
  return theory;
}

std::unique_ptr<LawMeter> MeterOfAvoidance(const Experiment& experiment, std::span<const int> ids) {
  return std::make_unique<GoalMeter>(experiment, ids, GoalOfAvoidance);
}

}  // namespace

LawEntry AvoidanceLaw() {
  return {
      .name = "avoidance",
      .summary =
          "each agent flies to its goal, repelled by obstacles that it sees and agents that it hears: the law "
          "wants a velocity",
      .equation = "v_i = [[gain (w_i - p_i) + sum_j push]_s + sum_k push]_s,  push = repulsion (1/c - 1/c0) / c^2",
      .tex =
          R"(v_i = \Bigl[ \bigl[ k (w_i - p_i) + \sum_j f_{ij} \bigr]_s + \sum_o f_{io} \Bigr]_s, \quad \lvert f \rvert = \frac{\mu}{c^2} \Bigl( \frac{1}{c} - \frac{1}{c_0} \Bigr) \text{, away from agent } j \text{ or obstacle } o)",
      .symbols = {{"gain", "k"}, {"goals_m", "w_i"}, {"speed_m_per_s", "s"}, {"repulsion", R"(\mu)"}},
      .graph = "any: agents keep clear of those that they hear",
      .details =
          "[.]_s is cut to the length speed_m_per_s. c is the clearance: the distance less the radius R_i "
          "of the own body from the nearest point of an obstacle, less 2 R_i from an agent. It counts as 1 "
          "mm at least. c0 is influence_m less the same radii, and there is no push from c0 on, nor within "
          "an obstacle, where there is no way out to point along.\n"
          "Obstacles push that are seen, within sensors.range_m, and agents that are heard. Distances are "
          "in space; pushes and the pull towards the goal act along law.axes.",
      .theory =
          "where one obstacle pushes at a time, the clearance stays above a bound: for single integrators, where "
          "the push is s; nothing is promised about arrival: the potential may have local minima",
      .source =
          "Khatib, Real-time obstacle avoidance for manipulators and mobile robots, Int. J. Robotics Research 5 "
          "(1986)",
      .parameters = kAvoidanceParameters,
      .figures = kGoalFigures,
      .curve = kGoalCurve,
      .axes = Axes::kXyz,
      .sees_obstacles = true,
      .drawing = {},
      .read = ReadAvoidance,
      .make = MakeOf<Avoidance>,
      .wanted = WantsVelocity,
      .go_to = GoToOfAvoidance,
      .waypoints_W = WaypointOfAvoidance,
      .predict = PredictAvoidance,
      .meter = MeterOfAvoidance};
}

}  // namespace mascot

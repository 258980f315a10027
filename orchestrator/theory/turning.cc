// A mode of a team of quadrotors along x or y, with the parts of the low-level stack that matter for small errors
// (agent/controllers/quadrotor.cc): its law u = -(d v + k x), the reference p*, the attitude's PD law, the rotors. At
// small tilts the acceleration a of the body is proportional to its tilt, and obeys the law of the tilt:
//   x' = v,  v' = a - drag v,  a' = w,  w' = c                      or, with rotors that take time, T w'' = c - w'
// where c = kp (a* - a) - kd w,  a* = u + kp_ref (p* - x) + kd_ref (v* - v) + compensated drag v  is computed once in a
// control period h and held, as is p*'' = u. The map over one period then has the eigenvalues of the mode.
#include "orchestrator/theory/turning.h"

#include <fmt/format.h>

#include <algorithm>
#include <complex>
#include <vector>

#include "agent/laws/parts/ideal.h"
#include "base/linear_algebra.h"

namespace mascot {
namespace {

enum State : Eigen::Index { kX, kV, kA, kW, kRotors, kBodyStates };

/// e^(matrix), of a matrix whose norm is at most about 100.
Eigen::MatrixXd Exponential(const Eigen::MatrixXd& matrix) {
  constexpr int kSquarings = 6, kTerms = 12;
  const Eigen::MatrixXd small = matrix / (1 << kSquarings);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Identity(matrix.rows(), matrix.cols()), term = sum;
  for (int k = 1; k <= kTerms; ++k) {
    term = (term * small / k).eval();
    sum += term;
  }
  for (int k = 0; k < kSquarings; ++k) sum = (sum * sum).eval();
  return sum;
}

/// The body over one period with c held: the states after it from those before it, and, in the last column, from c.
Eigen::MatrixXd BodyOver(double period_s, double drag_per_s, double rotor_time_constant_s) {
  const bool has_rotors = rotor_time_constant_s > period_s / 100;  // faster ones are there at once
  const Eigen::Index states = has_rotors ? kBodyStates : kRotors;
  Eigen::MatrixXd rates = Eigen::MatrixXd::Zero(states + 1, states + 1);
  rates(kX, kV) = rates(kV, kA) = rates(kA, kW) = 1;
  rates(kV, kV) = -drag_per_s;
  if (has_rotors) {
    rates(kW, kRotors) = 1;
    rates(kRotors, kRotors) = -1 / rotor_time_constant_s;
    rates(kRotors, states) = 1 / rotor_time_constant_s;
  } else {
    rates(kW, states) = 1;
  }
  return Exponential(period_s * rates).topRows(states);
}

/// The quadrotor with its low-level stack, but without its law.
class TurningBody {
 public:
  TurningBody(const Experiment& experiment, const AgentConfig& quadrotor, double uncompensated_drag_per_s)
      : body_(quadrotor.airframe),
        h_(experiment.period_s()),
        drag_per_s_(body_.linear_drag_kg_per_s / body_.mass_kg),
        compensated_per_s_(drag_per_s_ - uncompensated_drag_per_s),
        uncompensated_per_s_(uncompensated_drag_per_s),
        over_(BodyOver(h_, drag_per_s_, body_.rotor_time_constant_s)),
        has_reference_(body_.position.kp > 0 || body_.position.kd > 0) {}

  bool Decays(const LinearMode& mode, double share) const {
    const Eigen::Index body = over_.rows(), states = body + (has_reference_ ? 2 : 0), p_ref = body, v_ref = body + 1;
    Eigen::RowVectorXcd u = Eigen::RowVectorXcd::Zero(states);
    u(kX) = -share * mode.stiffness;
    u(kV) = -(mode.damping - uncompensated_per_s_);
    Eigen::RowVectorXcd wanted = u;
    wanted(kV) += compensated_per_s_;
    if (has_reference_) {
      wanted(kX) -= body_.position.kp;
      wanted(kV) -= body_.position.kd;
      wanted(p_ref) += body_.position.kp;
      wanted(v_ref) += body_.position.kd;
    }
    Eigen::RowVectorXcd c = body_.attitude.kp * wanted;
    c(kA) -= body_.attitude.kp;
    c(kW) -= body_.attitude.kd;
    Eigen::MatrixXcd map = Eigen::MatrixXcd::Zero(states, states);
    map.topLeftCorner(body, body) = over_.leftCols(body);
    map.topRows(body) += over_.rightCols(1) * c;
    if (has_reference_) {
      map(p_ref, p_ref) = map(v_ref, v_ref) = 1;
      map(p_ref, v_ref) = h_;
      map.row(p_ref) += h_ * h_ / 2 * u;
      map.row(v_ref) += h_ * u;
    }
    return Eigenvalues(map).cwiseAbs().maxCoeff() < 1;
  }

 private:
  const Airframe& body_;
  const double h_, drag_per_s_, compensated_per_s_, uncompensated_per_s_;
  const Eigen::MatrixXd over_;
  const bool has_reference_;
};

bool TurnAlike(const AgentConfig& a, const AgentConfig& b) {
  const auto same = [](const PdGains& x, const PdGains& y) { return x.kp == y.kp && x.kd == y.kd; };
  const Airframe &one = a.airframe, &other = b.airframe;
  return same(one.attitude, other.attitude) && same(one.position, other.position) &&
         one.rotor_time_constant_s == other.rotor_time_constant_s &&
         one.linear_drag_kg_per_s / one.mass_kg == other.linear_drag_kg_per_s / other.mass_kg &&
         a.control.drag_compensation == b.control.drag_compensation;
}

}  // namespace

double StableShare(const Experiment& experiment, const AgentConfig& quadrotor, const LinearAgent& moves,
                   std::span<const LinearMode> modes) {
  const TurningBody body(experiment, quadrotor, moves.drag_b);
  std::vector<LinearMode> critical;
  for (const LinearMode& mode : modes)
    if (!body.Decays(mode, 1)) critical.push_back(mode);
  double share = 1;
  constexpr double kLeast = 1e-4;
  for (const LinearMode& mode : critical) {
    if (body.Decays(mode, share)) continue;  // another mode has taken the share below this one's
    double decays = kLeast, does_not = share;
    if (!body.Decays(mode, decays)) return 0;
    while (does_not - decays > 1e-5 * does_not) {
      const double middle = (decays + does_not) / 2;
      (body.Decays(mode, middle) ? decays : does_not) = middle;
    }
    share = decays;
  }
  return share;
}

bool JudgeTurning(const Experiment& experiment, std::span<const int> ids, const LinearAgent& moves,
                  std::span<const LinearMode> modes, std::string_view key, double gain, Prediction& prediction) {
  if (ids.empty() || moves.order != 2) return true;
  const AgentConfig& first = experiment.agent(ids.front());
  for (const int id : ids) {
    const AgentConfig& agent = experiment.agent(id);
    if (!agent.traits().has_airframe || !TurnAlike(agent, first)) return true;
  }
  const double share = StableShare(experiment, first, moves, modes);
  if (share == 1) return true;
  prediction.warnings.push_back(
      share > 0
          ? fmt::format("{}: unstable, it must be below {:.4g}, got {:.5g}: quadrotors turn before they accelerate",
                        key, share * gain, gain)
          : fmt::format("{}: unstable, however small it is: quadrotors turn before they accelerate", key));
  return false;
}

bool JudgeTurning(const Experiment& experiment, const LawRates& rates, Prediction& prediction) {
  if (!WhyNotAllHeard(experiment).empty()) return true;
  std::vector<int> ids;
  std::vector<LinearMode> modes;
  const auto moves_of = [](const AgentConfig& agent) { return FollowingAgent(agent, {.p = 1}, Wanted::kVelocity); };
  const LinearAgent moves = moves_of(experiment.agents.front());
  for (const AgentConfig& agent : experiment.agents) {
    if (!moves_of(agent).MovesAs(moves)) return true;
    ids.push_back(agent.id);
  }
  for (const double rate : rates.per_s) modes.push_back(moves.Mode(rate));
  return JudgeTurning(experiment, ids, moves, modes, rates.key, rates.gain, prediction);
}

}  // namespace mascot

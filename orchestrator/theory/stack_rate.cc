// The loops of the low-level stack (agent/controllers/) for small errors, each by itself. A command c is computed once
// in a control period h and held; the body moves in n steps of the physics, dt = h / n. In each, per axis,
//   r += f (c - r),  x += dt v + dt^2 / 2 a,  v += dt a,  w += dt r,  b += dt w
// r: what the rotors give, f = 1 - exp(-dt / lag) of the way to c, or all of it; b: the tilt, in units of the
// acceleration that it gives; w its rate. a = b for a body that tilts to accelerate, a = r else. A loop decays if the
// eigenvalues of the map of its states over h lie inside the unit circle:
//   attitude, heading   w, b       c = -kp b - kd w
//   altitude            x, v       c = -kp x - kd v, with a = r
//   position            all        c = kp (a* - b) - kd w,  a* = -kp' x - kd' v
//   velocity            all, v*    likewise, with a* = -k_v v - kp' x - kd' (v - v*), v*' = -k_v v; x counts from p*
#include "orchestrator/theory/stack_rate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "agent/laws/laws.h"
#include "base/linear_algebra.h"

namespace mascot {
namespace {

using Matrix = Eigen::MatrixXd;
using RowVector = Eigen::RowVectorXd;

enum Quantity : Eigen::Index { kPlace, kSpeed, kTilt, kTurn, kRotor, kHeld, kQuantities };

constexpr double kMaxRate_hz = 1e5;

Matrix PowerOf(Matrix matrix, int exponent) {
  Matrix power = Matrix::Identity(matrix.rows(), matrix.cols());
  for (; exponent > 0; exponent /= 2) {
    if (exponent % 2 == 1) power = (power * matrix).eval();
    matrix = (matrix * matrix).eval();
  }
  return power;
}

/// The quantities after a period from those before it and the held c.
Matrix BodyOverPeriod(double h, int physics_rate_hz, double lag_s, bool tilts) {
  const int steps = std::max(1, static_cast<int>(std::lround(h * physics_rate_hz)));
  const double dt = h / steps, followed = lag_s > 0 ? -std::expm1(-dt / lag_s) : 1;
  Matrix rotors = Matrix::Identity(kQuantities, kQuantities), moves = rotors;
  rotors(kRotor, kRotor) = 1 - followed;
  rotors(kRotor, kHeld) = followed;
  const Quantity push = tilts ? kTilt : kRotor;
  moves(kPlace, kSpeed) = dt;
  moves(kPlace, push) += dt * dt / 2;
  moves(kSpeed, push) += dt;
  moves(kTurn, kRotor) += dt;
  moves(kTilt, kTurn) += dt;
  moves(kTilt, kRotor) += dt * dt;
  return PowerOf(moves * rotors, steps);
}

double LargestEigenvalue(const Matrix& map) { return map.size() == 0 ? 0 : Eigenvalues(map).cwiseAbs().maxCoeff(); }

/// Rows and columns `kept` of `map`.
Matrix Part(const Matrix& map, const std::vector<Eigen::Index>& kept) { return map(kept, kept); }

bool HasGains(const PdGains& gains) { return gains.kp > 0 || gains.kd > 0; }

/// One loop of one agent's stack.
class StackLoop {
 public:
  enum class Kind { kTurning, kClimbing, kPosition, kVelocity, kPushed };

  std::string_view name;
  Kind kind = Kind::kTurning;
  PdGains outer = {}, attitude = {};  // the gains of the loop itself; of the tilt, where it works by tilting
  double k_v = 0;
  double lag_s = 0;
  int physics_rate_hz = 0;

  bool Decays(double h) const {
    constexpr double kRounding = 1e-9;
    return LargestEigenvalue(Map(h)) < 1 - kRounding;
  }

 private:
  /// The map of the loop's states over a period.
  Matrix Map(double h) const {
    const bool tilts = kind == Kind::kPosition || kind == Kind::kVelocity;
    Matrix body = BodyOverPeriod(h, physics_rate_hz, lag_s, tilts);
    RowVector command = RowVector::Zero(kQuantities);
    if (kind == Kind::kTurning) {
      command(kTilt) = -outer.kp;
      command(kTurn) = -outer.kd;
    } else {
      command(kPlace) = -outer.kp;
      command(kSpeed) = -outer.kd - k_v;
    }
    if (tilts) {
      command *= attitude.kp;
      command(kTilt) = -attitude.kp;
      command(kTurn) = -attitude.kd;
    }
    if (kind == Kind::kVelocity && HasGains(outer)) return WithReference(body, command, h);
    const Matrix map = body.topLeftCorner(kHeld, kHeld) + body.topRightCorner(kHeld, 1) * command.head(kHeld);
    return Part(map, States());
  }

  /// Adds the reference's velocity, and counts the place from the reference's.
  Matrix WithReference(const Matrix& body, const RowVector& command, double h) const {
    const Eigen::Index v_ref = kHeld;  // takes the place of c, which is put in
    Matrix map = Matrix::Zero(kHeld + 1, kHeld + 1);
    map.topLeftCorner(kHeld, kHeld) = body.topLeftCorner(kHeld, kHeld);
    RowVector wanted = command;
    wanted(v_ref) = attitude.kp * outer.kd;
    map.topRows(kHeld) += body.topRightCorner(kHeld, 1) * wanted;
    map(v_ref, v_ref) = 1;
    map(v_ref, kSpeed) = -h * k_v;
    map(kPlace, v_ref) -= h;
    map(kPlace, kSpeed) += h * h / 2 * k_v;
    std::vector<Eigen::Index> kept = States();
    kept.push_back(v_ref);
    return Part(map, kept);
  }

  /// The states that the loop brings to 0: without a proportional gain, it leaves the place, or the angle, where it is.
  std::vector<Eigen::Index> States() const {
    std::vector<Eigen::Index> states;
    if (kind == Kind::kTurning) {
      if (outer.kp > 0) states.push_back(kTilt);
      states.push_back(kTurn);
    } else {
      if (outer.kp > 0 || (kind == Kind::kVelocity && HasGains(outer))) states.push_back(kPlace);
      states.push_back(kSpeed);
    }
    if (kind == Kind::kPosition || kind == Kind::kVelocity) {
      states.push_back(kTilt);
      states.push_back(kTurn);
    }
    if (lag_s > 0) states.push_back(kRotor);
    return states;
  }
};

bool MayWantVelocity(const AgentConfig& agent) {
  return WantedBy(agent.law) == Wanted::kVelocity || agent.start_s > 0 || std::isfinite(agent.stop_s);
}

std::vector<StackLoop> LoopsOf(const Experiment& experiment, const AgentConfig& agent) {
  using Kind = StackLoop::Kind;
  std::vector<StackLoop> loops;
  if (agent.traits().driven_by == Wanted::kVelocity) return loops;  // it has the velocity that it is told
  const Airframe& body = agent.airframe;
  const bool tilts = agent.traits().has_airframe;
  const double k_v = MayWantVelocity(agent) ? agent.control.velocity_gain : 0;
  const bool leaves_height =  // a body that does not tilt, and starts at rest at the height that it is to hold, stays
      tilts || (agent.law.axes == Axes::kXy && (agent.v_W.z() != 0 || !experiment.sensors.own.IsNone()));
  const auto add = [&](std::string_view name, Kind kind, const PdGains& gains, double velocity_gain) {
    loops.push_back({.name = name,
                     .kind = kind,
                     .outer = gains,
                     .attitude = body.attitude,
                     .k_v = velocity_gain,
                     .lag_s = tilts ? body.rotor_time_constant_s : 0,
                     .physics_rate_hz = experiment.physics.rate_hz});
  };
  if (HasGains(body.altitude) && leaves_height) add("altitude", Kind::kClimbing, body.altitude, 0);
  if (!tilts && k_v > 0) add("velocity", Kind::kPushed, {}, k_v);
  if (!tilts) return loops;
  if (HasGains(body.heading)) add("heading", Kind::kTurning, body.heading, 0);
  if (!HasGains(body.attitude)) return loops;  // it cannot be steered
  add("attitude", Kind::kTurning, body.attitude, 0);
  if (body.attitude.kp > 0 && HasGains(body.position)) add("position", Kind::kPosition, body.position, 0);
  if (body.attitude.kp > 0 && k_v > 0) add("velocity", Kind::kVelocity, body.position, k_v);
  return loops;
}

/// The control rate above which the loop decays, upwards of one at which it does not; nothing: there is none.
std::optional<double> MinRate_hz(const StackLoop& loop, double rate_hz) {
  constexpr double kStep = 1.1;
  double bad = rate_hz, good = rate_hz * kStep;
  for (; !loop.Decays(1 / good); good *= kStep) {
    if (good > kMaxRate_hz) return std::nullopt;
    bad = good;
  }
  while (good - bad > 1e-4 * good) {
    const double middle = (good + bad) / 2;
    (loop.Decays(1 / middle) ? good : bad) = middle;
  }
  return good;
}

/// Whether the stacks of two agents are the same.
bool StackAlike(const AgentConfig& a, const AgentConfig& b) {
  const auto same = [](const PdGains& x, const PdGains& y) { return x.kp == y.kp && x.kd == y.kd; };
  const Airframe &one = a.airframe, &other = b.airframe;
  return a.model == b.model && a.law.axes == b.law.axes && a.v_W.z() == b.v_W.z() &&
         MayWantVelocity(a) == MayWantVelocity(b) && a.control.velocity_gain == b.control.velocity_gain &&
         same(one.altitude, other.altitude) && same(one.heading, other.heading) && same(one.attitude, other.attitude) &&
         same(one.position, other.position) && one.rotor_time_constant_s == other.rotor_time_constant_s;
}

}  // namespace

std::optional<UnstableLoop> FindUnstableLoop(const Experiment& experiment) {
  std::optional<UnstableLoop> worst;
  const auto rate_of = [](const UnstableLoop& loop) {
    return loop.rate_hz.value_or(std::numeric_limits<double>::infinity());
  };
  const AgentConfig* before = nullptr;
  for (const AgentConfig& agent : experiment.agents) {
    if (before != nullptr && StackAlike(*before, agent)) continue;
    before = &agent;
    for (const StackLoop& loop : LoopsOf(experiment, agent)) {
      if (loop.Decays(experiment.period_s())) continue;
      const UnstableLoop found{agent.id, loop.name, MinRate_hz(loop, experiment.control.rate_hz)};
      if (!worst || rate_of(found) > rate_of(*worst)) worst = found;
    }
  }
  return worst;
}

std::string Warning(const UnstableLoop& loop, const Experiment& experiment) {
  const AgentConfig& agent = experiment.agent(loop.agent);
  const std::string gains =
      loop.name == "velocity" ? "control.velocity_gain" : fmt::format("the gains `{}` of agents.airframe", loop.name);
  if (!loop.rate_hz)
    return fmt::format("agents.airframe: the {} loop of agent {} is unstable at every control.rate_hz, by {}",
                       loop.name, agent.id, gains);
  return fmt::format(
      "control.rate_hz: unstable at this rate, it must be above {:.4g}, got {}: the {} loop of agent {} ({}) computes "
      "once in a control period",
      *loop.rate_hz, experiment.control.rate_hz, loop.name, agent.id, gains);
}

}  // namespace mascot

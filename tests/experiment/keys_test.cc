// Every key of an experiment file does what it says: each row of these tables changes one key, and claims how the
// flight then differs, by the equations of the law, of the low-level stack and of the bodies where these tell it.
// output_keys_test.cc tests the keys of what a run leaves behind, engines_test.cc and faults_test.cc those for DDS and
// real time, laws_test.cc also the parameters of laws.

#include <gmock/gmock.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "tests/experiment/flight_claims.h"
#include "tests/support/param_name.h"

namespace mascot::test {
namespace {

/// A test of how a flight changes when `key` is set to `value`, in addition to `base`. `name` is the name of the test:
/// the key that is changed and, if several tests change it, how or for which agents.
struct Row {
  std::string key, value;
  Claim claim;
  std::vector<std::string> base = {};
  std::string name = key;
};

/// A row that sets `key` to `value`.
Row Set(const std::string& key, const std::string& value, Claim claim, std::vector<std::string> base = {},
        const std::string& name = "") {
  return {key, value, std::move(claim), std::move(base), name.empty() ? key : name};
}

void PrintTo(const Row& row, std::ostream* out) {
  *out << row.key << "=" << row.value;
  for (const std::string& set : row.base) *out << (&set == &row.base.front() ? " on top of " : ", ") << set;
}

Flight Fly(const std::vector<std::string>& sets) {
  std::vector<Override> overrides;
  for (const std::string& set : sets)
    overrides.push_back({.key = set.substr(0, set.find('=')), .value = set.substr(set.find('=') + 1)});
  return Flight(overrides);
}

class Key : public testing::TestWithParam<Row> {};

TEST_P(Key, DoesWhatItSays) {
  const Row& row = GetParam();
  std::vector<std::string> base = row.base;
  if (std::ranges::none_of(base, [](const std::string& set) { return set.starts_with("run.duration_s"); }))
    base.insert(base.begin(), "run.duration_s=1.0");
  auto changed = base;
  if (row.key == "run.duration_s") changed.clear();
  changed.push_back(row.key + "=" + row.value);
  row.claim(Fly(base), Fly(changed));
}

std::string NameOf(const testing::TestParamInfo<Row>& row) { return ParamName(row.param.name); }

// --- figures ----------------------------------------------------------------------------------------

Figure Ticks() {
  return [](const Flight& flight) { return flight.ticks(); };
}
Figure Agents() {
  return [](const Flight& flight) { return flight.agents(); };
}
/// A component of the acceleration that is commanded; `axis` 0, 1, 2.
Figure CommandOf(int id, int tick, int axis) {
  return [=](const Flight& flight) { return flight.command(id, tick).a_limited_W[axis]; };
}
Figure ActuatorOf(int id, int tick, std::size_t index) {
  return [=](const Flight& flight) { return flight.command(id, tick).actuator[index]; };
}
Figure VelocityOf(int id, int tick, int axis) {
  return [=](const Flight& flight) { return flight.at(id, tick).v_WB[axis]; };
}
Figure PlaceOf(int id, int tick, int axis) {
  return [=](const Flight& flight) { return flight.at(id, tick).p_WB[axis]; };
}
Figure HeadingOf(int id) {
  return [=](const Flight& flight) {
    const Eigen::Vector3d ahead = flight.at(id, 0).q_WB * Eigen::Vector3d::UnitX();
    return std::atan2(ahead.y(), ahead.x());
  };
}
/// Smallest difference of the heights of two agents at the start (m).
Figure NearestInHeight() {
  return [](const Flight& flight) {
    double nearest = 1e9;
    for (int i = 1; i <= flight.agents(); ++i)
      for (int j = 1; j < i; ++j)
        nearest = std::min(nearest, std::abs((flight.at(i, 0).p_WB - flight.at(j, 0).p_WB).z()));
    return nearest;
  };
}
/// Largest component of any command (m/s^2).
Figure LargestCommand() {
  return [](const Flight& flight) {
    double largest = 0;
    ForAll(flight, [&](int id, int tick) {
      largest = std::max(largest, flight.command(id, tick).a_limited_W.cwiseAbs().maxCoeff());
    });
    return largest;
  };
}
Figure FarthestX(int id) {
  return [=](const Flight& flight) {
    double farthest = -1e9;
    for (int tick = 0; tick <= flight.ticks(); ++tick) farthest = std::max(farthest, flight.at(id, tick).p_WB.x());
    return farthest;
  };
}
Figure Lowest() {
  return [](const Flight& flight) {
    double lowest = 1e9;
    ForAll(flight, [&](int id, int tick) { lowest = std::min(lowest, flight.at(id, tick).p_WB.z()); });
    return lowest;
  };
}

/// Sum of the squared rotor speeds that carries the weight of an agent: m g / b.
Figure CarriesItsWeight(int id) {
  return [=](const Flight& flight) {
    const Airframe& body = flight.airframe(id);
    return body.mass_kg * flight.experiment.physics.gravity_m_per_s2 / body.lift_n_s2;
  };
}
Figure SquaredSpeeds(int id) {
  return
      [=](const Flight& flight) { return Eigen::Vector4d::Map(flight.command(id, 0).actuator.data()).squaredNorm(); };
}

// --- [physics] --------------------------------------------------------------------------------------

/// How far the velocity of agent `id` after the first tick differs between the flights (m/s, in W).
Eigen::Vector3d Kick(const Flight& was, const Flight& is, int id) { return is.at(id, 1).v_WB - was.at(id, 1).v_WB; }

/// The first tick adds B/m w T to each velocity: the drag in a wind of w.
void IsDragged(const Flight& was, const Flight& is, const Eigen::Vector3d& wind_W, double share) {
  for (int id = 1; id <= is.agents(); ++id) {
    const double per_s = is.airframe(id).linear_drag_kg_per_s / is.airframe(id).mass_kg;
    EXPECT_LT((Kick(was, is, id) - per_s * is.T() * wind_W).norm(), share * per_s * is.T() * wind_W.norm());
  }
}

/// Mean square of the change of the wind from tick to tick ((m/s)^2), from the velocities of this flight and of a calm
/// one.
double Gustiness(const Flight& flight) {
  const Flight calm = Fly({"run.duration_s=1.0"});
  const double per_s = flight.airframe(1).linear_drag_kg_per_s / flight.airframe(1).mass_kg;
  double sum = 0;
  Eigen::Vector3d last = Eigen::Vector3d::Zero(), last_wind = Eigen::Vector3d::Zero();
  for (int tick = 1; tick <= flight.ticks(); ++tick) {
    const Eigen::Vector3d off = flight.at(1, tick).v_WB - calm.at(1, tick).v_WB;
    const Eigen::Vector3d wind = (off - last) / flight.T() / per_s;
    if (tick > 1) sum += (wind - last_wind).squaredNorm() / (flight.ticks() - 1);
    last = off;
    last_wind = wind;
  }
  return sum;
}

/// The wind pulls east.
void IsDraggedEast(const Flight& was, const Flight& is) { IsDragged(was, is, {1, 0, 0}, 0.02); }

/// All agents feel the same gusts, along all axes.
void IsGusty(const Flight& was, const Flight& is) {
  const double per_s = is.airframe(1).linear_drag_kg_per_s / is.airframe(1).mass_kg;
  const Eigen::Vector3d gust_W = Kick(was, is, 1) / (per_s * is.T());
  EXPECT_GT(gust_W.cwiseAbs().minCoeff(), 0.01) << "along all axes";
  EXPECT_LT(gust_W.cwiseAbs().maxCoeff(), 4) << "standard deviations";
  IsDragged(was, is, gust_W, 0.02);  // all feel the same
}

/// The gusts change more slowly: with the time tau, E|g(tick + T) - g(tick)|^2 = 6 sigma^2 (1 - exp(-T/tau)); here tau
/// becomes 3 s.
void ChangesAsRarely(const Flight& was, const Flight& is) {
  const double tau_was = was.experiment.physics.wind.gust_time_s;
  const double ratio = std::expm1(-is.T() / 3.0) / std::expm1(-is.T() / tau_was);
  EXPECT_NEAR(Gustiness(is) / Gustiness(was), ratio, 0.2 * ratio);
}

INSTANTIATE_TEST_SUITE_P(
    Wind, Key,
    testing::Values(Set("physics.wind.mean_m_per_s", "[1, 0, 0]", IsDraggedEast),
                    Set("physics.wind.gust_std_m_per_s", "1.0", IsGusty),
                    Set("physics.wind.gust_time_s", "3.0",
                        // Gusts with the time tau: E|g(tick + T) - g(tick)|^2 = 6 sigma^2 (1 - exp(-T/tau)).
                        ChangesAsRarely, {"physics.wind.gust_std_m_per_s=1.0"})),
    NameOf);

/// One obstacle, by default a box of 1 m at [1.2, 0, 1]; `more`: further keys.
std::string Block(const std::string& shape = "box", const std::string& place = "[1.2, 0, 1]",
                  const std::string& size = "[1, 1, 1]", const std::string& more = "") {
  return "[{ shape = '" + shape + "', position_m = " + place + ", size_m = " + size + more + " }]";
}

/// A row that sets `key` to `value` for an agent that flies along x into `obstacle`.
Row Passing(const std::string& obstacle, const std::string& key, const std::string& value, const Claim& claim) {
  return {key,
          value,
          claim,
          {"agents={ count = 2, position_m = [[0, 0.2, 1], [9, 0, 3]], velocity_m_per_s = [[3, 0, 0], [0, 0, 0]] }",
           "physics.obstacles=" + obstacle}};
}

/// A row that replaces Block() by another obstacle; `what` names the difference.
Row OtherBlock(const std::string& what, const std::string& block, const Claim& claim) {
  Row row = Passing(Block(), "physics.obstacles", block, claim);
  row.name = "physics.obstacles." + what;
  return row;
}

/// The x of the face of the box, to which the front of the agent comes, and how far the agent sinks in (m).
constexpr double kFace_m = 0.7, kSinks_m = 0.03;
double HalfLength(const Flight& flight) { return flight.airframe(1).size_m.x() / 2; }
Figure Front() {
  return [](const Flight& flight) { return FarthestX(1)(flight) + HalfLength(flight); };
}
constexpr double kPast_m = 2.0;  // an agent that nothing stops comes farther

INSTANTIATE_TEST_SUITE_P(
    Obstacles, Key,
    testing::Values(
        Passing("[]", "physics.obstacles", Block(), Becomes(Front(), kFace_m, kSinks_m)),
        OtherBlock("shape to cylinder", Block("cylinder"), Grows(Front())),
        OtherBlock("shape to sphere", Block("sphere"), Grows(Front())),
        OtherBlock("position_m", Block("box", "[1.3, 0, 1]"), Becomes(Front(), kFace_m + 0.1, kSinks_m)),
        OtherBlock("size_m", Block("box", "[1.2, 0, 1]", "[1.1, 1, 1]"), Becomes(Front(), kFace_m - 0.05, kSinks_m)),
        OtherBlock("heading_rad", Block("box", "[1.2, 0, 1]", "[1, 1, 1]", ", heading_rad = 0.1"), Shrinks(Front())),
        Passing(Block(), "physics.collisions", "false", Grows(Front(), 2))),
    NameOf);

/// At `at_s`, a rotor of an agent gives only the share `remaining` of the thrust of its commanded speed: in one tick
/// the body turns as the torque of all four rotors then has it, to within 5 %. `begins`: before that, the flights are
/// the same.
Claim Tips(int agent, int rotor, double at_s, double remaining, bool begins = true) {
  return [=](const Flight& was, const Flight& is) {
    if (begins) DiffersFrom(at_s + is.T())(was, is);
    const int tick = static_cast<int>(std::lround(at_s / is.T()));
    const Airframe& body = is.airframe(agent);
    const int axis = rotor % 2 == 1 ? 1 : 0;  // front and back: pitch; left and right: roll
    const double sign = rotor == 1 || rotor == 4 ? 1 : -1;
    const double lost_N = (1 - remaining) * is.command(agent, tick).actuator[static_cast<std::size_t>(rotor - 1)] *
                          is.command(agent, tick).actuator[static_cast<std::size_t>(rotor - 1)] * body.lift_n_s2;
    const double torque = is.ThrustAndTorque(agent, tick)[axis + 1] + sign * lost_N * body.arm_m;
    const double turned = is.at(agent, tick + 1).w_WB_B[axis] - is.at(agent, tick).w_WB_B[axis];
    const double expected = torque / body.inertia_kg_m2[axis] * is.T();
    EXPECT_NEAR(turned, expected, 0.05 * std::abs(expected));
    const double without = is.ThrustAndTorque(agent, tick)[axis + 1] / body.inertia_kg_m2[axis] * is.T();
    EXPECT_GT(std::abs(turned - without), 0.05);
  };
}

/// A row that replaces the failure of rotor 1 of agent 1 at 0.5 s by another rotor failure; `what` names the
/// difference.
Row Failing(const std::string& what, int agent, int rotor, const std::string& at_s, const Claim& claim,
            const std::string& more = "") {
  return {
      "physics.rotor_failures",
      "[{ agent = " + std::to_string(agent) + ", rotor = " + std::to_string(rotor) + ", at_s = " + at_s + more + "}]",
      claim,
      {"physics.rotor_failures=[{ agent = 1, rotor = 1, at_s = 0.5 }]"},
      "physics.rotor_failures." + what};
}

INSTANTIATE_TEST_SUITE_P(
    RotorFailures, Key,
    testing::Values(Set("physics.rotor_failures", "[{ agent = 1, rotor = 1, at_s = 0.5 }]", Tips(1, 1, 0.5, 0)),
                    Failing("agent", 2, 1, "0.5", Tips(2, 1, 0.5, 0)),
                    Failing("rotor", 1, 2, "0.5", Tips(1, 2, 0.5, 0)),
                    Failing("at_s", 1, 1, "0.6", Both(Tips(1, 1, 0.6, 0, false), DiffersFrom(0.51))),
                    Failing("remaining", 1, 1, "0.5", Tips(1, 1, 0.5, 0.5), ", remaining = 0.5")),
    NameOf);

const std::string kHeadOn =
    "agents={ count = 2, position_m = [[0, 0, 1], [1, 0, 1]], velocity_m_per_s = [[1, 0, 0], [-1, 0, 0]] }";

Figure OvertakenBy() {  // how far agent 1 has come past agent 2, at most
  return [](const Flight& flight) {
    double most = -1e9;
    for (int tick = 0; tick <= flight.ticks(); ++tick)
      most = std::max(most, flight.at(1, tick).p_WB.x() - flight.at(2, tick).p_WB.x());
    return most;
  };
}

/// Steps of h add a h to the rate of turning and then turn by it: from rest, N of them turn by a T^2 (1 + 1/N) / 2.
void MovesInSteps(const Flight& was, const Flight& is) {
  const auto turned = [](const Flight& flight) {
    const Eigen::Vector3d torque = flight.ThrustAndTorque(1, 0).tail<3>();
    const double acceleration = torque.y() / flight.airframe(1).inertia_kg_m2.y();
    const Eigen::AngleAxisd turn(flight.at(1, 1).q_WB);
    return turn.angle() * turn.axis().y() / (flight.T() * flight.T() / 2 * acceleration);
  };
  const auto steps = [](const Flight& flight) { return flight.experiment.physics.rate_hz * flight.T(); };
  for (const Flight* flight : {&was, &is}) EXPECT_NEAR(turned(*flight), 1 + 1 / steps(*flight), 0.01);
  EXPECT_EQ(steps(was), 10);
  EXPECT_EQ(steps(is), 5);
}

/// Two agents that meet head-on fly through each other, and did not before.
void PassThroughEachOther(const Flight& was, const Flight& is) {
  EXPECT_LT(OvertakenBy()(was), -0.9 * was.airframe(1).size_m.x()) << "a body's length";
  EXPECT_GT(OvertakenBy()(is), 0);
}

/// An agent that is thrown down falls below the ground, and before did not.
void FallsBelowTheGround(const Flight& was, const Flight& is) {
  EXPECT_GT(Lowest()(was), 0);
  EXPECT_LT(Lowest()(is), -0.5);
}

INSTANTIATE_TEST_SUITE_P(
    Physics, Key,
    testing::Values(
        // Steps of h add a h to the speed and then move by it: from rest, N of them go a T^2 (1 + 1/N) / 2.
        Set("physics.rate_hz", "500", MovesInSteps),
        Set("physics.gravity_m_per_s2", "3.71", Becomes(SquaredSpeeds(1), CarriesItsWeight(1), 1e-6)),
        Set("physics.collisions", "false", PassThroughEachOther, {kHeadOn}),
        Set("physics.ground", "false", FallsBelowTheGround,
            {"agents.velocity_m_per_s=[[0,0,-8],[0,0,0],[0,0,0],[0,0,0]]"})),
    NameOf);

// --- [run] and [agents] -----------------------------------------------------------------------------

/// Each agent starts at the same point of [0, 1]^3 as before, scaled to another box.
Claim StartsIn(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  return [=](const Flight& was, const Flight& is) {
    const Eigen::Vector3d low_was(-10, -10, 1), high_was(10, 10, 4);
    for (int id = 1; id <= is.agents(); ++id) {
      const Eigen::Vector3d share = (was.at(id, 0).p_WB - low_was).cwiseQuotient(high_was - low_was);
      EXPECT_LT((is.at(id, 0).p_WB - low - share.cwiseProduct(high - low)).norm(), 1e-9) << "agent " << id;
    }
  };
}

/// All agents start in this box; before, not all did.
Claim StartsWithin(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  return [=](const Flight& was, const Flight& is) {
    const auto outside = [&](const Flight& flight) {
      double most = 0;
      for (int id = 1; id <= flight.agents(); ++id)
        most = std::max(most, (low - flight.at(id, 0).p_WB).cwiseMax(flight.at(id, 0).p_WB - high).maxCoeff());
      return most;
    };
    EXPECT_GT(outside(was), 1);
    EXPECT_EQ(outside(is), 0);
  };
}

/// Starting places that another seed draws: others, in the same box.
void StartElsewhere(const Flight& was, const Flight& is) {
  for (int id = 1; id <= is.agents(); ++id) {
    EXPECT_GT((is.at(id, 0).p_WB - was.at(id, 0).p_WB).norm(), 0.1) << "agent " << id;
    EXPECT_LE((is.at(id, 0).p_WB - Eigen::Vector3d(0, 0, 2.5))
                  .cwiseQuotient(Eigen::Vector3d(10, 10, 1.5))
                  .cwiseAbs()
                  .maxCoeff(),
              1);
  }
}

/// The largest share of its velocity that an agent has sideways: 0 for a unicycle, which moves along its heading, but
/// for the turn of a tick.
double Slip(const Flight& flight, int id) {
  double most = 0;
  for (int tick = 1; tick < flight.ticks(); ++tick) {
    const Motion& self = flight.at(id, tick);
    const Eigen::Vector3d left = self.q_WB * Eigen::Vector3d::UnitY();
    most = std::max(most, std::abs(left.dot(self.v_WB)) / std::max(1e-6, self.v_WB.norm()));
  }
  return most;
}
Figure SlipOf(int id) {
  return [=](const Flight& flight) { return Slip(flight, id); };
}

/// A double integrator of 1 kg is pushed with the commanded acceleration as its force.
void IsPushed(const Flight& /*was*/, const Flight& is, int id) {
  for (int tick = 0; tick < is.ticks(); ++tick) {
    const Command& command = is.command(id, tick);
    EXPECT_NEAR(command.actuator[0], command.a_limited_W.x(), 1e-12);
    EXPECT_NEAR(command.actuator[1], command.a_limited_W.y(), 1e-12);
    EXPECT_TRUE(is.at(id, tick).q_WB.isApprox(Eigen::Quaterniond::Identity(), 1e-9));
  }
}

const Eigen::Vector3d kLow(-10, -10, 1), kHigh(10, 10, 4);

/// A longer run begins with the shorter one.
void IsTheSameAsFarAsItGoes(const Flight& was, const Flight& is) {
  for (int tick = 0; tick < was.ticks(); ++tick) EXPECT_EQ(was.Numbers(tick), is.Numbers(tick));
}

/// All agents are double integrators.
void AllArePushed(const Flight& was, const Flight& is) {
  for (int id = 1; id <= 4; ++id) IsPushed(was, is, id);
}

/// The first command, over a tick, is the first velocity: its body moves by a T T, and not half of that.
void MovesAtOnce(const Flight& was, const Flight& is) {
  for (const auto& [flight, share] : {std::pair(&was, 0.5), std::pair(&is, 1.0)})
    EXPECT_NEAR((flight->at(1, 1).p_WB - flight->at(1, 0).p_WB).x(),
                share * flight->T() * flight->T() * flight->command(1, 0).a_limited_W.x(), 1e-9);
}

/// Rotors carry a heavier body.
void IsHeavier(const Flight& was, const Flight& is) {
  EXPECT_NEAR(SquaredSpeeds(1)(is) / SquaredSpeeds(1)(was), 2.0 / was.airframe(1).mass_kg, 1e-9);
}

/// No two agents start at heights less than 6 m apart: with law.axes = "xy", heights are what counts.
void StartsFartherApart(const Flight& was, const Flight& is) {
  EXPECT_LT(NearestInHeight()(was), 6);
  EXPECT_GE(NearestInHeight()(is), 6);
}

/// Agents start on a horizontal circle, or on a sphere, of this radius about this centre.
Claim StartsAround(const Eigen::Vector3d& center_m, double radius_m, bool is_sphere = false) {
  return [=](const Flight& /*was*/, const Flight& is) {
    for (int id = 1; id <= 4; ++id) {
      const Eigen::Vector3d away_m = is.at(id, 0).p_WB - center_m;
      EXPECT_NEAR(away_m.norm(), radius_m, 1e-9);
      if (!is_sphere) {
        EXPECT_NEAR(away_m.z(), 0, 1e-9);
      }
    }
  };
}

/// Agents start on the four points of a grid with this spacing about [0, 0, 2].
Claim StartsOnGrid(double spacing_m) {
  return [=](const Flight& /*was*/, const Flight& is) {
    for (int id = 1; id <= 4; ++id) {
      EXPECT_NEAR(std::abs(is.at(id, 0).p_WB.x()), spacing_m / 2, 1e-9);
      EXPECT_NEAR(std::abs(is.at(id, 0).p_WB.y()), spacing_m / 2, 1e-9);
      EXPECT_NEAR(is.at(id, 0).p_WB.z(), 2, 1e-9);
    }
  };
}

/// Agents start at one height.
void StartsAtOneHeight(const Flight& /*was*/, const Flight& is) {
  for (int id = 1; id <= 4; ++id) EXPECT_EQ(is.at(id, 0).p_WB.z(), 1);
}

/// Agents start at rest before, and then with different horizontal velocities up to 2 m/s.
void StartsInMotion(const Flight& was, const Flight& is) {
  for (int id = 1; id <= 4; ++id) {
    EXPECT_EQ(was.at(id, 0).v_WB.norm(), 0);
    EXPECT_GT(is.at(id, 0).v_WB.norm(), 0);
    EXPECT_LE(is.at(id, 0).v_WB.norm(), 2);
    EXPECT_EQ(is.at(id, 0).v_WB.z(), 0);
    EXPECT_EQ(was.at(id, 0).p_WB, is.at(id, 0).p_WB) << "the places are drawn by themselves";
  }
  EXPECT_NE(is.at(1, 0).v_WB, is.at(2, 0).v_WB);
}

/// Agents start with different yaws.
void StartsTurned(const Flight& was, const Flight& is) {
  EXPECT_EQ(HeadingOf(1)(was), HeadingOf(2)(was));
  EXPECT_NE(HeadingOf(1)(is), HeadingOf(2)(is));
}

INSTANTIATE_TEST_SUITE_P(
    RunAndAgents, Key,
    testing::Values(
        Set("run.duration_s", "1.5", Both(Goes(Ticks(), 100, 150, 0), IsTheSameAsFarAsItGoes), {"run.duration_s=1.0"}),
        Set("run.seed", "2", StartElsewhere), Set("agents.count", "5", Goes(Agents(), 4, 5, 0)),
        Set("agents.model", "double_integrator", AllArePushed),
        Set("agents.model", "single_integrator", MovesAtOnce, {"agents.model=double_integrator"},
            "agents.model to single_integrator"),
        Set("agents.model", "unicycle", Both(Becomes(SlipOf(1), 0, 0.02), Becomes(SlipOf(2), 0, 0.02)),
            {"agents.model=single_integrator"}, "agents.model to unicycle"),
        Set("agents.airframe", "mascot_published", Steers([](Stack&) {})),
        Set("agents.airframe", "{ mass_kg = 2.0 }", IsHeavier, {}, "agents.airframe.mass_kg"),
        Set("agents.random", "{ max_m = [5, 5, 4] }", StartsIn(kLow, {5, 5, 4}), {}, "agents.random.max_m"),
        Set("agents.random", "{ min_m = [0, 0, 2] }", StartsWithin({0, 0, 2}, kHigh + Eigen::Vector3d(0, 0, 1)), {},
            "agents.random.min_m"),
        Set("agents.random", "{ min_separation_m = 6.0 }", StartsFartherApart, {}, "agents.random.min_separation_m"),
        Set("agents.random", "{ shape = 'plane' }", StartsAtOneHeight, {}, "agents.random.shape"),
        Set("agents.random", "{ shape = 'circle', radius_m = 7.0 }", StartsAround({0, 0, 2}, 7), {},
            "agents.random.radius_m"),
        Set("agents.random", "{ shape = 'circle', center_m = [1, 2, 3] }", StartsAround({1, 2, 3}, 5), {},
            "agents.random.center_m"),
        Set("agents.random", "{ shape = 'sphere' }", StartsAround({0, 0, 6}, 5, true), {},
            "agents.random.shape to sphere"),
        Set("agents.random", "{ shape = 'grid', grid_spacing_m = 3.0 }", StartsOnGrid(3), {},
            "agents.random.grid_spacing_m"),
        Set("agents.random", "{ max_speed_m_per_s = 2.0 }", StartsInMotion, {}, "agents.random.max_speed_m_per_s"),
        Set("agents.random", "{ heading = true }", StartsTurned, {}, "agents.random.heading"),
        Set("agents", "{ count = 4, starts = \"0,0,1\\n1,0,2\\n2,0,3\\n3,0,4\\n\" }",
            Both(Becomes(PlaceOf(1, 0, 0), 0, 1e-9), Becomes(PlaceOf(4, 0, 2), 4, 1e-9)), {}, "agents.starts"),
        Set("agents", "{ count = 4, position_m = [[0,0,1],[1,0,2],[2,0,3],[3,0,4]] }",
            Both(Becomes(PlaceOf(1, 0, 0), 0, 1e-9), Becomes(PlaceOf(4, 0, 2), 4, 1e-9)), {}, "agents.position_m"),
        Set("agents.velocity_m_per_s", "[[1,0,0],[0,0,0],[0,0,0],[0,0,0]]", Goes(VelocityOf(1, 0, 0), 0, 1, 1e-12)),
        Set("agents.heading_rad", "[0, 0, 1, 0]", Both(Goes(HeadingOf(3), 0, 1, 1e-9), Goes(HeadingOf(2), 0, 0, 1e-9))),
        Set("agents.heading_rad", "[0, 0, 1, 0]", Both(Goes(HeadingOf(3), 0, 1, 1e-9), Goes(SlipOf(3), 0, 0, 0.02)),
            {"agents.model=unicycle"}, "agents.heading_rad of unicycles")),
    NameOf);

// --- [law] ------------------------------------------------------------------------------------------

/// Two agents at rest, 5 m apart, with the least acceleration that law.safety takes for enough to part them: closer
/// than D, with h = -sqrt(2 (a_1 + a_2)(D - d)), each has half of -gamma h.
std::vector<std::string> Near(std::vector<std::string> more = {}) {
  more.insert(more.begin(), "agents={ count = 2, position_m = [[0, 0, 1], [5, 0, 2]] }");
  return more;
}
double Parts(double distance_m, double gamma) { return gamma / 2 * std::sqrt(2 * (3.0 + 3.0) * (distance_m - 5)); }
Claim PartsBoth(double distance_m, double gamma) {
  return Both(Becomes(CommandOf(1, 0, 0), -Parts(distance_m, gamma), 1e-9),
              Becomes(CommandOf(2, 0, 0), Parts(distance_m, gamma), 1e-9));
}
Claim PartsTheSecond(double distance_m, double gamma) {
  return Both(Goes(CommandOf(1, 0, 0), 5 * 0.045, 5 * 0.045, 1e-9),
              Becomes(CommandOf(2, 0, 0), Parts(distance_m, gamma), 1e-9));
}

/// Agent 1 flies to a waypoint, the others by the law.
void LeadsTo(const Eigen::Vector2d& waypoint, const Flight& was, const Flight& is) {
  EXPECT_LT(was.command(1, 0).a_limited_W.norm(), 1e-12) << "a leader without waypoints keeps its velocity";
  const Eigen::Vector2d way = waypoint - is.at(1, 0).p_WB.head<2>();
  EXPECT_GT(way.dot(is.command(1, 0).a_limited_W.head<2>()), 0);
  EXPECT_LT((waypoint - is.at(1, is.ticks()).p_WB.head<2>()).norm(), way.norm());
  EXPECT_LT(FarthestOff(Equation{}, is, AllBut(1)), 1e-9);
}

/// Every agent starts straight at the waypoint, as far as the limit lets it.
void FliesTo(const Eigen::Vector2d& waypoint, const Flight& is) {
  for (int id = 1; id <= is.agents(); ++id) {
    const Eigen::Vector2d way = waypoint - is.at(id, 0).p_WB.head<2>(), a = is.command(id, 0).a_limited_W.head<2>();
    EXPECT_GT(way.x() * a.x(), 0);
    EXPECT_GT(way.y() * a.y(), 0);
    EXPECT_LT((waypoint - is.at(id, is.ticks()).p_WB.head<2>()).norm(), way.norm());
  }
}

/// All agents fly to [5, 0].
void AllFlyToTheWaypoint(const Flight& /*was*/, const Flight& is) { FliesTo({5, 0}, is); }

/// All but agent 2 fly by the law.
void OthersObeyTheLaw(const Flight&, const Flight& is) { EXPECT_LT(FarthestOff(Equation{}, is, AllBut(2)), 1e-9); }

/// The leader flies to [5, 5].
void LeadsToTheCorner(const Flight& was, const Flight& is) { LeadsTo({5, 5}, was, is); }

INSTANTIATE_TEST_SUITE_P(
    Law, Key,
    testing::Values(Set("law", "{ name = \"waypoint\", waypoints_m = [[5, 0, 1]] }", AllFlyToTheWaypoint, {},
                        "law.name"),
                    Set("law.p_gain", "0.02", Obeys({.p_gain = 0.02})), Set("law.beta", "0.5", Obeys({.beta = 0.5})),
                    Set("law.v_gain", "0.5", Obeys({.v_gain = 0.5})), Set("law.axes", "xyz", Obeys({.wants_z = true})),
                    Set("law.leader", "2",
                        Both(Obeys({.p_gain = 0, .beta = 0}, [](int id, int) { return id == 2; }), OthersObeyTheLaw)),
                    Set("law.leader_waypoints_m", "[[5,5,1]]", LeadsToTheCorner, {"law.leader=1"}),
                    Set("law.safety", "{ distance_m = 5.05 }", PartsBoth(5.05, 1), Near()),
                    Set("law.safety.distance_m", "5.1", PartsBoth(5.1, 1), Near({"law.safety.distance_m=5.05"})),
                    Set("law.safety.gamma", "2.0", PartsBoth(5.05, 2), Near({"law.safety.distance_m=5.05"}))),
    NameOf);

// --- [graph] ----------------------------------------------------------------------------------------

const std::string kSwitch = "graph.schedule=[{ at_s = 0.4, topology = 'path' }]";
const Weight kAt = Then(Everyone(), 40, Path());

INSTANTIATE_TEST_SUITE_P(
    Graph, Key,
    testing::Values(
        Set("graph.topology", "path", Obeys({.weight = Path()})),
        Set("graph", "{ laplacian = [[1,-1,0,0],[0,1,-1,0],[0,0,1,-1],[-1,0,0,1]] }",
            Obeys({.weight = Matrix({{0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}, {1, 0, 0, 0}})}), {}, "graph.laplacian"),
        Set("graph", "{ adjacency = [[0,1,0,0],[0,0,2,0],[0,0,0,1],[1,0,0,0]] }",
            Obeys({.weight = Matrix({{0, 1, 0, 0}, {0, 0, 2, 0}, {0, 0, 0, 1}, {1, 0, 0, 0}})}), {}, "graph.adjacency"),
        Set("graph", "{ edges = [[1, 2], [2, 1, 0.5]] }",
            Obeys({.weight = Matrix({{0, 1, 0, 0}, {0.5, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}})}), {}, "graph.edges"),
        Set("graph.range_m", "8.0", Obeys({.weight = Within(8)})),
        Set("graph.range_m", "12.0", Obeys({.weight = Within(12)}), {"graph.range_m=8.0"},
            "graph.range_m from 8 to 12"),
        Set("graph.schedule", "[{ at_s = 0.4, topology = 'path' }]", Obeys({.weight = kAt})),
        Set("graph.schedule", "[{ at_s = 0.41, topology = 'path' }]", Obeys({.weight = Then(Everyone(), 41, Path())}),
            {kSwitch}, "graph.schedule.at_s"),
        Set("graph.schedule", "[{ at_s = 0.4, topology = 'star' }]", Obeys({.weight = Then(Everyone(), 40, Star())}),
            {kSwitch}, "graph.schedule.topology"),
        Set("graph.schedule", "[{ at_s = 0.4, edges = [[1, 2]] }]",
            Obeys({.weight = Then(Everyone(), 40, Matrix({{0, 1, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}}))}),
            {kSwitch}, "graph.schedule.edges"),
        Set("graph.schedule", "[{ at_s = 0.4, topology = 'path' }, { at_s = 0.6, topology = 'star' }]",
            Obeys({.weight = Then(kAt, 60, Star())}), {kSwitch}, "graph.schedule of two switches"),
        Set("graph.repeat_s", "0.8", Obeys({.weight = Then(kAt, 80, Everyone())}), {kSwitch})),
    NameOf);

/// The edges (i, j) of one tick, where agent i hears agent j with weight 1: for each i the only set of others whose
/// pull is its command.
using Edges = std::set<std::pair<int, int>>;

Edges HeardAt(const Flight& flight, int tick) {
  Edges edges;
  for (int i = 1; i <= flight.agents(); ++i) {
    int found = 0;
    unsigned heard = 0;
    for (unsigned set = 0; set < 1u << flight.agents(); ++set) {
      Equation law{.limit = 100};
      law.weight = [set](const Flight&, int, int j, int) { return (set >> (j - 1) & 1u) != 0 ? 1.0 : 0.0; };
      if ((set >> (i - 1) & 1u) != 0) continue;  // not itself
      if ((Wanted(law, flight, i, tick) - flight.command(i, tick).a_limited_W).norm() > 1e-9) continue;
      heard = set;
      ++found;
    }
    EXPECT_EQ(found, 1) << "agent " << i;
    for (int j = 1; j <= flight.agents(); ++j)
      if ((heard >> (j - 1) & 1u) != 0) edges.emplace(i, j);
  }
  return edges;
}

Edges WithinRange(const Flight& flight, double range_m) {
  Edges edges;
  for (int i = 1; i <= flight.agents(); ++i)
    for (int j = 1; j <= flight.agents(); ++j)
      if (Within(range_m)(flight, i, j, 0) > 0) edges.emplace(i, j);
  return edges;
}

/// A ring in which each of n agents hears its k nearest.
Edges Lattice(int n, int k) {
  Edges edges;
  for (int i = 0; i < n; ++i)
    for (int off = 1; off <= k / 2; ++off)
      for (const int j : {(i + off) % n, (i + n - off) % n}) edges.emplace(i + 1, j + 1);
  return edges;
}

std::size_t Common(const Edges& a, const Edges& b) {
  return static_cast<std::size_t>(std::ranges::count_if(a, [&](const auto& edge) { return b.contains(edge); }));
}

bool IsMutual(const Edges& edges) {
  return std::ranges::all_of(edges, [&](const auto& edge) { return edges.contains({edge.second, edge.first}); });
}

/// A row that replaces the random graph `was` by `is`; `what` names the difference.
Row OtherRandomGraph(const std::string& what, const std::string& was, const std::string& is, const Claim& claim) {
  return {"graph",
          "{ random = { " + is + " } }",
          claim,
          {"agents={ count = 8 }", "graph={ random = { " + was + " } }", "control.max_acceleration_m_per_s2=100.0",
           "run.duration_s=0.01"},
          "graph.random." + what};
}

/// Calls `look` with the edges at tick 0 of both flights.
Claim Hears(const std::function<void(const Edges& was, const Edges& is)>& look) {
  return [=](const Flight& was, const Flight& is) { look(HeardAt(was, 0), HeardAt(is, 0)); };
}

/// From 0.4 s on, the edges are drawn: some of all pairs, both ways, the same at all ticks.
void IsDrawnFromThen(const Flight& was, const Flight& is) {
  EXPECT_EQ(HeardAt(is, 39).size(), 12u);
  const Edges drawn = HeardAt(is, 40);
  EXPECT_NE(drawn, HeardAt(was, 40)) << "a path";
  EXPECT_LT(drawn.size(), 12u);
  EXPECT_TRUE(IsMutual(drawn));
  EXPECT_EQ(HeardAt(is, 80), drawn);
}

INSTANTIATE_TEST_SUITE_P(RandomGraphs, Key,
                         testing::Values(Set("graph.schedule",
                                             "[{ at_s = 0.4, random = { kind = 'erdos_renyi', p = 0.3 } }]",
                                             IsDrawnFromThen, {kSwitch}, "graph.schedule.random"),
                                         Set("graph", "{ random = { kind = \"erdos_renyi\", p = 0.1 } }",
                                             Hears([](const Edges& was, const Edges& is) {
                                               EXPECT_EQ(was.size(), 12u);
                                               EXPECT_LE(is.size(), 6u);
                                               EXPECT_TRUE(IsMutual(is));
                                             }),
                                             {}, "graph.random"),
                                         Set("graph.random.p", "0.9", Hears([](const Edges& was, const Edges& is) {
                                               EXPECT_LE(was.size(), 6u);
                                               EXPECT_GE(is.size(), 8u);
                                             }),
                                             {"graph={ random = { kind = \"erdos_renyi\", p = 0.1 } }"})),
                         NameOf);

INSTANTIATE_TEST_SUITE_P(
    RandomGraphsOfEight, Key,
    testing::Values(
        OtherRandomGraph("kind to small_world", "kind = 'erdos_renyi', p = 0.4", "kind = 'small_world', k = 2, p = 0.4",
                         Hears([](const Edges& was, const Edges& is) {
                           EXPECT_NE(was.size(), 16u);
                           EXPECT_EQ(is.size(), 16u) << "as many as in a ring";
                           EXPECT_TRUE(IsMutual(is));
                         })),
        OtherRandomGraph("kind to geometric", "kind = 'erdos_renyi', p = 0.4", "kind = 'geometric', radius_m = 8.0",
                         [](const Flight& was, const Flight& is) {
                           EXPECT_NE(HeardAt(was, 0), WithinRange(was, 8));
                           EXPECT_EQ(HeardAt(is, 0), WithinRange(is, 8));
                         }),
        OtherRandomGraph("radius_m", "kind = 'geometric', radius_m = 8.0", "kind = 'geometric', radius_m = 12.0",
                         [](const Flight& was, const Flight& is) {
                           EXPECT_EQ(HeardAt(was, 0), WithinRange(was, 8));
                           EXPECT_EQ(HeardAt(is, 0), WithinRange(is, 12));
                           EXPECT_NE(WithinRange(is, 8), WithinRange(is, 12));
                         }),
        OtherRandomGraph("k", "kind = 'small_world', k = 2, p = 0.0", "kind = 'small_world', k = 4, p = 0.0",
                         Hears([](const Edges& was, const Edges& is) {
                           EXPECT_EQ(was, Lattice(8, 2));
                           EXPECT_EQ(is, Lattice(8, 4));
                         })),
        OtherRandomGraph("p", "kind = 'small_world', k = 2, p = 0.0", "kind = 'small_world', k = 2, p = 0.9",
                         Hears([](const Edges& was, const Edges& is) {
                           EXPECT_EQ(was, Lattice(8, 2));
                           EXPECT_EQ(is.size(), was.size());
                           EXPECT_LT(Common(is, was), 8u) << "of 16, 0.9 are led elsewhere";
                         }))),
    NameOf);

// --- [link] -----------------------------------------------------------------------------------------

/// Two agents that hear each other, for `duration_s`.
std::vector<std::string> Two(const std::string& duration_s, std::vector<std::string> more = {}) {
  std::vector<std::string> sets = {
      "agents={ count = 2, position_m = [[0, 0, 1], [5, 0, 2]], velocity_m_per_s = [[0, 1, 0], [0, -1, 0]] }",
      "run.duration_s=" + duration_s};
  sets.insert(sets.end(), more.begin(), more.end());
  return sets;
}

constexpr int kNothing = -1;  // in place of an age

/// Age (ticks) of the sample of the other one of two agents that agent `id` uses at a tick, as its command shows;
/// kNothing: it uses none.
int AgeAt(const Flight& flight, int id, int tick) {
  for (int age = 0; age <= std::min(tick, 40); ++age) {
    Equation law;
    law.delay = [age](int, int) { return age; };
    if ((Wanted(law, flight, id, tick) - flight.command(id, tick).a_limited_W).norm() < 1e-9) return age;
  }
  const Equation alone{.p_gain = 0};
  EXPECT_LT((Wanted(alone, flight, id, tick) - flight.command(id, tick).a_limited_W).norm(), 1e-9);
  return kNothing;
}

std::vector<int> AgesOf(const Flight& flight, int id) {
  std::vector<int> ages;
  for (int tick = 0; tick < flight.ticks(); ++tick) ages.push_back(AgeAt(flight, id, tick));
  return ages;
}

/// Share of the samples used by both agents whose age (ticks) is in [least, most].
double ShareOf(const Flight& flight, int least, int most) {
  double count = 0;
  for (const int id : {1, 2})
    for (const int age : AgesOf(flight, id)) count += age >= least && age <= most ? 1 : 0;
  return count / (2.0 * flight.ticks());
}

Figure Lost() {
  return [](const Flight& flight) { return ShareOf(flight, kNothing, kNothing); };
}
Figure Aged(int least, int most) {
  return [=](const Flight& flight) { return ShareOf(flight, least, most); };
}
/// Share of the ticks at which just one of both agents hears the other.
Figure OneSided() {
  return [](const Flight& flight) {
    const std::vector<int> one = AgesOf(flight, 1), two = AgesOf(flight, 2);
    double count = 0;
    for (std::size_t tick = 0; tick < one.size(); ++tick)
      count += (one[tick] == kNothing) != (two[tick] == kNothing) ? 1 : 0;
    return count / static_cast<double>(one.size());
  };
}

/// From tick `from` on, the samples that agent `id` uses are `age` ticks old.
Claim HasAge(int id, int age, int from = 0) {
  return [=](const Flight&, const Flight& is) {
    for (int tick = from; tick < is.ticks(); ++tick)
      EXPECT_EQ(AgeAt(is, id, tick), age) << "agent " << id << ", tick " << tick;
  };
}

// 1000 ticks of two links have 2000 draws: the standard deviation of a share of 0.3 is 0.01, and of those of bursts,
// half of which last from one tick to the next, 0.02.
constexpr double kOfShare = 0.05, kOfBursts = 0.08;
const std::string kBursts = "link.gilbert_elliott={ good_to_bad = 0.2, bad_to_good = 0.3 }";

/// Samples come 2 to 8 ticks late, and not 5.
void Jitters(const Flight& was, const Flight& is) {
  EXPECT_NEAR(Aged(5, 5)(was), 1 - 0.05, 1e-9) << "nothing comes in the first five ticks";
  for (const auto& [least, most] : {std::pair(2, 4), std::pair(5, 8)}) EXPECT_GT(Aged(least, most)(is), 0.1);
  EXPECT_NEAR(Aged(2, 8)(is) + Lost()(is), 1, 1e-9) << "where two come at once, there is none at another tick";
}

/// Some samples come at once, and overtake others.
void Overtakes(const Flight& was, const Flight& is) {
  EXPECT_EQ(Aged(0, 0)(was), 0);
  EXPECT_NEAR(Aged(0, 0)(is), 0.3, kOfShare) << "those that come at once";
  EXPECT_NEAR(Aged(0, 0)(is) + Aged(5, 5)(is) + Lost()(is), 1, 1e-9);
}

/// As many samples are lost as before, but others.
void LosesOthers(const Flight& was, const Flight& is) {
  EXPECT_NE(AgesOf(was, 1), AgesOf(is, 1)) << "others are lost";
  Goes(Lost(), 0.3, 0.3, kOfShare)(was, is);
}

INSTANTIATE_TEST_SUITE_P(
    Link, Key,
    testing::Values(
        Set("link.loss", "0.3", Goes(Lost(), 0, 0.3, kOfShare), Two("10.0")),
        Set("link.delay_s", "0.05", Both(HasAge(1, 5, 5), HasAge(2, 5, 5)), Two("1.0")),
        Set("link.jitter_s", "0.03", Jitters, Two("1.0", {"link.delay_s=0.05"})),
        Set("link.reordering", "0.3", Overtakes, Two("10.0", {"link.delay_s=0.05"})),
        Set("link.symmetric", "true",
            Both(Goes(OneSided(), 2 * 0.3 * 0.7, 0, kOfShare), Goes(Lost(), 0.3, 0.3, kOfShare)),
            Two("10.0", {"link.loss=0.3"})),
        Set("link.hold_s", "0.1", Both(Goes(Lost(), 0.3, 0, 0.04), Goes(Aged(1, 10), 0, 0.3, kOfShare)),
            Two("10.0", {"link.loss=0.3"})),
        Set("link.gilbert_elliott", "{ good_to_bad = 0.2, bad_to_good = 0.3 }", Goes(Lost(), 0, 0.2 / 0.5, kOfBursts),
            Two("10.0")),
        Set("link.gilbert_elliott.good_to_bad", "0.4", Becomes(Lost(), 0.4 / 0.7, kOfBursts), Two("10.0", {kBursts})),
        Set("link.gilbert_elliott.bad_to_good", "0.6", Becomes(Lost(), 0.2 / 0.8, kOfBursts), Two("10.0", {kBursts})),
        Set("link.gilbert_elliott.loss_good", "0.2", Becomes(Lost(), 0.4 + 0.6 * 0.2, kOfBursts),
            Two("10.0", {kBursts})),
        Set("link.gilbert_elliott.loss_bad", "0.8", Goes(Lost(), 0.4, 0.4 * 0.8, kOfBursts), Two("10.0", {kBursts})),
        Set("run.seed", "2", LosesOthers, Two("10.0", {"link.loss=0.3"}), "run.seed with losses")),
    NameOf);

/// A row that replaces the link override that delays what agent 1 hears of agent 2 by another one; `what` names the
/// difference.
Row OtherLinks(const std::string& what, const std::string& value, const Claim& claim) {
  return {"link.override", "[{ " + value + " }]", claim,
          Two("10.0", {"link.override=[{ edges = [[1, 2]], delay_s = 0.05 }]"}), "link.override." + what};
}

/// Calls `look` with the ages (ticks) of what agent 1 hears; agent 2 hears everything at once.
Claim FirstHears(const std::function<void(const std::vector<int>& ages)>& look) {
  return [=](const Flight&, const Flight& is) {
    look(AgesOf(is, 1));
    HasAge(2, 0)(is, is);
  };
}
double ShareIn(const std::vector<int>& ages, int least, int most) {
  const auto in = [&](int age) { return age >= least && age <= most; };
  return static_cast<double>(std::ranges::count_if(ages, in)) / static_cast<double>(ages.size());
}

/// Agent 1 keeps what it has heard; agent 2 does not.
void IsHeldByOne(const Flight&, const Flight& is) {
  EXPECT_NEAR(ShareIn(AgesOf(is, 1), 1, 10), 0.3, kOfShare);
  EXPECT_NEAR(ShareIn(AgesOf(is, 2), kNothing, kNothing), 0.3, kOfShare);
}

INSTANTIATE_TEST_SUITE_P(
    LinkOverride, Key,
    testing::Values(
        Set("link.override", "[{ edges = [[1, 2]], delay_s = 0.05 }]", Both(HasAge(1, 5, 5), HasAge(2, 0)), Two("1.0")),
        OtherLinks("edges turned round", "edges = [[2, 1]], delay_s = 0.05", Both(HasAge(1, 0), HasAge(2, 5, 5))),
        OtherLinks("edges both ways", "edges = [[1, 2], [2, 1]], delay_s = 0.05",
                   Both(HasAge(1, 5, 5), HasAge(2, 5, 5))),
        OtherLinks("delay_s", "edges = [[1, 2]], delay_s = 0.06", Both(HasAge(1, 6, 6), HasAge(2, 0))),
        OtherLinks("loss", "edges = [[1, 2]], delay_s = 0.05, loss = 0.3", FirstHears([](const std::vector<int>& ages) {
                     EXPECT_NEAR(ShareIn(ages, kNothing, kNothing), 0.3, kOfShare);
                     EXPECT_NEAR(ShareIn(ages, 5, 5), 0.7, kOfShare);
                   })),
        OtherLinks("jitter_s", "edges = [[1, 2]], delay_s = 0.05, jitter_s = 0.03",
                   FirstHears([](const std::vector<int>& ages) {
                     for (const auto& [least, most] : {std::pair(2, 4), std::pair(5, 8)})
                       EXPECT_GT(ShareIn(ages, least, most), 0.1);
                     EXPECT_EQ(ShareIn(ages, 0, 1) + ShareIn(ages, 9, 100), 0);
                   })),
        OtherLinks("reordering", "edges = [[1, 2]], delay_s = 0.05, reordering = 0.3",
                   FirstHears([](const std::vector<int>& ages) { EXPECT_NEAR(ShareIn(ages, 0, 0), 0.3, kOfShare); })),
        OtherLinks("gilbert_elliott",
                   "edges = [[1, 2]], delay_s = 0.05, gilbert_elliott = { good_to_bad = 0.2, bad_to_good = 0.3 }",
                   FirstHears([](const std::vector<int>& ages) {
                     EXPECT_NEAR(ShareIn(ages, kNothing, kNothing), 0.4, kOfBursts);
                   })),
        Set("link.override", "[{ edges = [[1, 2]], hold_s = 0.1 }]", IsHeldByOne, Two("10.0", {"link.loss=0.3"}),
            "link.override.hold_s"),
        Set("link.override", "[{ edges = [[2, 1]], symmetric = true }]", Goes(OneSided(), 2 * 0.3 * 0.7, 0, kOfShare),
            Two("10.0", {"link.loss=0.3"}), "link.override.symmetric")),
    NameOf);

// --- [sensors] --------------------------------------------------------------------------------------

/// By how much the commands of an agent differ from those that `law` gives for the true motions, along x and y, for
/// each tick (m/s^2).
std::vector<Eigen::Vector2d> Errors(const Flight& flight, int id, const Equation& law) {
  std::vector<Eigen::Vector2d> errors;
  for (int tick = 0; tick < flight.ticks(); ++tick)
    errors.push_back((flight.command(id, tick).a_limited_W - Wanted(law, flight, id, tick)).head<2>());
  return errors;
}

/// The errors of two agents' commands, over a minute, have the standard deviation `std` (m/s^2) on each axis, and are
/// independent from tick to tick: to within 5 %, five standard deviations of the estimate.
Claim Errs(double std, const Equation& law = {}) {
  return [=](const Flight& was, const Flight& is) {
    EXPECT_LT(FarthestOff(law, was, Always), 1e-9);
    double squares = 0, products = 0;
    for (const int id : {1, 2}) {
      const std::vector<Eigen::Vector2d> errors = Errors(is, id, law);
      for (std::size_t tick = 0; tick < errors.size(); ++tick) {
        squares += errors[tick].squaredNorm() / (4.0 * is.ticks());
        if (tick > 0) products += errors[tick].dot(errors[tick - 1]) / (4.0 * is.ticks());
      }
    }
    EXPECT_NEAR(std::sqrt(squares), std, 0.05 * std);
    EXPECT_NEAR(products, 0, 0.1 * std * std);
  };
}

/// The error of the commands of an agent is the same at all ticks, and another one for each agent; it is drawn with the
/// standard deviation `std` (m/s^2).
Claim IsBiased(double std, const Equation& law = {}) {
  return [=](const Flight& was, const Flight& is) {
    EXPECT_LT(FarthestOff(law, was, Always), 1e-9);
    for (const int id : {1, 2}) {
      const std::vector<Eigen::Vector2d> errors = Errors(is, id, law);
      for (const Eigen::Vector2d& error : errors) EXPECT_LT((error - errors[0]).norm(), 1e-9);
      EXPECT_GT(errors[0].norm(), 0.05 * std);
      EXPECT_LT(errors[0].norm(), 4 * std);
    }
    EXPECT_NE(Errors(is, 1, law)[0], Errors(is, 2, law)[0]);
  };
}

const Equation kMatches{.v_gain = 0.5};
const std::string kCountsRanges =
    "law={ name = 'custom', python = \"def control(tick, me, neighbours): return len(me.ranges), 0\" }";

/// The command of each agent along x is the number of obstacles that its range sensor sees: none before.
void CountsWhatIsInRange(const Flight& was, const Flight& is) {
  double seen = 0;
  for (int id = 1; id <= 4; ++id) {
    const Eigen::Vector3d away = (is.at(id, 0).p_WB - Eigen::Vector3d(1.2, 0, 1)).cwiseAbs();
    const double distance_m = (away.array() - 0.5).max(0).matrix().norm();
    EXPECT_EQ(CommandOf(id, 0, 0)(was), 0) << "nobody has a sensor";
    EXPECT_EQ(CommandOf(id, 0, 0)(is), distance_m <= 5 ? 1 : 0) << distance_m << " m";
    seen += CommandOf(id, 0, 0)(is);
  }
  EXPECT_THAT(seen, testing::AllOf(testing::Gt(0), testing::Lt(4)));
}

/// Agents start at the same places, and their commands have other errors.
void ErrsOtherwise(const Flight& was, const Flight& is) {
  EXPECT_NE(Errors(was, 1, {})[0], Errors(is, 1, {})[0]);
  EXPECT_EQ(was.at(1, 0).p_WB, is.at(1, 0).p_WB);
}

INSTANTIATE_TEST_SUITE_P(
    Sensors, Key,
    testing::Values(
        Set("sensors.own.position_std_m", "0.1", Errs(0.045 * 0.1), Two("30.0")),
        Set("sensors.own.velocity_std_m_per_s", "0.1", Errs(0.9 * 0.1), Two("30.0")),
        Set("sensors.own.position_bias_std_m", "0.1", IsBiased(0.045 * 0.1), Two("1.0")),
        Set("sensors.own.velocity_bias_std_m_per_s", "0.1", IsBiased(0.9 * 0.1), Two("1.0")),
        Set("sensors.heard.position_std_m", "0.1", Errs(0.045 * 0.1), Two("30.0")),
        Set("sensors.heard.velocity_std_m_per_s", "0.1", Errs(0.5 * 0.1, kMatches), Two("30.0", {"law.v_gain=0.5"})),
        Set("sensors.heard.position_bias_std_m", "0.1", IsBiased(0.045 * 0.1), Two("1.0")),
        Set("sensors.heard.velocity_bias_std_m_per_s", "0.1", IsBiased(0.5 * 0.1, kMatches),
            Two("1.0", {"law.v_gain=0.5"})),
        Set("sensors.own.delay_s", "0.05", Obeys({.own_delay = 5})),
        Set("sensors.range_m", "5.0", CountsWhatIsInRange, {"physics.obstacles=" + Block(), kCountsRanges}),
        Set("run.seed", "2", ErrsOtherwise, Two("1.0", {"sensors.own.position_std_m=0.1"}), "run.seed with noise")),
    NameOf);

// --- [control] --------------------------------------------------------------------------------------

/// Agents of `model` under a law that wants velocities.
std::vector<std::string> DrivenByVelocity(const std::string& model) {
  return {"agents.model=" + model, "law={ name = 'velocity_consensus' }"};
}

/// What velocity_consensus wants: u_i = sum_j (p_j - p_i), no faster than `limit` on each axis.
Eigen::Vector3d WantedVelocity(const Flight& flight, int id, int tick, double limit) {
  return Wanted({.p_gain = 1, .beta = 0, .limit = limit}, flight, id, tick);
}

constexpr double kAnySpeed = 100;  // the limit unless another is given

double LimitOf(const Flight& flight) { return flight.experiment.agent(2).control.max_speed_m_per_s; }

/// Single integrators get the velocity that is wanted, within the limit.
Claim FliesAt(double limit, int agent = 0) {
  return [=](const Flight& was, const Flight& is) {
    ForAll(is, [&](int id, int tick) {
      const double most = agent == 0 || id == agent ? limit : LimitOf(was);
      for (const int axis : {0, 1})
        EXPECT_NEAR(is.command(id, tick).actuator[static_cast<std::size_t>(axis)],
                    WantedVelocity(is, id, tick, most)[axis], 1e-9);
    });
    EXPECT_GT(std::abs(ActuatorOf(2, 0, 0)(was)), limit);
  };
}

/// Bodies that are driven by acceleration get velocity_gain (u - v), within the limit of acceleration.
Claim SpeedsUp(double velocity_gain, double limit, int agent = 0) {
  return [=](const Flight& was, const Flight& is) {
    double before = 0;
    ForAll(is, [&](int id, int tick) {
      const bool is_changed = agent == 0 || id == agent;
      const auto wanted = [&](const Flight& flight, double gain, double speed) {
        Eigen::Vector3d a_W = gain * (WantedVelocity(flight, id, tick, speed) - flight.at(id, tick).v_WB);
        a_W.z() = 0;
        return a_W.cwiseMin(3).cwiseMax(-3).eval();
      };
      const auto& control = was.experiment.agent(id).control;
      const double gain = is_changed ? velocity_gain : control.velocity_gain;
      const double speed = is_changed ? limit : control.max_speed_m_per_s;
      EXPECT_LT((is.command(id, tick).a_limited_W - wanted(is, gain, speed)).norm(), 1e-9);
      if (is_changed) before = std::max(before, (was.command(id, tick).a_limited_W - wanted(was, gain, speed)).norm());
    });
    EXPECT_GT(before, 1e-3);
  };
}

/// Unicycles turn at (u_y cos theta - u_x sin theta) / l.
Claim Turns(double look_ahead_m, int agent = 0) {
  return [=](const Flight& was, const Flight& is) {
    const auto rate = [](const Flight& flight, int id, int tick, double l) {
      const Eigen::Vector3d u = WantedVelocity(flight, id, tick, LimitOf(flight)),
                            left = flight.at(id, tick).q_WB * Eigen::Vector3d::UnitY();
      return u.dot(left) / l;
    };
    ForAll(is, [&](int id, int tick) {
      const double l = agent == 0 || id == agent ? look_ahead_m : was.experiment.agent(id).control.look_ahead_m;
      EXPECT_NEAR(is.command(id, tick).actuator[1], rate(is, id, tick, l),
                  1e-6 + 1e-6 * std::abs(rate(is, id, tick, l)));
    });
    EXPECT_GT(std::abs(was.command(2, 0).actuator[1] - rate(was, 2, 0, look_ahead_m)), 0.1);
  };
}

const std::string kClimbs = "agents.velocity_m_per_s=[[0,0,1],[0,0,0],[0,0,0],[0,0,0]]";
const std::string kHeads = "control.heading_rad=0.5";
constexpr PdGains kAttitude{50, 10}, kPosition{2, 2}, kSoft{1, 1};

/// All components of velocities are cut at 0.05 m/s.
void IsCutTo5cmPerS(const Flight& was, const Flight& is) {
  const auto fastest = [](const Flight& flight) {
    double speed = 0;
    ForAll(flight, [&](int id, int tick) {
      for (const std::size_t axis : {0u, 1u})
        speed = std::max(speed, std::abs(flight.command(id, tick).actuator[axis]));
    });
    return speed;
  };
  EXPECT_GT(fastest(was), 0.5);
  EXPECT_EQ(fastest(is), 0.05);
}

INSTANTIATE_TEST_SUITE_P(
    Control, Key,
    testing::Values(
        Set("control.rate_hz", "50",
            Both(Goes(Ticks(), 100, 50, 0), Goes([](const Flight& flight) { return flight.T(); }, 0.01, 0.02, 1e-12))),
        Set("control.max_acceleration_m_per_s2", "0.5",
            Both(Obeys({.limit = 0.5}), Becomes(LargestCommand(), 0.5, 1e-9))),
        Set("control.tilt_limit_rad", "0.01", Steers([](Stack& stack) { stack.tilt_limit_rad = 0.01; })),
        Set("control.inversion", "exact", Steers([](Stack& stack) { stack.exact = true; })),
        Set("control.drag_compensation", "false", Steers([](Stack& stack) { stack.compensates_drag = false; })),
        Set("control.heading_rad", "0.5", Steers([](Stack& stack) { stack.heading_rad = 0.5; })),
        Set("control.altitude", "{ kp = 1.0, kd = 1.0 }", Steers([](Stack& stack) { stack.altitude = kSoft; }),
            {kClimbs}),
        Set("control.altitude.kp", "2.0", Steers([](Stack& stack) {
              stack.altitude = {2, 1};
            }),
            {"control.altitude={ kp = 1.0, kd = 1.0 }", kClimbs}),
        Set("control.altitude.kd", "2.0", Steers([](Stack& stack) {
              stack.altitude = {1, 2};
            }),
            {"control.altitude={ kp = 1.0, kd = 1.0 }", kClimbs}),
        Set("control.heading", "{ kp = 1.0, kd = 1.0 }",
            Steers([](Stack& stack) { stack.heading = kSoft, stack.heading_rad = 0.5; }), {kHeads}),
        Set("control.heading.kp", "2.0", Steers([](Stack& stack) {
              stack.heading = {2, 1}, stack.heading_rad = 0.5;
            }),
            {"control.heading={ kp = 1.0, kd = 1.0 }", kHeads}),
        Set("control.heading.kd", "2.0", Steers([](Stack& stack) {
              stack.heading = {1, 2}, stack.heading_rad = 0.5;
            }),
            {"control.heading={ kp = 1.0, kd = 1.0 }", kHeads}),
        Set("control.attitude", "{ kp = 50.0, kd = 10.0 }", Steers([](Stack& stack) { stack.attitude = kAttitude; })),
        Set("control.attitude.kp", "60.0", Steers([](Stack& stack) {
              stack.attitude = {60, 10};
            }),
            {"control.attitude={ kp = 50.0, kd = 10.0 }"}),
        Set("control.attitude.kd", "11.0", Steers([](Stack& stack) {
              stack.attitude = {50, 11};
            }),
            {"control.attitude={ kp = 50.0, kd = 10.0 }"}),
        Set("control.position", "{ kp = 2.0, kd = 2.0 }", Steers([](Stack& stack) { stack.position = kPosition; })),
        Set("control.position.kp", "1.0", Steers([](Stack& stack) {
              stack.position = {1, 2};
            }),
            {"control.position={ kp = 2.0, kd = 2.0 }"}),
        Set("control.position.kd", "1.0", Steers([](Stack& stack) {
              stack.position = {2, 1};
            }),
            {"control.position={ kp = 2.0, kd = 2.0 }"}),
        Set("control.max_speed_m_per_s", "0.5", FliesAt(0.5), DrivenByVelocity("single_integrator"),
            "control.max_speed_m_per_s of single_integrator with velocity_consensus"),
        Set("control.max_speed_m_per_s", "0.5", SpeedsUp(2, 0.5), DrivenByVelocity("quadrotor"),
            "control.max_speed_m_per_s of quadrotor with velocity_consensus"),
        Set("control.max_speed_m_per_s", "0.05", IsCutTo5cmPerS, {"agents.model=single_integrator"},
            "control.max_speed_m_per_s of single_integrator with consensus"),
        Set("control.velocity_gain", "0.1", SpeedsUp(0.1, kAnySpeed), DrivenByVelocity("double_integrator")),
        Set("control.look_ahead_m", "0.2", Turns(0.2), DrivenByVelocity("unicycle"))),
    NameOf);

// --- [[agents.override]] ----------------------------------------------------------------------------

/// A row that sets `key` to `value` for agent 2 alone.
Row Overridden(const std::string& key, const std::string& value, const Claim& claim,
               std::vector<std::string> base = {}) {
  return {"agents.override", "[{ id = 2, " + key + " = " + value + " }]", claim, std::move(base),
          "agents.override." + key};
}

/// A row that replaces an override (TOML) by another; `what` names the difference.
Row OtherOverride(const std::string& what, const std::string& was, const std::string& is, const Claim& claim,
                  std::vector<std::string> base = {}) {
  base.push_back("agents.override=[{ " + was + " }]");
  return {"agents.override", "[{ " + is + " }]", claim, std::move(base), "agents.override." + what};
}

/// Commands of agent 2 are those of this equation, commands of the others those of the usual one.
Claim SecondObeys(const Equation& law) {
  return [=](const Flight& was, const Flight& is) {
    Obeys(law, [](int id, int) { return id == 2; })(was, is);
    EXPECT_LT(FarthestOff(Equation{}, is, AllBut(2)), 1e-9);
  };
}

/// While `is_off(tick)`, no agent hears agent `off`, and it hears none. It brakes then: it wants the velocity 0.
Claim IsOff(int off, const std::function<bool(int)>& is_off) {
  return [=](const Flight& was, const Flight& is) {
    const Equation law{.weight = [=](const Flight&, int i, int j, int tick) {
      return i == j || ((i == off || j == off) && is_off(tick)) ? 0.0 : 1.0;
    }};
    const auto counts = [=](int id, int tick) { return id != off || !is_off(tick); };
    Obeys(law, counts)(was, is);
    const double gain = is.experiment.agent(off).control.velocity_gain;
    for (int tick = 0; tick < is.ticks(); ++tick) {
      const Eigen::Vector3d brakes_W = (-gain * is.at(off, tick).v_WB).cwiseProduct(Eigen::Vector3d(1, 1, 0));
      if (!is_off(tick)) continue;
      EXPECT_LT((is.command(off, tick).a_limited_W - brakes_W).norm(), 1e-9) << "tick " << tick;
    }
  };
}

/// All others hear false positions of agent 2, `off_m(t_s)` (m) away from the true ones.
Claim Lies(const std::function<Eigen::Vector3d(double t_s)>& off_m) {
  Equation law;
  law.lie = [=](int j, int tick) { return j == 2 ? off_m(tick * 0.01) : Eigen::Vector3d::Zero().eval(); };
  return Obeys(law, AllBut(2));
}
Eigen::Vector3d Along(double x) { return {x, 0, 0}; }
Eigen::Vector3d Swings(double t_s, double period_s) { return Along(std::sin(2 * std::numbers::pi * t_s / period_s)); }
constexpr double kPeriod_s = 5;  // unless another is given

const std::string kLie = "id = 2, lie = { offset_m = [1.0, 0.0, 0.0]";

/// Agent 2 does not slip sideways; agents with other bodies do.
void OnlyTheSecondRolls(const Flight& was, const Flight& is) {
  EXPECT_GT(Slip(was, 2), 0.1);
  EXPECT_LT(Slip(is, 2), 0.02);
  EXPECT_GT(Slip(is, 1), 0.1);
}

/// Agent 2 is moved by a force, the others by rotors.
void OnlyTheSecondIsPushed(const Flight& was, const Flight& is) {
  IsPushed(was, is, 2);
  EXPECT_GT(ActuatorOf(1, 0, 0)(is), 100) << "the others have rotors";
}

/// Agent 2 goes for the velocity that velocity_consensus wants; the others fly by their law.
void OnlyTheSecondWantsAVelocity(const Flight& /*was*/, const Flight& is) {
  const double gain = is.experiment.agent(2).control.velocity_gain;
  for (int tick = 0; tick < is.ticks(); ++tick) {
    Eigen::Vector3d a_W = gain * (WantedVelocity(is, 2, tick, LimitOf(is)) - is.at(2, tick).v_WB);
    a_W.z() = 0;
    EXPECT_LT((is.command(2, tick).a_limited_W - a_W.cwiseMin(3).cwiseMax(-3)).norm(), 1e-9) << "tick " << tick;
  }
  EXPECT_LT(FarthestOff(Equation{}, is, AllBut(2)), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(
    AgentsOverride, Key,
    testing::Values(
        Overridden("start_s", "0.5", IsOff(2, [](int tick) { return tick < 50; })),
        OtherOverride("start_s from 0.5 to 0.6", "id = 2, start_s = 0.5", "id = 2, start_s = 0.6",
                      IsOff(2, [](int tick) { return tick < 60; })),
        Overridden("stop_s", "0.5", IsOff(2, [](int tick) { return tick >= 50; })),
        OtherOverride("stop_s from 0.5 to 0.6", "id = 2, stop_s = 0.5", "id = 2, stop_s = 0.6",
                      IsOff(2, [](int tick) { return tick >= 60; })),
        OtherOverride("id", "id = 2, stop_s = 0.5", "id = 3, stop_s = 0.5",
                      IsOff(3, [](int tick) { return tick >= 50; })),
        Overridden("lie", "{ offset_m = [1.0, 0.0, 0.0] }", Lies([](double) { return Along(1); })),
        OtherOverride("lie.offset_m", kLie + " }", "id = 2, lie = { offset_m = [2.0, 0.0, 0.0] }",
                      Lies([](double) { return Along(2); })),
        OtherOverride("lie.from_s", kLie + " }", kLie + ", from_s = 0.5 }",
                      Lies([](double t_s) { return Along(t_s > 0.495 ? 1 : 0); })),
        OtherOverride("lie.kind", kLie + " }", kLie + ", kind = 'oscillating' }",
                      Lies([](double t_s) { return Swings(t_s, kPeriod_s); })),
        OtherOverride("lie.period_s", kLie + ", kind = 'oscillating' }",
                      kLie + ", kind = 'oscillating', period_s = 1.0 }",
                      Lies([](double t_s) { return Swings(t_s, 1); })),
        Overridden("model", "\"unicycle\"", OnlyTheSecondRolls),
        Set("agents.override", "[{ id = 2, model = \"double_integrator\" }]", OnlyTheSecondIsPushed, {},
            "agents.override.model to double_integrator"),
        Overridden("airframe", "\"crazyflie\"",
                   Both(Becomes(SquaredSpeeds(2), CarriesItsWeight(2), 1),
                        [](const Flight& was, const Flight& is) {
                          EXPECT_EQ(SquaredSpeeds(1)(is), SquaredSpeeds(1)(was));
                        })),
        Overridden("law.p_gain", "0.1", SecondObeys({.p_gain = 0.1})),
        Overridden("law.axes", "'xyz'", SecondObeys({.wants_z = true})),
        Overridden("law.leader", "2", SecondObeys({.p_gain = 0, .beta = 0})),
        Overridden("law.name", "'velocity_consensus'", OnlyTheSecondWantsAVelocity),
        Overridden("law.safety", "{ distance_m = 5.05 }", PartsTheSecond(5.05, 1), Near()),
        OtherOverride("law.safety.distance_m", "id = 2, law.safety.distance_m = 5.05",
                      "id = 2, law.safety.distance_m = 5.1", PartsTheSecond(5.1, 1), Near()),
        OtherOverride("law.safety.gamma", "id = 2, law.safety.distance_m = 5.05",
                      "id = 2, law.safety = { distance_m = 5.05, gamma = 2.0 }", PartsTheSecond(5.05, 2), Near()),
        Overridden("control.max_acceleration_m_per_s2", "0.3", SecondObeys({.limit = 0.3})),
        Overridden("control.tilt_limit_rad", "0.01", Steers([](Stack& stack) { stack.tilt_limit_rad = 0.01; }, 2)),
        Overridden("control.inversion", "'exact'", Steers([](Stack& stack) { stack.exact = true; }, 2)),
        Overridden("control.drag_compensation", "false",
                   Steers([](Stack& stack) { stack.compensates_drag = false; }, 2)),
        Overridden("control.heading_rad", "0.5", Steers([](Stack& stack) { stack.heading_rad = 0.5; }, 2)),
        Overridden("control.attitude", "{ kp = 50.0, kd = 10.0 }",
                   Steers([](Stack& stack) { stack.attitude = kAttitude; }, 2)),
        Overridden("control.position", "{ kp = 2.0, kd = 2.0 }",
                   Steers([](Stack& stack) { stack.position = kPosition; }, 2)),
        Overridden("control.max_speed_m_per_s", "0.5", FliesAt(0.5, 2), DrivenByVelocity("single_integrator")),
        Overridden("control.velocity_gain", "0.1", SpeedsUp(0.1, kAnySpeed, 2), DrivenByVelocity("double_integrator")),
        Overridden("control.look_ahead_m", "0.2", Turns(0.2, 2), DrivenByVelocity("unicycle"))),
    NameOf);

}  // namespace
}  // namespace mascot::test

#include "experiment/airframe.h"

#include <gmock/gmock.h>

#include <Eigen/LU>

#include "experiment/agents.h"

namespace mascot {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

const Airframe& Named(std::string_view name) {
  for (const Airframe& airframe : Airframes())
    if (airframe.name == name) return airframe;
  throw std::out_of_range(std::string(name));
}

/// Reads an airframe from the text of a file. Throws ConfigError with its mistakes.
Airframe Read(const std::string& text) {
  Section agents = Section::FromText(text, "a.toml");
  agents.Use(AgentsKeys());
  const Airframe airframe = ReadAirframe(agents, "airframe");
  agents.Done();
  agents.ThrowIfWrong();
  return airframe;
}

}  // namespace

void PrintTo(const Airframe& airframe, std::ostream* out) { *out << airframe.name; }  // used in failures and test names

namespace {

class EveryAirframe : public ::testing::TestWithParam<Airframe> {};
INSTANTIATE_TEST_SUITE_P(Airframes, EveryAirframe, ::testing::ValuesIn(Airframes().begin(), Airframes().end()),
                         [](const auto& param_info) { return param_info.param.name; });

TEST_P(EveryAirframe, HoversWithoutTorqueAtItsHoverRotorSpeed) {
  const Airframe& body = GetParam();
  const double w = body.HoverRotorSpeed(9.81);
  const Eigen::Vector4d thrust_torque = body.Allocation() * Eigen::Vector4d::Constant(w * w);
  EXPECT_NEAR(thrust_torque[0], body.mass_kg * 9.81, 1e-12 * thrust_torque[0]);
  EXPECT_NEAR(thrust_torque.tail<3>().norm(), 0, 1e-12 * thrust_torque[0]);
}

TEST_P(EveryAirframe, GivesItsMaximalThrustAtItsMaximalRotorSpeed) {
  const Airframe& body = GetParam();
  const double w = body.MaxRotorSpeed();
  EXPECT_NEAR((body.Allocation() * Eigen::Vector4d::Constant(w * w))[0], body.max_thrust_n, 1e-12 * body.max_thrust_n);
}

TEST_P(EveryAirframe, HasThrustToSpareAndAnAllocationThatCanBeInverted) {
  EXPECT_GT(GetParam().max_thrust_n, 1.5 * GetParam().mass_kg * 9.81);
  EXPECT_TRUE(GetParam().Allocation().fullPivLu().isInvertible());
}

TEST_P(EveryAirframe, HasAnInertiaThatARigidBodyOfItsMassAndArmCanHave) {
  const Eigen::Vector3d& j = GetParam().inertia_kg_m2;
  EXPECT_GE(j.sum(), 2 * j.maxCoeff());
  EXPECT_LE(j.z(), GetParam().mass_kg * GetParam().arm_m * GetParam().arm_m);
}

TEST(Airframe, TurnsAsItsRotorsSay) {
  const Eigen::Matrix4d a = Named("mascot").Allocation();
  // Columns: rotors front (+x), left (+y), back, right. Rows: thrust, roll, pitch, yaw torque.
  const auto sign = [&](int row) {
    const Eigen::Vector4d r = a.row(row).cwiseSign();
    return std::vector<double>(r.begin(), r.end());
  };
  EXPECT_THAT(sign(0), ElementsAre(1, 1, 1, 1)) << "every rotor lifts";
  EXPECT_THAT(sign(1), ElementsAre(0, 1, 0, -1)) << "the left rotor rolls the left side up";
  EXPECT_THAT(sign(2), ElementsAre(-1, 0, 1, 0)) << "the back rotor pitches the nose down";
  EXPECT_THAT(sign(3), ElementsAre(1, -1, 1, -1)) << "neighbours turn against each other";
}

TEST(Airframe, PublishedOneHasThePapersNumbers) {
  const Airframe& body = Named("mascot_published");
  EXPECT_EQ(body.mass_kg, 1.477);
  EXPECT_EQ(body.inertia_kg_m2, Eigen::Vector3d(0.1152, 0.1152, 0.218));
  EXPECT_EQ(body.max_thrust_n, 30);
  EXPECT_EQ(body.attitude.kp, 20);
  EXPECT_EQ(body.attitude.kd, 5);
  EXPECT_EQ(body.heading.kp, 2);
  EXPECT_EQ(body.heading.kd, 1);
  EXPECT_EQ(body.tilt_limit_rad, 0.1);
  EXPECT_EQ(body.position.kp, 0) << "no reference loop";
  EXPECT_EQ(body.position.kd, 0);
}

TEST(Airframe, MascotIsThePublishedBodyWithOtherGains) {
  const Airframe &mascot = Named("mascot"), &published = Named("mascot_published");
  EXPECT_EQ(mascot.mass_kg, published.mass_kg);
  EXPECT_EQ(mascot.inertia_kg_m2, published.inertia_kg_m2);
  EXPECT_EQ(mascot.Allocation(), published.Allocation());
  EXPECT_EQ(mascot.tilt_limit_rad, 0.35);
}

TEST(ReadAirframe, TakesMascotByDefaultAndOthersByName) {
  EXPECT_EQ(Read("").name, "mascot");
  EXPECT_EQ(Read("airframe = 'crazyflie'").mass_kg, 0.027);
}

TEST(ReadAirframe, TakesATableWhoseOtherKeysAreThoseOfItsBase) {
  const Airframe body =
      Read("airframe = { base = 'crazyflie', name = 'heavy', mass_kg = 0.04, attitude = { kp = 50 } }");
  EXPECT_EQ(body.name, "heavy");
  EXPECT_EQ(body.mass_kg, 0.04);
  EXPECT_EQ(body.attitude.kp, 50);
  EXPECT_EQ(body.attitude.kd, Named("crazyflie").attitude.kd);
  EXPECT_EQ(body.arm_m, Named("crazyflie").arm_m);
  EXPECT_EQ(Read("airframe = {}").mass_kg, Named("mascot").mass_kg);
}

TEST(ReadAirframe, ReadsEveryKeyOfATable) {
  const Airframe body = Read(
      "[airframe]\nmass_kg = 2\ninertia_kg_m2 = [1, 2, 3]\narm_m = 0.25\nlift_n_s2 = 1e-6\ndrag_n_m_s2 = 2e-8\n"
      "linear_drag_kg_per_s = 0.5\nmax_thrust_n = 60\nrotor_time_constant_s = 0.05\nsize_m = [0.5, 0.4, 0.3]\n"
      "tilt_limit_rad = 0.2\naltitude = { kp = 1, kd = 2 }\nheading = { kp = 3, kd = 4 }\n"
      "attitude = { kp = 5, kd = 6 }\nposition = { kp = 7, kd = 8 }\n");
  EXPECT_EQ(body.mass_kg, 2);
  EXPECT_EQ(body.inertia_kg_m2, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(body.arm_m, 0.25);
  EXPECT_EQ(body.lift_n_s2, 1e-6);
  EXPECT_EQ(body.drag_n_m_s2, 2e-8);
  EXPECT_EQ(body.linear_drag_kg_per_s, 0.5);
  EXPECT_EQ(body.max_thrust_n, 60);
  EXPECT_EQ(body.rotor_time_constant_s, 0.05);
  EXPECT_EQ(body.size_m, Eigen::Vector3d(0.5, 0.4, 0.3));
  EXPECT_EQ(body.tilt_limit_rad, 0.2);
  EXPECT_THAT((std::vector{body.altitude.kp, body.altitude.kd, body.heading.kp, body.heading.kd}),
              ElementsAre(1, 2, 3, 4));
  EXPECT_THAT((std::vector{body.attitude.kp, body.attitude.kd, body.position.kp, body.position.kd}),
              ElementsAre(5, 6, 7, 8));
}

TEST(ReadAirframe, ListsTheKnownAirframes) {
  EXPECT_THAT([] { Read("airframe = 'mascott'"); },
              ThrowsMessage<ConfigError>("a.toml:1:12: airframe: expected one of mascot, mascot_published, crazyflie, "
                                         "got 'mascott' (did you mean \"mascot\"?)"));
}

TEST(ReadAirframe, RefusesAnUnknownKey) {
  EXPECT_THAT([] { Read("airframe = { mass = 1 }"); },
              ThrowsMessage<ConfigError>("a.toml:1:14: airframe.mass: unknown key (did you mean \"mass_kg\"?)"));
}

TEST(ReadAirframe, RefusesAMassOfZero) {
  EXPECT_THAT([] { Read("airframe = { mass_kg = 0 }"); },
              ThrowsMessage<ConfigError>("a.toml:1:24: airframe.mass_kg: expected a number in (0, 10000], got 0"));
}

TEST(ReadAirframe, RefusesAnInertiaThatNoBodyHas) {
  EXPECT_THAT([] { Read("airframe = { inertia_kg_m2 = [0.1, 0.1, 0.3] }"); },
              ThrowsMessage<ConfigError>("a.toml:1:30: airframe.inertia_kg_m2: expected positive moments, each at most "
                                         "the sum of the other two, got [0.1, 0.1, 0.3]"));
  EXPECT_THAT([] { Read("airframe = { inertia_kg_m2 = [0, 0.1, 0.1] }"); },
              ThrowsMessage<ConfigError>(HasSubstr("got [0.0, 0.1, 0.1]")));
}

TEST(ReadAirframe, RefusesMomentsOfInertiaThatAreTooSmallForMassAndSize) {
  const auto refuses = [](const std::string& table, const std::string& words) {
    EXPECT_THAT([&] { Read("airframe = { base = 'crazyflie', " + table + " }"); },
                ThrowsMessage<ConfigError>("a.toml:1:" + words + ": with them a body sinks into what it lies on"));
  };
  refuses("mass_kg = 27",
          "44: airframe.mass_kg: expected moments of inertia of at least [0.00058, 0.00058, 0.00095], a twentieth of "
          "those of a solid box of 27.0 kg and [0.065, 0.065, 0.03] m, got inertia_kg_m2 = [1.657e-05, 1.666e-05, "
          "2.926e-05]");
  refuses(
      "inertia_kg_m2 = [1e-9, 1e-9, 1e-9]",
      "50: airframe.inertia_kg_m2: expected moments of inertia of at least [5.8e-07, 5.8e-07, 9.5e-07], a twentieth "
      "of those of a solid box of 0.027 kg and [0.065, 0.065, 0.03] m, got inertia_kg_m2 = [1e-09, 1e-09, 1e-09]");
  refuses("size_m = [1, 1, 0.1]",
          "43: airframe.size_m: expected moments of inertia of at least [0.00011, 0.00011, 0.00022], a twentieth of "
          "those of a solid box of 0.027 kg and [1.0, 1.0, 0.1] m, got inertia_kg_m2 = [1.657e-05, 1.666e-05, "
          "2.926e-05]");
  EXPECT_EQ(Read("airframe = { base = 'crazyflie', mass_kg = 27, inertia_kg_m2 = [0.017, 0.017, 0.029] }").mass_kg, 27);
  EXPECT_EQ(Read("airframe = { base = 'crazyflie', mass_kg = 0.6 }").mass_kg, 0.6);
}

}  // namespace
}  // namespace mascot

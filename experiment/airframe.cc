#include "experiment/airframe.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace mascot {
namespace {

// The body published with MASCOT: mass, inertia, total thrust and four of the gains are the paper's. The paper does
// not give arm, b, k, B and size; they are chosen to fit what it gives:
//  * arm: Jz = 0.218 kg m^2 needs mass at sqrt(Jz / m) = 0.38 m from the axis at least; 0.5 m puts 60 % of it into the
//    motors. It leaves 0.5 m * 7.2 N / Jx = 31 rad/s^2 of roll acceleration at hover, which bounds the attitude gains.
//  * b, k: a 10 inch propeller, 7.5 N at 790 rad/s, k / b = 0.02 m.
//  * B: 0.1 kg/s, a terminal velocity of 145 m/s in free fall and 0.7 % of the weight at 1 m/s.
//  * size: as large as the square with the rotors at its corners, so that a tilted body does not hit what its rotors
//    would miss.
// The paper prints only its roll/pitch and yaw gains; the altitude loop is ours, and position = 0 leaves the reference
// loop out, as the paper does.
Airframe Published() {
  Airframe body;
  body.mass_kg = 1.477;
  body.inertia_kg_m2 = {0.1152, 0.1152, 0.218};
  body.arm_m = 0.5;
  body.lift_n_s2 = 1.2e-5;
  body.drag_n_m_s2 = 2.4e-7;
  body.linear_drag_kg_per_s = 0.1;
  body.max_thrust_n = 30;
  body.rotor_time_constant_s = 0;
  body.size_m = {0.7, 0.7, 0.12};
  body.tilt_limit_rad = 0.1;
  body.altitude = {20, 8};
  body.heading = {2, 1};
  body.attitude = {20, 5};
  body.position = {0, 0};
  return body;
}

// The same body with gains tuned so that agents move as double integrators do. Attitude: 25 rad/s, damping 0.6, as fast
// as a control rate of 100 Hz and the torque of the rotors allow for a bang-bang law; faster gains saturate and
// oscillate. Position: 1 rad/s, well below the attitude.
Airframe Mascot() {
  Airframe body = Published();
  body.tilt_limit_rad = 0.35;
  body.altitude = {25, 10};
  body.heading = {4, 4};
  body.attitude = {625, 30};
  body.position = {1, 2};
  return body;
}

// Bitcraze Crazyflie 2. Inertia and drag: Foerster, "System Identification of the Crazyflie 2.0 Nano Quadrocopter"
// (ETH Zurich 2015); b and k: Luis & Le Ny, "Design of a Trajectory Tracking Controller for a Nanoquadcopter" (2016).
// We put its rotors in the plus layout; their lag is an estimate, and bounds the attitude gains.
Airframe Crazyflie() {
  Airframe body;
  body.mass_kg = 0.027;
  body.inertia_kg_m2 = {1.657e-5, 1.666e-5, 2.926e-5};
  body.arm_m = 0.046;
  body.lift_n_s2 = 2.88e-8;
  body.drag_n_m_s2 = 7.24e-10;
  body.linear_drag_kg_per_s = 5.6e-3;
  body.max_thrust_n = 0.6;
  body.rotor_time_constant_s = 0.03;
  body.size_m = {0.065, 0.065, 0.03};
  body.tilt_limit_rad = 0.35;
  body.altitude = {10, 6};
  body.heading = {4, 4};
  body.attitude = {100, 16};
  body.position = {2, 2.5};
  return body;
}

struct Entry {
  std::string_view name;
  Airframe (*make)();
};
// Every built-in airframe.
constexpr Entry kAirframes[] = {{"mascot", Mascot}, {"mascot_published", Published}, {"crazyflie", Crazyflie}};

constexpr auto kAirframeNames = [] {
  std::array<std::string_view, std::size(kAirframes)> names{};
  for (std::size_t i = 0; i < names.size(); ++i) names[i] = kAirframes[i].name;
  return names;
}();

constexpr Range kAirframeGain = {0, 1e4};
constexpr std::string_view kOfBase = "that of `base`";
constexpr Key kAirframeGainKeys[] = {
    key::Number("kp", kAirframeGain, "proportional").Otherwise(kOfBase),
    key::Number("kd", kAirframeGain, "derivative").Otherwise(kOfBase),
};

constexpr Key kAirframeKeys[] = {
    key::OneOf("base", kAirframeNames, "the built-in airframe from which this table takes the keys that it leaves out")
        .Default("\"mascot\""),
    key::Text("name", "name of the airframe").Otherwise(kOfBase),
    key::Number("mass_kg", Above(0, 1e4), "mass").Otherwise(kOfBase),
    key::Vector3("inertia_kg_m2", {0, 1e6}, "moments of inertia about x, y, z of B").Otherwise(kOfBase),
    key::Number("arm_m", Above(0, 100), "d: distance from the centre to a rotor").Otherwise(kOfBase),
    key::Number("lift_n_s2", Above(0, 1), "b: thrust of a rotor per squared speed").Otherwise(kOfBase),
    key::Number("drag_n_m_s2", Above(0, 1), "k: torque of a rotor per squared speed").Otherwise(kOfBase),
    key::Number("linear_drag_kg_per_s", {0, 1e3}, "B: force per airspeed").Otherwise(kOfBase),
    key::Number("max_thrust_n", Above(0, 1e6), "thrust of all four rotors together").Otherwise(kOfBase),
    key::Number("rotor_time_constant_s", {0, 10}, "time constant of the lag of the rotor speed; 0: no lag")
        .Otherwise(kOfBase),
    key::Vector3("size_m", {1e-3, 100}, "collision box, full lengths").Otherwise(kOfBase),
    key::Number("tilt_limit_rad", Above(0, 1.5), "limit on roll and on pitch").Otherwise(kOfBase),
    key::Table("altitude", kAirframeGainKeys, "gains of the altitude loop: m/s^2 per m and per m/s"),
    key::Table("heading", kAirframeGainKeys, "gains of the heading loop: rad/s^2 per rad and per rad/s"),
    key::Table("attitude", kAirframeGainKeys, "gains of the roll and pitch loops: rad/s^2 per rad and per rad/s"),
    key::Table("position", kAirframeGainKeys, "gains of the position loop in x and y: m/s^2 per m and per m/s"),
};

PdGains ReadGains(Section& table, std::string_view key, const PdGains& base) {
  Section gains = table.Child(key);
  PdGains read;
  read.kp = gains.Number("kp", base.kp);
  read.kd = gains.Number("kd", base.kd);
  gains.Done();
  return read;
}

// True for moments of inertia that a rigid body can have: none is zero, and each is at most the sum of the other two.
bool IsPossibleInertia(const Eigen::Vector3d& moments) {
  return moments.minCoeff() > 0 && 2 * moments.maxCoeff() <= moments.sum() * (1 + 1e-12);
}

// The contact solver divides an impulse between moving and turning a body. It takes ever more iterations as moments of
// inertia become small for mass and size, and below this share of those of a solid box a body sinks into what it lies
// on. Built-in airframes have 1.4 to 1.9 of them.
constexpr double kMinBoxShare = 0.05;

/// The moments of inertia of a solid box.
Eigen::Vector3d BoxInertia(double mass_kg, const Eigen::Vector3d& size_m) {
  const Eigen::Vector3d squares = size_m.cwiseAbs2();
  return mass_kg / 12 * (Eigen::Vector3d::Constant(squares.sum()) - squares);
}

std::string ListText(const Eigen::Vector3d& v) {
  return "[" + ShortestFloat(v.x()) + ", " + ShortestFloat(v.y()) + ", " + ShortestFloat(v.z()) + "]";
}

/// Notes a mistake where mass and size are not those of a body with these moments of inertia. Each of the three may be
/// that of `base`.
void ExpectInertiaOfMassAndSize(const Airframe& body, Section& table) {
  const Eigen::Vector3d least = kMinBoxShare * BoxInertia(body.mass_kg, body.size_m);
  if ((body.inertia_kg_m2.array() >= least.array()).all()) return;
  std::string_view changed = "inertia_kg_m2";
  if (!table.Has(changed)) changed = table.Has("mass_kg") ? "mass_kg" : "size_m";
  table.Fail(changed,
             fmt::format("expected moments of inertia of at least {}, a twentieth of those of a solid box of {} kg and "
                         "{} m, got inertia_kg_m2 = {}: with them a body sinks into what it lies on",
                         fmt::format("[{:.2g}, {:.2g}, {:.2g}]", least.x(), least.y(), least.z()),
                         ShortestFloat(body.mass_kg), ListText(body.size_m), ListText(body.inertia_kg_m2)));
}

Airframe ReadTable(Section table) {
  const std::string base_name = table.OneOf("base");
  Airframe body = *std::ranges::find(Airframes(), base_name, &Airframe::name);
  body.name = table.Text("name", body.name);
  body.mass_kg = table.Number("mass_kg", body.mass_kg);
  body.inertia_kg_m2 = table.Vector3("inertia_kg_m2", body.inertia_kg_m2);
  if (const Eigen::Vector3d& j = body.inertia_kg_m2; !IsPossibleInertia(j))
    table.Fail("inertia_kg_m2", "expected positive moments, each at most the sum of the other two, got " + ListText(j));
  body.arm_m = table.Number("arm_m", body.arm_m);
  body.lift_n_s2 = table.Number("lift_n_s2", body.lift_n_s2);
  body.drag_n_m_s2 = table.Number("drag_n_m_s2", body.drag_n_m_s2);
  body.linear_drag_kg_per_s = table.Number("linear_drag_kg_per_s", body.linear_drag_kg_per_s);
  body.max_thrust_n = table.Number("max_thrust_n", body.max_thrust_n);
  body.rotor_time_constant_s = table.Number("rotor_time_constant_s", body.rotor_time_constant_s);
  body.size_m = table.Vector3("size_m", body.size_m);
  if (!table.Wrong("mass_kg") && !table.Wrong("inertia_kg_m2") && !table.Wrong("size_m"))
    ExpectInertiaOfMassAndSize(body, table);
  body.tilt_limit_rad = table.Number("tilt_limit_rad", body.tilt_limit_rad);
  body.altitude = ReadGains(table, "altitude", body.altitude);
  body.heading = ReadGains(table, "heading", body.heading);
  body.attitude = ReadGains(table, "attitude", body.attitude);
  body.position = ReadGains(table, "position", body.position);
  table.Done();
  return body;
}

}  // namespace

Eigen::Matrix4d Airframe::Allocation() const {
  const double b = lift_n_s2, bd = lift_n_s2 * arm_m, k = drag_n_m_s2;
  return Eigen::Matrix4d{{b, b, b, b}, {0, bd, 0, -bd}, {-bd, 0, bd, 0}, {k, -k, k, -k}};
}

double Airframe::MaxRotorSpeed() const { return std::sqrt(max_thrust_n / (4 * lift_n_s2)); }

double Airframe::HoverRotorSpeed(double gravity_m_per_s2) const {
  return std::sqrt(mass_kg * gravity_m_per_s2 / (4 * lift_n_s2));
}

std::span<const Airframe> Airframes() {
  static const std::vector<Airframe> airframes = [] {
    std::vector<Airframe> all;
    for (const Entry& entry : kAirframes) {
      all.push_back(entry.make());
      all.back().name = entry.name;
    }
    return all;
  }();
  return airframes;
}

std::span<const Key> AirframeKeys() { return kAirframeKeys; }

std::span<const std::string_view> AirframeNames() { return kAirframeNames; }

Airframe ReadAirframe(Section& agents, std::string_view key) {
  if (agents.Kind(key) == "table") return ReadTable(agents.Child(key));
  return *std::ranges::find(Airframes(), agents.OneOf(key), &Airframe::name);
}

}  // namespace mascot

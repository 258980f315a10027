// `orchestrator airframes`: prints the built-in quadrotors, with the keys that a user's airframe table may change.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <memory>
#include <utility>

#include "experiment/airframe.h"
#include "experiment/experiment.h"
#include "orchestrator/report/json.h"
#include "orchestrator/verbs/one_of.h"
#include "orchestrator/verbs/print_wrapped.h"
#include "orchestrator/verbs/verb.h"

namespace mascot {
namespace {

/// A parameter of an airframe and its key in a table agents.airframe.
struct Parameter {
  std::string_view name;
  Json (*value)(const Airframe& airframe);
};

/// A number that follows from the parameters.
struct Derived {
  std::string_view name;
  std::string_view meaning;
  Json (*value)(const Airframe& airframe);
};

Json Gains(const PdGains& gains) { return {{"kp", gains.kp}, {"kd", gains.kd}}; }
Json List(const Eigen::Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); }

constexpr Parameter kParameters[] = {
    {"mass_kg", [](const Airframe& a) { return Json(a.mass_kg); }},
    {"inertia_kg_m2", [](const Airframe& a) { return List(a.inertia_kg_m2); }},
    {"arm_m", [](const Airframe& a) { return Json(a.arm_m); }},
    {"lift_n_s2", [](const Airframe& a) { return Json(a.lift_n_s2); }},
    {"drag_n_m_s2", [](const Airframe& a) { return Json(a.drag_n_m_s2); }},
    {"linear_drag_kg_per_s", [](const Airframe& a) { return Json(a.linear_drag_kg_per_s); }},
    {"max_thrust_n", [](const Airframe& a) { return Json(a.max_thrust_n); }},
    {"rotor_time_constant_s", [](const Airframe& a) { return Json(a.rotor_time_constant_s); }},
    {"size_m", [](const Airframe& a) { return List(a.size_m); }},
    {"tilt_limit_rad", [](const Airframe& a) { return Json(a.tilt_limit_rad); }},
    {"altitude", [](const Airframe& a) { return Gains(a.altitude); }},
    {"heading", [](const Airframe& a) { return Gains(a.heading); }},
    {"attitude", [](const Airframe& a) { return Gains(a.attitude); }},
    {"position", [](const Airframe& a) { return Gains(a.position); }},
};

std::string_view MeaningOf(std::string_view name) {
  return std::ranges::find(AirframeKeys(), name, &Key::name)->meaning;
}

double Gravity() { return Experiment().physics.gravity_m_per_s2; }

constexpr Derived kDerived[] = {
    {"hover_rotor_speed_rad_per_s", "of each rotor",
     [](const Airframe& a) { return Json(a.HoverRotorSpeed(Gravity())); }},
    {"max_rotor_speed_rad_per_s", "at max_thrust_n", [](const Airframe& a) { return Json(a.MaxRotorSpeed()); }},
    {"thrust_to_weight", "max_thrust_n / weight",
     [](const Airframe& a) { return Json(a.max_thrust_n / (a.mass_kg * Gravity())); }},
};

Json ToJson(const Airframe& airframe) {
  Json json = {{"name", airframe.name}};
  for (const Parameter& parameter : kParameters) json[parameter.name] = parameter.value(airframe);
  json["derived"]["gravity_m_per_s2"] = Gravity();
  for (const Derived& derived : kDerived) json["derived"][derived.name] = derived.value(airframe);
  return json;
}

/// `value` as TOML.
std::string ToToml(const Json& value) {
  std::string text;
  if (value.is_object()) {
    for (const auto& [key, inner] : value.items())
      text += fmt::format("{}{} = {}", text.empty() ? "{ " : ", ", key, inner.dump());
    return text + " }";
  }
  if (!value.is_array()) return value.dump();
  for (const Json& inner : value) text += (text.empty() ? "[" : ", ") + inner.dump();
  return text + "]";
}

void PrintEntry(std::string_view name, const std::string& value, std::string_view meaning) {
  constexpr std::size_t kIndent = 36;
  const std::string entry = fmt::format("    {} = {} ", name, value);
  PrintWrapped(entry, meaning, entry.size() <= kIndent ? kIndent : 8);
}

void Print(const Airframe& airframe) {
  std::cout << fmt::format("{0}\n  keys of a table of your own: airframe = {{ base = \"{0}\", ... }}\n", airframe.name);
  for (const Parameter& parameter : kParameters)
    PrintEntry(parameter.name, ToToml(parameter.value(airframe)), MeaningOf(parameter.name));
  std::cout << fmt::format("  derived, at {:g} m/s^2\n", Gravity());
  for (const Derived& derived : kDerived)
    PrintEntry(derived.name, fmt::format("{:.4g}", derived.value(airframe).get<double>()), derived.meaning);
}

int ShowAirframes(const std::string& name, bool json) {
  if (!name.empty()) RequireOneOf("airframes", "an airframe", name, AirframeNames());
  Json table = Json::array();
  bool first = true;
  for (const Airframe& airframe : Airframes()) {
    if (!name.empty() && airframe.name != name) continue;
    if (json) {
      table.push_back(ToJson(airframe));
    } else {
      std::cout << (std::exchange(first, false) ? "" : "\n");
      Print(airframe);
    }
  }
  if (json) std::cout << JsonText(table);
  return 0;
}

}  // namespace

std::function<int()> SetUpAirframes(CLI::App& command) {
  const auto name = std::make_shared<std::string>();
  const auto json = std::make_shared<bool>(false);
  command.add_option("name", *name, "the airframe to show (default: all)")->type_name("NAME");
  command.add_flag("--json", *json, "print JSON and nothing else");
  return [name, json] { return ShowAirframes(*name, *json); };
}

}  // namespace mascot

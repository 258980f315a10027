#include "experiment/faults.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <map>

#include "experiment/experiment.h"

namespace mascot {
namespace {

constexpr int kMotors = 4;  // of a quadrotor; inputs of other models

constexpr double kUsualPeriod_s = 0.5, kUsualPeriodOfLie_s = 5;

constexpr Key kFaultKeys[] = {
    key::Integer("agent", 1, kMaxAgents, "its number").Required(),
    key::OneOf("of", kFaultParts.names(), "the agent itself, or what it measures, drives or sends with")
        .Default("\"agent\""),
    key::OneOf("kind", kFaultKinds.names(), "what happens, see the table of faults").Required(),
    key::OneOf("lie", kFalseDataKinds.names(), "kind of a lie").Default("\"constant\""),
    key::Vector3("offset_m", {-1e6, 1e6}, "how far off what is measured or heard is").Default("[1.0, 1.0, 1.0]"),
    key::Integer("motor", 0, kMotors, "1 front, 2 left, 3 back, 4 right, or the model's input; 0: all").Default("0"),
    key::Number("remaining", {0, 1}, "fraction of its command that a wrong motor carries out").Default("0.5"),
    key::Number("period_s", Above(0, 1e6), "of what is slow, or of an oscillating lie").Otherwise("0.5; of a lie 5.0"),
    key::Number("delay_s", Above(0, 100), "of what is delayed").Default("0.5"),
    key::Number("probability", {0, 1}, "that what is intermittent fails at a tick").Default("0.5"),
    key::Boolean("unanswered", "of kill and hang: the agent has not answered the tick before, either").Default("false"),
};

const FaultRow* RowOf(FaultPart of, FaultKind kind) {
  const std::span<const FaultRow> rows = FaultRows();
  const auto row =
      std::ranges::find_if(rows, [&](const FaultRow& other) { return other.of == of && other.kind == kind; });
  return row == rows.end() ? nullptr : &*row;
}

bool Takes(const FaultRow& row, std::string_view parameter) {
  return (", " + std::string(row.parameters) + ",").find(" " + std::string(parameter) + ",") != std::string::npos;
}

/// The names of the kinds that fit: "kill, hang or mute".
template <class Fits>
std::string KindsThat(Fits fits) {
  std::vector<std::string_view> names;
  for (const FaultRow& row : FaultRows())
    if (const std::string_view name = kFaultKinds.Name(row.kind);
        fits(row) && std::ranges::find(names, name) == names.end())
      names.push_back(name);
  std::string text;
  for (std::size_t k = 0; k < names.size(); ++k)
    text += (k == 0 ? "" : k + 1 == names.size() ? " or " : ", ") + std::string(names[k]);
  return text;
}

FalseDataConfig ReadOffset(Section& section, const FaultRow& row) {
  FalseDataConfig config{.offset_m = section.Vector3("offset_m")};
  if (row.kind == FaultKind::kGarbage) config.kind = FalseDataKind::kRandom;
  if (row.kind != FaultKind::kLie) return config;
  config.kind = kFalseDataKinds.Value(section.OneOf("lie"));
  config.period_s = section.Number("period_s", kUsualPeriodOfLie_s);
  return config;
}

/// What the fault of a part is: "wrong: 0.8 of its command".
std::string WordsOf(const Fault& fault) {
  const std::string kind(kFaultKinds.Name(fault.kind));
  const Eigen::Vector3d& off = fault.false_data.offset_m;
  const std::string offset = fmt::format("[{:g}, {:g}, {:g}] m", off.x(), off.y(), off.z());
  const bool is_motor = fault.of == FaultPart::kMotor;
  switch (fault.kind) {
    case FaultKind::kWrong:
      return kind + (is_motor ? fmt::format(": {:g} of its command", fault.remaining) : ": off by " + offset);
    case FaultKind::kGarbage:
      return is_motor ? kind : kind + ": off by up to " + offset;
    case FaultKind::kSlow:
      return fmt::format("{}: every {:g} s", kind, fault.period_s);
    case FaultKind::kDelayed:
      return fmt::format("{} by {:g} s", kind, fault.delay_s);
    case FaultKind::kIntermittent:
      return fmt::format("{}: fails with probability {:g}", kind, fault.probability);
    default:
      return kind;
  }
}

}  // namespace

const PartFault* AgentFaults::Of(FaultPart part, int motor) const {
  const auto found = std::ranges::find_if(
      parts, [&](const PartFault& other) { return other.fault.of == part && other.fault.motor == motor; });
  return found == parts.end() ? nullptr : &*found;
}

std::span<const FaultRow> FaultRows() {
  using enum FaultPart;
  using enum FaultKind;
  static constexpr FaultRow rows[] = {
      {kAgent, kKill, "unanswered", "its process dies: the agent is lost (`run.on_agent_loss`)"},
      {kAgent, kHang, "unanswered", "its process stays, and answers nothing: the agent is lost (`run.on_agent_loss`)"},
      {kAgent, kMute, "", "nobody hears it; it hears the others"},
      {kAgent, kDeaf, "", "it hears nobody; the others hear it"},
      {kAgent, kLie, "lie, offset_m, period_s",
       "what others hear of it is false, as with `lie` of `[[agents.override]]`"},
      {kAgent, kOk, "", "ends mute, deaf and lie; a lost agent comes back by `restart` alone"},
      {kSensor, kOff, "",
       "it measures nothing: its position goes on with the last velocity that it has measured (dead reckoning)"},
      {kSensor, kStuck, "", "it measures the same position and velocity for ever"},
      {kSensor, kGarbage, "offset_m",
       "it measures positions, and velocities per second, that are off by up to `offset_m`, drawn anew at each tick"},
      {kSensor, kWrong, "offset_m", "it measures positions that are off by `offset_m`"},
      {kSensor, kSlow, "period_s", "it measures every `period_s`, and keeps what it has measured"},
      {kSensor, kDelayed, "delay_s", "it measures what was true `delay_s` ago, but nothing older than the fault"},
      {kSensor, kIntermittent, "probability", "with `probability` per tick it keeps what it has measured last"},
      {kSensor, kOk, "", "ends the fault"},
      {kMotor, kOff, "motor", "it does not turn: its command is 0, whatever the agent commands"},
      {kMotor, kStuck, "motor", "it keeps the command of the tick before"},
      {kMotor, kGarbage, "motor", "its command is drawn anew at each tick, between 0 and twice that of the agent"},
      {kMotor, kWrong, "motor, remaining", "it carries out the fraction `remaining` of its command"},
      {kMotor, kSlow, "motor, period_s", "it takes a command every `period_s`"},
      {kMotor, kDelayed, "motor, delay_s",
       "it carries out the command of `delay_s` ago; at first, that of the tick before"},
      {kMotor, kIntermittent, "motor, probability", "with `probability` per tick its command is 0"},
      {kMotor, kOk, "motor", "ends the fault"},
      {kLink, kOff, "", "nothing that it sends arrives"},
      {kLink, kStuck, "", "others hear its state and message of the fault's tick for ever, as if they were new"},
      {kLink, kGarbage, "offset_m", "others hear positions and messages that are off by up to `offset_m`, drawn anew"},
      {kLink, kWrong, "offset_m", "others hear positions and messages that are off by `offset_m`"},
      {kLink, kSlow, "period_s", "it sends every `period_s`"},
      {kLink, kDelayed, "delay_s", "what it sends arrives `delay_s` later, besides the delay of `[link]`"},
      {kLink, kIntermittent, "probability", "with `probability` what it sends at a tick is lost, for all that hear it"},
      {kLink, kOk, "", "ends the fault"},
  };
  return rows;
}

std::vector<std::string> InWords(const AgentFaults& faults) {
  std::vector<std::string> words;
  if (faults.is_lost()) words.emplace_back(faults.hangs ? "lost: it hangs" : "lost: its process has died");
  if (faults.is_mute) words.emplace_back("mute: nobody hears it");
  if (faults.is_deaf) words.emplace_back("deaf: it hears nobody");
  std::map<std::string, std::vector<int>> motors;  // by what is wrong with them
  for (const auto& [fault, since] : faults.parts) {
    if (fault.of == FaultPart::kMotor)
      motors[WordsOf(fault)].push_back(fault.motor);
    else
      words.push_back(std::string(kFaultParts.Name(fault.of)) + " " + WordsOf(fault));
  }
  for (const auto& [what, numbers] : motors) {
    const bool is_all = numbers.size() == kMotors;
    words.push_back((is_all                ? std::string("all motors")
                     : numbers.size() == 1 ? fmt::format("motor {}", numbers.front())
                                           : fmt::format("motors {}", fmt::join(numbers, ", "))) +
                    " " + what);
  }
  return words;
}

std::span<const Key> FaultKeys() { return kFaultKeys; }

Fault ReadFault(Section section, int agents) {
  Fault fault;
  fault.agent = static_cast<int>(section.Integer("agent", 1, agents > 0 ? agents : kMaxAgents));
  fault.of = kFaultParts.Value(section.OneOf("of"));
  fault.kind = kFaultKinds.Value(section.OneOf("kind"));
  const bool known = !section.Wrong("of") && !section.Wrong("kind");
  const FaultRow* row = RowOf(fault.of, fault.kind);
  if (row == nullptr) {
    const std::string of(kFaultParts.Name(fault.of));
    if (known)
      section.Fail("kind", "expected for of = \"" + of + "\" one of " +
                               KindsThat([&](const FaultRow& other) { return other.of == fault.of; }) + ", got '" +
                               std::string(kFaultKinds.Name(fault.kind)) + "'");
    row = &FaultRows()[0];
  }
  for (const Key& key : kFaultKeys) {
    const bool is_parameter =
        std::ranges::any_of(FaultRows(), [&](const FaultRow& any) { return Takes(any, key.name); });
    if (!known || section.Wrong("kind") || !is_parameter || !section.Has(key.name) || Takes(*row, key.name)) continue;
    section.Fail(key.name, "expected only with kind = " +
                               KindsThat([&](const FaultRow& other) { return Takes(other, key.name); }) + ", got '" +
                               std::string(kFaultKinds.Name(fault.kind)) + "' of = \"" +
                               std::string(kFaultParts.Name(fault.of)) + "\"");
  }
  if (Takes(*row, "offset_m")) fault.false_data = ReadOffset(section, *row);
  if (Takes(*row, "motor")) fault.motor = static_cast<int>(section.Integer("motor"));
  if (Takes(*row, "remaining")) fault.remaining = section.Number("remaining");
  if (Takes(*row, "period_s") && fault.kind != FaultKind::kLie)
    fault.period_s = section.Number("period_s", kUsualPeriod_s);
  if (Takes(*row, "delay_s")) fault.delay_s = section.Number("delay_s");
  if (Takes(*row, "probability")) fault.probability = section.Number("probability");
  if (Takes(*row, "unanswered")) fault.unanswered = section.Boolean("unanswered");
  section.Done();
  return fault;
}

std::string ToToml(const Fault& fault) {
  std::string text = "{ agent = " + std::to_string(fault.agent);
  const auto add = [&text](const std::string& key, const Value& value) { text += ", " + key + " = " + ToToml(value); };
  if (fault.of != FaultPart::kAgent) add("of", {std::string(kFaultParts.Name(fault.of))});
  add("kind", {std::string(kFaultKinds.Name(fault.kind))});
  const FaultRow& row = *RowOf(fault.of, fault.kind);
  const Eigen::Vector3d& off = fault.false_data.offset_m;
  if (fault.kind == FaultKind::kLie) add("lie", {std::string(kFalseDataKinds.Name(fault.false_data.kind))});
  if (Takes(row, "offset_m")) add("offset_m", {Value::List{{off.x()}, {off.y()}, {off.z()}}});
  if (fault.kind == FaultKind::kLie) add("period_s", {fault.false_data.period_s});
  if (Takes(row, "motor")) add("motor", {std::int64_t{fault.motor}});
  if (Takes(row, "remaining")) add("remaining", {fault.remaining});
  if (fault.kind == FaultKind::kSlow) add("period_s", {fault.period_s});
  if (Takes(row, "delay_s")) add("delay_s", {fault.delay_s});
  if (Takes(row, "probability")) add("probability", {fault.probability});
  if (fault.unanswered) add("unanswered", {true});
  return text + " }";
}

void Begin(const Fault& fault, std::int64_t tick, AgentFaults& faults) {
  if (fault.IsLoss()) {
    if (!faults.is_lost()) faults.lost_since = std::max<std::int64_t>(0, fault.unanswered ? tick - 1 : tick);
    faults.hangs = fault.kind == FaultKind::kHang;
    return;
  }
  if (fault.of == FaultPart::kAgent) {
    faults.is_mute = fault.kind == FaultKind::kMute || (fault.kind != FaultKind::kOk && faults.is_mute);
    faults.is_deaf = fault.kind == FaultKind::kDeaf || (fault.kind != FaultKind::kOk && faults.is_deaf);
    return;
  }
  std::erase_if(faults.parts, [&](const PartFault& other) {
    return other.fault.of == fault.of && (fault.motor == 0 || other.fault.motor == fault.motor);
  });
  if (fault.kind == FaultKind::kOk) return;
  PartFault part{.fault = fault, .since = tick};
  if (fault.of != FaultPart::kMotor || fault.motor != 0) {
    faults.parts.push_back(part);
    return;
  }
  for (int motor = 1; motor <= kMotors; ++motor) {
    part.fault.motor = motor;
    faults.parts.push_back(part);
  }
}

void Restart(std::int64_t tick, AgentFaults& faults) { faults = {.parts = std::move(faults.parts), .restarted = tick}; }

}  // namespace mascot

#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/enum_names.h"
#include "experiment/false_data.h"
#include "experiment/toml/section.h"

namespace mascot {

/// What a fault is of: the agent itself, or one of its parts.
enum class FaultPart { kAgent, kSensor, kMotor, kLink };
inline constexpr EnumNames<FaultPart, 4> kFaultParts({{FaultPart::kAgent, "agent"},
                                                      {FaultPart::kSensor, "sensor"},
                                                      {FaultPart::kMotor, "motor"},
                                                      {FaultPart::kLink, "link"}});
enum class FaultKind {
  kKill,
  kHang,
  kMute,
  kDeaf,
  kLie,
  kOff,
  kStuck,
  kGarbage,
  kWrong,
  kSlow,
  kDelayed,
  kIntermittent,
  kOk,
};
inline constexpr EnumNames<FaultKind, 13> kFaultKinds({{FaultKind::kKill, "kill"},
                                                       {FaultKind::kHang, "hang"},
                                                       {FaultKind::kMute, "mute"},
                                                       {FaultKind::kDeaf, "deaf"},
                                                       {FaultKind::kLie, "lie"},
                                                       {FaultKind::kOff, "off"},
                                                       {FaultKind::kStuck, "stuck"},
                                                       {FaultKind::kGarbage, "garbage"},
                                                       {FaultKind::kWrong, "wrong"},
                                                       {FaultKind::kSlow, "slow"},
                                                       {FaultKind::kDelayed, "delayed"},
                                                       {FaultKind::kIntermittent, "intermittent"},
                                                       {FaultKind::kOk, "ok"}});

/// `fault` of [[events]]: what goes wrong with an agent from the event's tick on.
struct Fault {
  int agent = 0;
  FaultPart of = FaultPart::kAgent;
  FaultKind kind = FaultKind::kKill;
  FalseDataConfig false_data = {};  ///< what others hear, or the agent measures: of lie, wrong and garbage
  int motor = 0;                    ///< 1..4; 0: all motors
  double remaining = 0;             ///< fraction of its command that a wrong motor carries out
  double period_s = 0;              ///< of what is slow
  double delay_s = 0;               ///< of what is delayed
  double probability = 0;           ///< per tick, that what is intermittent fails
  /// Of kill and hang: the agent has not answered the tick before the event, either. A process that dies before it
  /// answers a tick is lost in this way: its neighbours have heard its state of that tick, and its command never came.
  bool unanswered = false;

  bool IsLoss() const { return kind == FaultKind::kKill || kind == FaultKind::kHang; }
};

/// A fault of a part of an agent that has not ended.
struct PartFault {
  Fault fault;
  std::int64_t since = 0;  ///< tick
};

/// What events have done to an agent.
struct AgentFaults {
  /// The tick from which on the agent answers nothing: it is lost. Absent: it is not.
  std::optional<std::int64_t> lost_since = {};
  bool hangs = false;  ///< it is lost, and its process is still there
  bool is_mute = false, is_deaf = false;
  std::vector<PartFault> parts = {};  ///< at most one of the sensor, one of the link, and one of each motor
  std::int64_t restarted = 0;         ///< the tick at which a fresh agent took its place; 0: none has

  bool is_lost() const { return lost_since.has_value(); }
  /// The fault of a part; null: it is in order. `motor`: 1..4, of FaultPart::kMotor.
  const PartFault* Of(FaultPart part, int motor = 0) const;
};

/// A row of the table of faults: what a kind means for a part.
struct FaultRow {
  FaultPart of;
  FaultKind kind;
  std::string_view parameters;  ///< the keys that go with it: "motor, remaining"
  std::string_view meaning;
};
std::span<const FaultRow> FaultRows();

/// What is wrong with an agent, in words, each fault of its own: "lost: its process has died", "link delayed by 0.5 s".
/// Empty: nothing is, as far as events have done it.
std::vector<std::string> InWords(const AgentFaults& faults);

/// The keys of `fault`.
std::span<const Key> FaultKeys();
/// Reads `fault`. `agents`: their number; 0: unknown because of a mistake.
Fault ReadFault(Section section, int agents);
/// The value of `fault` in TOML, in a fixed form.
std::string ToToml(const Fault& fault);

/// Lets the fault begin at `tick`.
void Begin(const Fault& fault, std::int64_t tick, AgentFaults& faults);
/// A fresh agent takes the agent's place at `tick`: what was wrong with the old one's process is over. Its parts stay
/// as they are.
void Restart(std::int64_t tick, AgentFaults& faults);

}  // namespace mascot

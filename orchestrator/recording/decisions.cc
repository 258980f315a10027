#include "orchestrator/recording/decisions.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "bus/wire.h"

namespace mascot {
namespace {

// In the order in which an agent makes them.
enum DecisionField : std::size_t { kWantedField, kLimitedField, kActuatorField, kFlagsField, kDataField, kFieldCount };

std::array<double, 3> Xyz(const geometry_msgs::msg::Vector3& vector) { return {vector.x(), vector.y(), vector.z()}; }

std::string PartOf(std::size_t field, std::size_t k) {
  constexpr const char* kXyz[] = {".x", ".y", ".z"};
  if (field == kWantedField || field == kLimitedField) return kXyz[k];
  return field == kFlagsField ? "" : fmt::format("[{}]", k);
}

}  // namespace

double Decisions::Pair::difference() const { return std::abs(replayed - recorded); }

Decisions::Decisions() : fields_(kFieldCount) {
  fields_[kWantedField] = {.name = "acceleration_wanted", .unit = "m/s^2"};
  fields_[kLimitedField] = {.name = "acceleration_limited", .unit = "m/s^2"};
  fields_[kActuatorField].name = "actuator";
  fields_[kFlagsField].name = "flags";
  fields_[kDataField].name = "data";
}

void Decisions::Note(std::int64_t tick, TopicKind kind, const Row::Bytes& recorded, const Row::Bytes& replayed) {
  if (std::exchange(newest_, tick) != tick) ++differing_;
  if (first_) return;
  const auto size = [](const Row::Bytes& bytes) {
    return bytes.empty() ? std::string("none") : fmt::format("{} bytes", bytes.size());
  };
  auto difference = recorded.empty() || replayed.empty() ? SampleDifference{"sample", size(recorded), size(replayed)}
                                                         : FirstDifference(kind, recorded, replayed).value();
  first_ = First{.tick = tick, .topic = std::string(TraitsOf(kind).name), .difference = std::move(difference)};
}

void Decisions::Compare(std::size_t field, std::int64_t tick, std::span<const double> recorded,
                        std::span<const double> replayed) {
  Pair largest;
  for (std::size_t k = 0; k < std::min(recorded.size(), replayed.size()); ++k) {
    if (std::bit_cast<std::uint64_t>(recorded[k]) == std::bit_cast<std::uint64_t>(replayed[k])) continue;
    const Pair pair{.tick = tick, .part = PartOf(field, k), .recorded = recorded[k], .replayed = replayed[k]};
    if (largest.tick < 0 || pair.difference() > largest.difference()) largest = pair;
  }
  if (largest.tick < 0) return;
  Field& all = fields_[field];
  if (all.ticks++ == 0) all.first = all.largest = largest;
  if (largest.difference() > all.largest.difference()) all.largest = largest;
}

bool Decisions::AddCommand(std::int64_t tick, const Row::Bytes& recorded, const Row::Bytes& replayed) {
  ++ticks_;
  if (recorded == replayed) return newest_ != tick;
  Note(tick, TopicKind::kCommand, recorded, replayed);
  CompareCommands(tick, recorded, replayed);
  if (first_->tick == tick) NameFirstField();
  return false;
}

/// The first difference is named by the first field that an agent makes: the law's decision, before what follows from
/// it.
void Decisions::NameFirstField() {
  for (const Field& field : fields_) {
    if (field.ticks == 0 || field.first.tick != first_->tick) continue;
    first_->topic = TraitsOf(&field == &fields_[kDataField] ? TopicKind::kMessage : TopicKind::kCommand).name;
    first_->difference = {.field = field.name + field.first.part,
                          .first = fmt::format("{}", field.first.recorded),
                          .second = fmt::format("{}", field.first.replayed)};
    return;
  }
}

void Decisions::CompareCommands(std::int64_t tick, const Row::Bytes& recorded, const Row::Bytes& replayed) try {
  mascot_msgs::msg::AgentCommand a, b;
  Deserialize(recorded, a);
  Deserialize(replayed, b);
  Compare(kWantedField, tick, Xyz(a.acceleration_wanted()), Xyz(b.acceleration_wanted()));
  Compare(kLimitedField, tick, Xyz(a.acceleration_limited()), Xyz(b.acceleration_limited()));
  Compare(kActuatorField, tick, a.actuator(), b.actuator());
  const double flags_a = a.flags(), flags_b = b.flags();
  Compare(kFlagsField, tick, {&flags_a, 1}, {&flags_b, 1});
} catch (const std::runtime_error&) {  // damaged: Note() has said what differs
}

void Decisions::AddMessage(std::int64_t tick, const Row::Bytes& recorded, const Row::Bytes& replayed) {
  if (recorded == replayed) return;
  Note(tick, TopicKind::kMessage, recorded, replayed);
  if (recorded.empty() || replayed.empty()) return;
  CompareMessages(tick, recorded, replayed);
  if (first_->tick == tick) NameFirstField();
}

void Decisions::CompareMessages(std::int64_t tick, const Row::Bytes& recorded, const Row::Bytes& replayed) try {
  mascot_msgs::msg::AgentMessage a, b;
  Deserialize(recorded, a);
  Deserialize(replayed, b);
  const std::vector<double> data_a(a.data().begin(), a.data().end()), data_b(b.data().begin(), b.data().end());
  Compare(kDataField, tick, data_a, data_b);
} catch (const std::runtime_error&) {  // likewise
}

std::vector<Decisions::Field> Decisions::DifferingFields() const {
  std::vector<Field> fields;
  std::ranges::copy_if(fields_, std::back_inserter(fields), [](const Field& field) { return field.ticks > 0; });
  return fields;
}

}  // namespace mascot

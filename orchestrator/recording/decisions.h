#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "orchestrator/recording/sample_fields.h"
#include "orchestrator/team/row.h"

namespace mascot {

/// What an agent decides in a replay beside what it has decided in the run, tick by tick: its commands, and the
/// messages that it sends with them.
class Decisions {
 public:
  /// A number that the two have for the same thing.
  struct Pair {
    std::int64_t tick = -1;
    std::string part = {};  ///< of the field: ".x", "[2]"
    double recorded = 0, replayed = 0;

    double difference() const;  ///< its size
  };
  /// A field of several numbers.
  struct Field {
    std::string name = {};          ///< "acceleration_wanted"
    std::string_view unit = {};     ///< "m/s^2"; "": that of the model's actuators, or of the law's messages
    std::int64_t ticks = 0;         ///< at how many ticks any of them differs
    Pair first = {}, largest = {};  ///< the largest difference of the first of these ticks, and of all
  };
  /// The first bits that differ.
  struct First {
    std::int64_t tick = -1;
    std::string topic;  ///< "command", "message"
    SampleDifference difference;
  };

  Decisions();
  /// Compares the two commands of `tick`, as samples with their encapsulation. Returns whether they are equal.
  bool AddCommand(std::int64_t tick, const Row::Bytes& recorded, const Row::Bytes& replayed);
  /// The same of messages, before the command of their tick; either may be empty: none was sent.
  void AddMessage(std::int64_t tick, const Row::Bytes& recorded, const Row::Bytes& replayed);

  std::int64_t ticks() const { return ticks_; }                 ///< that were compared
  std::int64_t differing() const { return differing_; }         ///< ticks at which the command or the message differs
  const std::optional<First>& first() const { return first_; }  ///< nothing: all is equal
  /// The fields whose numbers differ, in the order in which an agent makes them.
  std::vector<Field> DifferingFields() const;

 private:
  void Note(std::int64_t tick, TopicKind kind, const Row::Bytes& recorded, const Row::Bytes& replayed);
  void NameFirstField();
  void CompareCommands(std::int64_t tick, const Row::Bytes& recorded, const Row::Bytes& replayed);
  void CompareMessages(std::int64_t tick, const Row::Bytes& recorded, const Row::Bytes& replayed);
  void Compare(std::size_t field, std::int64_t tick, std::span<const double> recorded,
               std::span<const double> replayed);

  std::vector<Field> fields_;
  std::optional<First> first_;
  std::int64_t ticks_ = 0, differing_ = 0;
  std::int64_t newest_ = -1;  // tick that is counted in differing_
};

}  // namespace mascot

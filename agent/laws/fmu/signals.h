#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "agent/laws/law.h"

namespace mascot {

/// What an agent perceives at a tick.
struct Perception {
  double t_s = 0;
  int id = 0;
  const Motion* self = nullptr;
  std::span<const Heard* const> places;  ///< by place of a neighbour, in increasing id; null: nothing was heard
};

enum class FmuField {
  kTime,
  kId,
  kPosition,
  kVelocity,
  kAttitude,
  // of neighbours
  kNeighbourId,
  kNeighbourPosition,
  kNeighbourVelocity,
  kWeight,
  kHeard,
  kAge,
  kMessage
};

/// One number of what an agent perceives.
struct FmuSignal {
  FmuField field = FmuField::kTime;
  std::size_t place = 0;    ///< of the neighbour, from 0
  std::size_t element = 0;  ///< from 0

  bool is_of_neighbour() const { return field >= FmuField::kNeighbourId; }
  /// The number; 0 for a neighbour from which nothing was heard.
  double Value(const Perception& now) const;
};

/// The signals that `name` stands for, for a variable of `size` numbers: "p" is three, "p[2]", "p_y" and "p.y" are one;
/// "neighbour[1].p", "neighbour1_p", "neighbour_1_p" are the three of the first place, "neighbour.p" and "neighbour_p"
/// those of all places, one after the other. Nothing if the name is that of no signal; empty if its signals do not fit
/// the size.
std::optional<std::vector<FmuSignal>> SignalsOf(std::string_view name, std::size_t size);

/// Names of signals, for "did you mean", for a team in which an agent hears at most `places` others.
std::vector<std::string> SignalNames(std::size_t places);

/// An index behind a name: "u[2]", "u_y" and "u.y" are element 1 of "u"; "u" is all of it.
struct IndexedName {
  std::string_view name;
  std::vector<std::size_t> indices = {};  ///< from 0
};
/// Splits brackets off a name: "A[1,2]". Nothing if they hold no positive integers.
std::optional<IndexedName> WithoutBrackets(std::string_view name);
/// The place in a vector that indices stand for, also as a matrix of one row or column: [2], [1,2], [2,1]. Nothing:
/// none.
std::optional<std::size_t> PlaceInVector(std::span<const std::size_t> indices);
/// Also splits off "_x", ".x" and so on; `axes` are the letters, in order.
std::optional<IndexedName> WithoutIndex(std::string_view name, std::string_view axes);

}  // namespace mascot

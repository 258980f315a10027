#include "agent/laws/fmu/signals.h"

#include <fmt/format.h>

#include <algorithm>

#include "base/number.h"

namespace mascot {
namespace {

struct FieldRow {
  std::string_view name;
  FmuField field;
  std::size_t size;
  std::string_view axes;
};
constexpr FieldRow kOwnFields[] = {{"t", FmuField::kTime, 1, ""},
                                   {"id", FmuField::kId, 1, ""},
                                   {"p", FmuField::kPosition, 3, "xyz"},
                                   {"v", FmuField::kVelocity, 3, "xyz"},
                                   {"attitude", FmuField::kAttitude, 4, "xyzw"}};
constexpr FieldRow kNeighbourFields[] = {{"id", FmuField::kNeighbourId, 1, ""},
                                         {"p", FmuField::kNeighbourPosition, 3, "xyz"},
                                         {"v", FmuField::kNeighbourVelocity, 3, "xyz"},
                                         {"weight", FmuField::kWeight, 1, ""},
                                         {"heard", FmuField::kHeard, 1, ""},
                                         {"age", FmuField::kAge, 1, ""},
                                         {"message", FmuField::kMessage, kMaxMessage, ""}};
constexpr std::string_view kNeighbour = "neighbour";
constexpr std::size_t kMaxPlaces = 10'000;

/// A field by its name, and which of its numbers; no indices: all.
struct NamedField {
  const FieldRow* row = nullptr;
  std::vector<std::size_t> indices = {};
};

std::optional<NamedField> FieldIn(std::span<const FieldRow> rows, std::string_view name) {
  for (const FieldRow& row : rows) {
    const auto indexed = WithoutIndex(name, row.axes);
    if (indexed && indexed->name == row.name) return NamedField{&row, indexed->indices};
  }
  return std::nullopt;
}

/// All numbers of a field, or one. A message is as long as there is room for it.
std::vector<FmuSignal> Elements(const FieldRow& row, std::size_t place, std::span<const std::size_t> indices,
                                std::size_t size) {
  const std::size_t whole = row.field == FmuField::kMessage ? std::min(size, kMaxMessage) : row.size;
  std::vector<FmuSignal> signals;
  if (indices.empty()) {
    for (std::size_t k = 0; k < whole; ++k) signals.push_back({row.field, place, k});
  } else if (const auto element = PlaceInVector(indices); element && *element < row.size) {
    signals.push_back({row.field, place, *element});
  }
  return signals;
}

/// Takes the number of a place from the front: "1", "12".
std::optional<std::size_t> TakePlace(std::string_view& text) {
  const std::size_t digits = std::min(text.find_first_not_of("0123456789"), text.size());
  const auto number = NumberFrom<std::size_t>(text.substr(0, digits));
  if (!number || *number == 0 || *number > kMaxPlaces) return std::nullopt;
  text.remove_prefix(digits);
  return *number - 1;
}

bool TakePrefix(std::string_view& text, std::string_view prefix) {
  if (!text.starts_with(prefix)) return false;
  text.remove_prefix(prefix.size());
  return true;
}

/// Signals of all places: a matrix with a row for each, "neighbour.p", or some of it, "neighbour.p[2,1]".
std::optional<std::vector<FmuSignal>> OfAllPlaces(std::string_view name, std::size_t size) {
  const auto field = FieldIn(kNeighbourFields, name);
  if (!field) return std::nullopt;
  const FieldRow& row = *field->row;
  if (row.field == FmuField::kMessage) return std::vector<FmuSignal>();
  std::vector<FmuSignal> signals;
  if (field->indices.empty()) {
    for (std::size_t place = 0; place < size / row.size && size % row.size == 0; ++place)
      for (std::size_t k = 0; k < row.size; ++k) signals.push_back({row.field, place, k});
  } else if (const auto place = PlaceInVector(field->indices); row.size == 1 && place) {
    signals.push_back({row.field, *place, 0});
  } else if (row.size > 1 && field->indices.size() == 2 && field->indices[1] < row.size) {
    signals.push_back({row.field, field->indices[0], field->indices[1]});
  }
  return signals;
}

std::optional<std::vector<FmuSignal>> OfNeighbours(std::string_view name, std::size_t size) {
  std::optional<std::size_t> place;
  std::string_view rest = name;
  if (TakePrefix(rest, "[")) {
    place = TakePlace(rest);
    if (!place || !TakePrefix(rest, "]") || !TakePrefix(rest, ".")) return std::nullopt;
  } else {
    std::string_view numbered = rest;
    TakePrefix(numbered, "_");
    place = TakePlace(numbered);
    if (place) rest = numbered;
    if (!TakePrefix(rest, ".") && !TakePrefix(rest, "_")) return std::nullopt;
  }
  if (!place) return OfAllPlaces(rest, size);
  const auto field = FieldIn(kNeighbourFields, rest);
  if (!field) return std::nullopt;
  return Elements(*field->row, *place, field->indices, size);
}

double Attitude(const Eigen::Quaterniond& q, std::size_t element) {
  const double sign = q.w() < 0 ? -1 : 1;  // q and -q are the same attitude
  return sign * q.coeffs()[static_cast<Eigen::Index>(element)];
}

}  // namespace

std::optional<IndexedName> WithoutBrackets(std::string_view name) {
  const std::size_t open = name.find('[');
  if (open == name.npos) return IndexedName{name};
  if (!name.ends_with(']')) return std::nullopt;
  IndexedName indexed{name.substr(0, open)};
  std::string_view list = name.substr(open + 1, name.size() - open - 2);
  while (true) {
    const std::size_t comma = std::min(list.find(','), list.size());
    std::string_view one = list.substr(0, comma);
    while (one.starts_with(' ')) one.remove_prefix(1);
    const auto number = NumberFrom<std::size_t>(one);
    if (!number || *number == 0 || *number > kMaxPlaces) return std::nullopt;
    indexed.indices.push_back(*number - 1);
    if (comma == list.size()) return indexed;
    list.remove_prefix(comma + 1);
  }
}

std::optional<std::size_t> PlaceInVector(std::span<const std::size_t> indices) {
  if (indices.size() == 1) return indices[0];
  if (indices.size() == 2 && (indices[0] == 0 || indices[1] == 0)) return indices[0] + indices[1];
  return std::nullopt;
}

std::optional<IndexedName> WithoutIndex(std::string_view name, std::string_view axes) {
  auto indexed = WithoutBrackets(name);
  if (!indexed || !indexed->indices.empty() || name.size() < 3) return indexed;
  const char separator = name[name.size() - 2];
  const std::size_t axis = axes.find(name.back());
  if ((separator == '_' || separator == '.') && axis != axes.npos)
    return IndexedName{name.substr(0, name.size() - 2), {axis}};
  return indexed;
}

std::optional<std::vector<FmuSignal>> SignalsOf(std::string_view name, std::size_t size) {
  std::optional<std::vector<FmuSignal>> signals;
  std::string_view rest = name;
  if (TakePrefix(rest, kNeighbour)) {
    signals = OfNeighbours(rest, size);
  } else if (const auto field = FieldIn(kOwnFields, name)) {
    signals = Elements(*field->row, 0, field->indices, size);
  }
  if (signals && signals->size() != size) signals->clear();
  return signals;
}

std::vector<std::string> SignalNames(std::size_t places) {
  std::vector<std::string> names;
  const auto add = [&](std::string_view of, std::span<const FieldRow> rows) {
    for (const FieldRow& row : rows) {
      names.push_back(fmt::format("{}{}", of, row.name));
      for (std::size_t k = 0; k < row.axes.size(); ++k) names.push_back(fmt::format("{}{}[{}]", of, row.name, k + 1));
    }
  };
  add("", kOwnFields);
  for (std::size_t place = 1; place <= places; ++place) add(fmt::format("neighbour[{}].", place), kNeighbourFields);
  return names;
}

double FmuSignal::Value(const Perception& now) const {
  const auto k = static_cast<Eigen::Index>(element);
  switch (field) {
    case FmuField::kTime:
      return now.t_s;
    case FmuField::kId:
      return now.id;
    case FmuField::kPosition:
      return now.self->p_WB[k];
    case FmuField::kVelocity:
      return now.self->v_WB[k];
    case FmuField::kAttitude:
      return Attitude(now.self->q_WB, element);
    default:
      break;
  }
  const Heard* const heard = place < now.places.size() ? now.places[place] : nullptr;
  if (heard == nullptr) return 0;
  switch (field) {
    case FmuField::kNeighbourId:
      return heard->id;
    case FmuField::kNeighbourPosition:
      return heard->motion.p_WB[k];
    case FmuField::kNeighbourVelocity:
      return heard->motion.v_WB[k];
    case FmuField::kWeight:
      return heard->weight;
    case FmuField::kAge:
      return heard->age_s;
    case FmuField::kMessage:
      return element < heard->message.size() ? heard->message[element] : 0;
    default:
      return 1;  // heard
  }
}

}  // namespace mascot

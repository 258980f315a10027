#include "orchestrator/formats/outside_fields.h"

#include <fmt/format.h>

#include <limits>

#include "orchestrator/formats/outside_json.h"

namespace mascot {
namespace {

/// The value as a message quotes it.
std::string QuoteOf(const nlohmann::ordered_json* value) {
  constexpr std::size_t kLongestQuote = 60;
  if (value == nullptr) return "nothing";
  if (value->is_structured()) return value->is_array() ? "a list" : "an object";
  if (value->is_string() && value->get_ref<const std::string&>().size() > kLongestQuote) return "a longer text";
  return value->dump(-1, ' ', /*ensure_ascii=*/true, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace

const nlohmann::ordered_json* OutsideFields::Find(const char* field) const {
  const auto found = object_.find(field);
  return found == object_.end() ? nullptr : &*found;
}

void OutsideFields::Refuse(const char* field, const std::string& expected) {
  if (mistake_.empty()) mistake_ = fmt::format("expected {} as \"{}\", got {}", expected, field, QuoteOf(Find(field)));
}

void OutsideFields::Require() const {
  if (!are_good()) throw JsonError(mistake_);
}

std::string OutsideFields::Text(const char* field, std::size_t longest) {
  const Object* value = Find(field);
  if (value != nullptr && value->is_string() && value->get_ref<const std::string&>().size() <= longest)
    return value->get<std::string>();
  Refuse(field, fmt::format("a text of at most {} bytes", longest));
  return "";
}

bool OutsideFields::Boolean(const char* field) {
  const Object* value = Find(field);
  if (value != nullptr && value->is_boolean()) return value->get<bool>();
  Refuse(field, "true or false");
  return false;
}

double OutsideFields::Number(const char* field, double least, double most) {
  const Object* value = Find(field);
  const double number =
      value != nullptr && value->is_number() ? value->get<double>() : std::numeric_limits<double>::quiet_NaN();
  if (number >= least && number <= most) return number;
  Refuse(field, fmt::format("a number in [{:g}, {:g}]", least, most));
  return least;
}

std::int64_t OutsideFields::Integer(const char* field, std::int64_t least, std::int64_t most) {
  const Object* value = Find(field);
  // An integer beyond 2^63 is unsigned, and one beyond 2^64 a floating-point number.
  const bool is_integer =
      value != nullptr && value->is_number_integer() &&
      !(value->is_number_unsigned() &&
        value->get<std::uint64_t>() > static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()));
  const std::int64_t number = is_integer ? value->get<std::int64_t>() : least;
  if (is_integer && number >= least && number <= most) return number;
  Refuse(field, fmt::format("an integer in [{}, {}]", least, most));
  return least;
}

const nlohmann::ordered_json& OutsideFields::List(const char* field, std::size_t most) {
  static const Object kNone = Object::array();
  const Object* value = Find(field);
  if (value != nullptr && value->is_array() && value->size() <= most) return *value;
  Refuse(field, fmt::format("a list of at most {} values", most));
  return kNone;
}

}  // namespace mascot

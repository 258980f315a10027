#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

namespace mascot {

/// What ReadJson() takes.
struct JsonLimits {
  std::size_t bytes = std::size_t{64} << 20;
  int depth = 64;  ///< lists and objects in each other
};

/// Text that is not to be read as JSON. what() says what there is instead: "text that is no JSON (byte 7)".
class JsonError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The value that `text` holds. Whatever a socket, a file or a pipe brings is read here and nowhere else: a value that
/// is nested too deeply is refused before it is built, because whoever compares, copies or prints a value calls itself
/// once a level, and a message of a megabyte can hold half a million levels. Throws JsonError.
/// Json: nlohmann::json or nlohmann::ordered_json.
template <class Json>
Json ReadJson(std::string_view text, const JsonLimits& limits = {});

/// As ReadJson(), for readers who look at the kind of a value anyway: null for what it refuses.
template <class Json>
Json JsonOrNull(std::string_view text, const JsonLimits& limits = {}) {
  try {
    return ReadJson<Json>(text, limits);
  } catch (const JsonError&) {
    return nullptr;
  }
}

/// The object in a line that another process sent, of few levels; nothing: it is none. How long lines may be decides
/// who reads them; OutsideFields reads the fields.
std::optional<nlohmann::ordered_json> ObjectOrNothing(std::string_view line);

}  // namespace mascot

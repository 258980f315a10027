#pragma once

#include <charconv>
#include <optional>
#include <string_view>
#include <system_error>

namespace mascot {

/// All of `text` as a number, whatever the locale; nothing if it is something else or too large: " 1", "+1", "1x".
template <class Number>
std::optional<Number> NumberFrom(std::string_view text) {
  Number number{};
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  return error == std::errc() && rest == end ? std::optional(number) : std::nullopt;
}

}  // namespace mascot

#include "orchestrator/live/server/address.h"

#include <algorithm>
#include <cctype>

#include "base/number.h"
#include "experiment/toml/section.h"

namespace mascot {
namespace {

bool IsHost(const std::string& text) {
  return std::ranges::all_of(text,
                             [](unsigned char c) { return std::isalnum(c) != 0 || c == '.' || c == '-' || c == ':'; });
}

}  // namespace

LiveAddress ReadLiveAddress(const std::string& text, const std::string& option) {
  const bool is_number = !text.empty() && text.find_first_not_of("0123456789") == std::string::npos;
  const auto fail = [&] {
    throw ConfigError({option + ": expected ADDRESS:PORT (such as 127.0.0.1:8765), got \"" + text + "\"" +
                       (is_number ? " (a port alone is :" + text + ")" : "")});
  };
  LiveAddress at;
  const bool is_bracketed = text.starts_with('[');
  const auto closing = is_bracketed ? text.find(']') : 0;
  if (closing == std::string::npos) fail();
  const auto colon = text.find(':', closing);
  std::string host = text.substr(0, colon);
  if (is_bracketed) host = text.substr(1, closing - 1);
  if (is_bracketed && colon != closing + 1 && closing + 1 != text.size()) fail();
  if (!IsHost(host) || is_number || (!is_bracketed && host.ends_with(".toml"))) fail();
  if (!host.empty()) at.address = host;
  if (colon == std::string::npos) return at;
  const auto port = NumberFrom<decltype(at.port)>(std::string_view(text).substr(colon + 1));
  if (!port) fail();
  at.port = *port;
  return at;
}

}  // namespace mascot

#include "orchestrator/live/origin.h"

#include <arpa/inet.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>

namespace mascot {
namespace {

std::string Lower(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

/// The name or address in a Host header: without the port, an IPv6 address without its brackets.
std::string WithoutPort(std::string_view host) {
  if (host.starts_with('[')) return Lower(host.substr(1, host.find(']') - 1));
  return Lower(host.substr(0, host.find(':')));
}

bool IsIpAddress(const std::string& text) {
  std::array<unsigned char, sizeof(in6_addr)> address{};
  return inet_pton(AF_INET, text.c_str(), address.data()) == 1 ||
         inet_pton(AF_INET6, text.c_str(), address.data()) == 1;
}

std::string NameOfThisMachine() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? Lower(name.data()) : "";
}

}  // namespace

bool IsOurHost(std::string_view host, std::string_view name) {
  const std::string asked = WithoutPort(host);
  if (asked.empty()) return false;
  return asked == "localhost" || IsIpAddress(asked) || asked == Lower(name) || asked == NameOfThisMachine();
}

bool MayTalk(std::string_view origin, std::string_view host) {
  if (origin.empty()) return true;
  const auto colon = origin.find("://");
  if (colon == std::string_view::npos) return false;  // "null": a page that hides where it is from
  const std::string scheme = Lower(origin.substr(0, colon));
  if (scheme != "http" && scheme != "https") return true;
  return Lower(origin.substr(colon + 3)) == Lower(host);
}

}  // namespace mascot

#include "orchestrator/live/server/origin.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <utility>

#include "base/after_last.h"
#include "base/number.h"
#include "base/utf8.h"
#include "experiment/toml/section.h"

namespace mascot {
namespace {

constexpr std::string_view kFile = "file://";
constexpr std::size_t kLongestQuoted = 100;  // of what a client sent, in the log
constexpr std::size_t kMaxKinds = 20;        // of refusals

struct Scheme {
  std::string_view prefix;
  int port;
};
constexpr Scheme kSchemes[] = {{"http://", 80}, {"https://", 443}};

std::string Lower(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

std::string Quoted(std::string_view text) {
  const bool is_long = text.size() > kLongestQuoted;
  return "'" + PlainLine(text.substr(0, kLongestQuoted)) + (is_long ? "..." : "") + "'";
}

bool IsIpV4(const std::string& host) {
  in_addr address{};
  return inet_pton(AF_INET, host.c_str(), &address) == 1;
}

/// "[::1]" in its shortest form. Nothing for what is no address, or one of IPv4 in disguise.
std::optional<std::string> ReadIpV6(std::string_view text) {
  in6_addr address{};
  if (text.size() < 4 || !text.starts_with('[') || !text.ends_with(']')) return std::nullopt;
  const std::string inner(text.substr(1, text.size() - 2));
  if (inner.find('\0') != inner.npos || inet_pton(AF_INET6, inner.c_str(), &address) != 1) return std::nullopt;
  if (IN6_IS_ADDR_V4MAPPED(&address) || IN6_IS_ADDR_V4COMPAT(&address)) return std::nullopt;
  std::array<char, INET6_ADDRSTRLEN> shortest{};
  inet_ntop(AF_INET6, &address, shortest.data(), shortest.size());
  return "[" + std::string(shortest.data()) + "]";
}

/// Labels of letters, digits and hyphens (RFC 1123), in lower case. Nothing for other text, such as a number that some
/// programs take for an address: 2130706433, 0x7f.1, 127.1.
std::optional<std::string> ReadName(std::string_view text) {
  std::string name = Lower(text);
  if (IsIpV4(name)) return name;
  const auto is_of_name = [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '.'; };
  const bool is_name = !name.empty() && name.size() < 254 && std::ranges::all_of(name, is_of_name) &&
                       name.front() != '.' && name.back() != '.' && name.find("..") == name.npos;
  const std::string_view last = AfterLast(name, '.');
  const bool is_number =
      last.starts_with("0x") || std::ranges::all_of(last, [](unsigned char c) { return std::isdigit(c) != 0; });
  return is_name && !is_number ? std::optional(std::move(name)) : std::nullopt;
}

std::string NameOfThisMachine() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? Lower(name.data()) : "";
}

/// An address or a name as a URL has it: IPv6 in brackets.
std::string AsInUrl(std::string_view address) {
  const bool is_bare_v6 = address.find(':') != address.npos && !address.starts_with('[');
  const std::string text = is_bare_v6 ? "[" + std::string(address) + "]" : std::string(address);
  return ReadIpV6(text).value_or(Lower(text));
}

/// Whether a page of `origin` (ReadOrigin()) came from `ours`.
bool IsSame(std::string_view origin, const HostAndPort& ours) {
  return std::ranges::any_of(kSchemes, [&](const Scheme& scheme) {
    if (!origin.starts_with(scheme.prefix)) return false;
    const auto page = ReadHostAndPort(origin.substr(scheme.prefix.size()));
    return page && page->host == ours.host && page->port.value_or(scheme.port) == ours.port.value_or(scheme.port);
  });
}

}  // namespace

bool IsLoopback(const std::string& host) {
  return host == "localhost" || host == "[::1]" || (IsIpV4(host) && host.starts_with("127."));
}

std::optional<HostAndPort> ReadHostAndPort(std::string_view text) {
  const auto end_of_host = text.starts_with('[') ? text.find(']') : text.find(':');
  const std::size_t size = text.starts_with('[') && end_of_host != text.npos ? end_of_host + 1 : end_of_host;
  const std::string_view host = text.substr(0, size), rest = text.substr(std::min(text.size(), host.size()));
  HostAndPort read;
  const auto name = host.starts_with('[') ? ReadIpV6(host) : ReadName(host);
  if (!name) return std::nullopt;
  read.host = *name;
  if (rest.empty()) return read;
  const std::string_view digits = rest.substr(1);
  const auto port = NumberFrom<int>(digits);
  const bool is_port = rest.front() == ':' && port && *port >= 1 && *port <= 65535 &&
                       std::ranges::all_of(digits, [](unsigned char c) { return std::isdigit(c) != 0; });
  if (!is_port) return std::nullopt;
  read.port = *port;
  return read;
}

std::optional<std::string> ReadOrigin(std::string_view text) {
  const std::string lower = Lower(text);
  for (const Scheme& scheme : kSchemes) {
    if (!lower.starts_with(scheme.prefix)) continue;
    const auto read = ReadHostAndPort(std::string_view(lower).substr(scheme.prefix.size()));
    if (!read) return std::nullopt;
    const bool has_port = read->port && *read->port != scheme.port;
    return std::string(scheme.prefix) + read->host + (has_port ? ":" + std::to_string(*read->port) : "");
  }
  return std::nullopt;
}

std::string ReadAllowedOrigin(const std::string& text) {
  if (text == kFile) return text;
  if (auto origin = ReadOrigin(text)) return *std::move(origin);
  throw ConfigError({"--allow-origin: expected the origin of a page, such as https://app.foxglove.dev, or " +
                     std::string(kFile) + ", got " + Quoted(text)});
}

OriginCheck::OriginCheck(std::string_view asked, std::string_view bound, std::vector<std::string> allowed)
    : allowed_(std::move(allowed)) {
  names_ = {AsInUrl(asked), AsInUrl(bound)};
  any_address_ =
      std::ranges::any_of(names_, [](const std::string& name) { return name == "0.0.0.0" || name == "[::]"; });
  const bool is_reached_from_elsewhere = !IsLoopback(AsInUrl(bound));
  if (const std::string name = NameOfThisMachine(); is_reached_from_elsewhere && !name.empty()) names_.push_back(name);
}

bool OriginCheck::IsOurs(const std::string& host) const {
  if (IsLoopback(host) || std::ranges::find(names_, host) != names_.end()) return true;
  return any_address_ && (IsIpV4(host) || host.starts_with('['));  // no page can be of another machine's address
}

std::optional<OriginCheck::Refusal> OriginCheck::Judge(const Caller& caller) const {
  if (!caller.target.starts_with('/'))
    return Refusal{400, "expected a path\n", "a request for something that is no path"};
  if (caller.hosts.size() != 1) return Refusal{400, "expected one Host\n", "a request without a Host, or with several"};
  const auto host = ReadHostAndPort(caller.hosts.front());
  if (!host || !IsOurs(host->host))
    return Refusal{403, "this server is not called so\n",
                   "a request to " + Quoted(caller.hosts.front()) + ", which is not the address of this server"};
  if (caller.origins.empty()) return std::nullopt;
  const std::string_view from = caller.origins.front();
  const auto origin = from == kFile ? std::optional(std::string(from)) : ReadOrigin(from);
  const bool is_allowed = origin && (std::ranges::find(allowed_, *origin) != allowed_.end() || IsSame(*origin, *host));
  if (is_allowed && caller.origins.size() == 1) return std::nullopt;
  const std::string answer = "a page from elsewhere may not talk to this server; its terminal says how to let it in\n";
  if (caller.origins.size() > 1) return Refusal{403, answer, "a page with several origins"};
  if (!origin) return Refusal{403, answer, "a page of " + Quoted(from) + ", which is no address of a page"};
  return Refusal{403, answer, fmt::format("a page of {0} (--allow-origin {0} lets it in)", *origin)};
}

std::optional<std::string> RefusalCount::Line(const std::string& words) {
  const bool is_known = times_.contains(words) || times_.size() < kMaxKinds;
  const std::string kind = is_known ? words : "others";
  const std::size_t times = ++times_[kind];
  std::size_t power = 1;
  while (power < times) power *= 10;
  if (power != times) return std::nullopt;
  return times == 1 ? kind : fmt::format("{}, {} times", kind, times);
}

}  // namespace mascot

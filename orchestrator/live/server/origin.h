#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mascot {

/// A host and perhaps a port, as a Host header or a URL names them.
struct HostAndPort {
  std::string host = {};      ///< lower case; an IPv6 address in brackets, in its shortest form
  std::optional<int> port{};  ///< nothing: that of the scheme
};

/// Reads "localhost:8765", "127.0.0.1" or "[::1]:8765" and nothing else: a name of letters, digits, dots and hyphens,
/// or an address; a port from 1 to 65535. Nothing for whatever else the text holds.
std::optional<HostAndPort> ReadHostAndPort(std::string_view text);

/// The origin of a web page (RFC 6454), "https://app.foxglove.dev", as browsers write it: in lower case, without the
/// scheme's own port. Nothing unless it is a scheme http or https with a host and perhaps a port.
std::optional<std::string> ReadOrigin(std::string_view text);

/// What --allow-origin names: an origin, or "file://", which desktop programs made of a browser send, and so may pages
/// that were opened from a disk. Throws ConfigError.
std::string ReadAllowedOrigin(const std::string& text);

/// The part of a request that says who speaks to whom. Each list has all headers of its name.
struct Caller {
  std::vector<std::string_view> hosts = {}, origins = {};
  std::string_view target = {};
};

/// Decides who may speak to a server that listens on this machine. A browser sends the address of the page that asks
/// (Origin) and the name under which it knows us (Host); no page from elsewhere may steer a run, and none whose name
/// was made to lead here (DNS rebinding). Programs that are no browsers send no Origin.
class Doorkeeper {
 public:
  struct Refusal {
    unsigned status = 403;
    std::string answer;  ///< for the client; holds nothing of what it sent
    std::string words;   ///< for the log, in one line: who was refused, and how to let it in
  };

  /// `asked`: the address at which the user asked us to listen, and `bound`: the one that came of it. `allowed`:
  /// origins that may speak to us too (ReadAllowedOrigin()).
  Doorkeeper(std::string_view asked, std::string_view bound, std::vector<std::string> allowed);

  /// Nothing: it may.
  std::optional<Refusal> Judge(const Caller& caller) const;

 private:
  bool IsOurs(const std::string& host) const;

  std::vector<std::string> names_;  // of this server
  bool any_address_ = false;        // it listens at every address of this machine
  std::vector<std::string> allowed_;
};

/// Decides which refusals are said, so that a flood of them is no flood of lines: of each kind the first, the tenth,
/// the hundredth ...
class RefusalCount {
 public:
  /// The line to say, if any: `words`, with their number from the tenth on.
  std::optional<std::string> Line(const std::string& words);

 private:
  std::map<std::string, std::size_t> times_;  // of the first kinds; all others are one
};

}  // namespace mascot

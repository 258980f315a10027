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
  std::optional<int> port{};  ///< nothing: the port of the scheme
};

/// Reads "localhost:8765", "127.0.0.1" or "[::1]:8765" and nothing else: a name of letters, digits, dots and hyphens,
/// or an address; a port from 1 to 65535. Nothing for any other text.
std::optional<HostAndPort> ReadHostAndPort(std::string_view text);

/// Whether a host, as in HostAndPort, is reached from this machine alone.
bool IsLoopback(const std::string& host);

/// The origin of a web page (RFC 6454), "https://app.foxglove.dev", as browsers write it: in lower case, without the
/// scheme's own port. Nothing unless it is a scheme http or https with a host and perhaps a port.
std::optional<std::string> ReadOrigin(std::string_view text);

/// What --allow-origin names: an origin, or "file://", which desktop programs made of a browser send, and so may pages
/// that were opened from a disk. Throws ConfigError.
std::string ReadAllowedOrigin(const std::string& text);

/// The headers of a request that name its page and its server. Each list has all headers of its name.
struct Caller {
  std::vector<std::string_view> hosts = {}, origins = {};
  std::string_view target = {};
};

/// Decides which requests a server that listens on this machine answers. A browser sends the address of the page that
/// asks (Origin) and the name under which it knows this server (Host). No page of another server may steer a run, and
/// none whose name was made to lead here (DNS rebinding). Programs that are not browsers send no Origin.
class OriginCheck {
 public:
  struct Refusal {
    unsigned status = 403;
    std::string answer;  ///< for the client; it holds nothing of the client's request
    std::string words;   ///< for the log, in one line: which page was refused, and how to let it in
  };

  /// `asked` is the address that the user has named, `bound` the one at which the server listens. `allowed` are further
  /// origins that may speak to it (ReadAllowedOrigin()).
  OriginCheck(std::string_view asked, std::string_view bound, std::vector<std::string> allowed);

  /// Why the request is refused. Nothing: it is not.
  std::optional<Refusal> Judge(const Caller& caller) const;

 private:
  bool IsOurs(const std::string& host) const;

  std::vector<std::string> names_;  // names of this server
  bool any_address_ = false;        // the server listens at every address of this machine
  std::vector<std::string> allowed_;
};

/// Decides which refusals get a line in the log, so that a flood of them is not a flood of lines: of each kind the
/// first, the tenth, the hundredth ...
class RefusalCount {
 public:
  /// The line for the log, if any: `words`, with the number of such refusals from the tenth on.
  std::optional<std::string> Line(const std::string& words);

 private:
  std::map<std::string, std::size_t> times_;  // of the first kinds; all others are one
};

}  // namespace mascot

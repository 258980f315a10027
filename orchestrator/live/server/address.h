#pragma once

#include <cstdint>
#include <string>

namespace mascot {

/// Where to listen.
struct LiveAddress {
  std::string address = "127.0.0.1";  ///< an IP address or a name
  std::uint16_t port = 8765;          ///< Foxglove's own; 0: any free one
};

/// Reads "ADDRESS:PORT", "ADDRESS", ":PORT" or "[IPv6]:PORT"; empty text: the default. Throws ConfigError, with
/// "OPTION: expected ..., got ...".
LiveAddress ReadLiveAddress(const std::string& text, const std::string& option = "--view");

}  // namespace mascot

#pragma once

#include <string>
#include <string_view>

namespace mascot {

/// Whether a request with this Host header is meant for us: an IP address, "localhost", the name of this machine, or
/// `name`, by which the user asked us to listen; with any port, because ports are forwarded. Other names may be those
/// of a web site that had its name lead to this machine (DNS rebinding).
bool IsOurHost(std::string_view host, std::string_view name);

/// Whether a request with this Origin header may talk to us. A browser sends it with the address of the page that
/// asks: only our own page may (`host`: the Host header of the same request). Programs that are no browsers send none,
/// or one that no web page can have, such as file://.
bool MayTalk(std::string_view origin, std::string_view host);

}  // namespace mascot

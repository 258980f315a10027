#include "system/local_socket.h"

#include <pwd.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <stdexcept>

namespace mascot {
namespace {

/// Calls `call`, which is bind() or connect(), with a socket and an abstract name.
template <class Call>
bool WithName(const std::string& name, const Descriptor& socket, Call call) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  std::ranges::copy(name, address.sun_path + 1);  // an abstract name begins with a zero byte
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + 1 + name.size());
  return call(socket.number(), reinterpret_cast<const sockaddr*>(&address), size) == 0;
}

}  // namespace

Descriptor MakeLocalSocket(int flags) {
  Descriptor made(::socket(AF_UNIX, SOCK_STREAM | flags, 0));
  if (!made.is_open()) throw std::runtime_error(std::string("cannot make a socket: ") + std::strerror(errno));
  return made;
}

bool ListenAs(const std::string& name, const Descriptor& socket) {
  return WithName(name, socket, ::bind) && ::listen(socket.number(), SOMAXCONN) == 0;
}

bool ConnectTo(const std::string& name, const Descriptor& socket) { return WithName(name, socket, ::connect); }

std::optional<ucred> PeerOf(const Descriptor& connection) {
  ucred peer{};
  socklen_t size = sizeof peer;
  if (::getsockopt(connection.number(), SOL_SOCKET, SO_PEERCRED, &peer, &size) != 0) return std::nullopt;
  return peer;
}

bool IsTrusted(const ucred& peer) { return peer.uid == ::geteuid() || peer.uid == 0; }

bool HasNoRoom(int error) { return error == EMFILE || error == ENFILE || error == ENOBUFS || error == ENOMEM; }

std::string UserName(uid_t user) {
  const passwd* entry = ::getpwuid(user);
  return entry != nullptr ? entry->pw_name : std::to_string(user);
}

}  // namespace mascot

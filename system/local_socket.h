#pragma once

#include <sys/socket.h>
#include <sys/types.h>

#include <optional>
#include <string>

#include "system/descriptor.h"

namespace mascot {

// Stream sockets between processes of this machine, with abstract names (unix(7)): a name is in no folder, so that no
// file is left, or can be in the way. One socket at a time can have a name, of whatever user. Each network namespace
// has names of its own.

/// Makes a socket. `flags`: SOCK_CLOEXEC, without which children inherit it, and others of socket(2). Throws
/// std::runtime_error.
Descriptor MakeLocalSocket(int flags);
/// Gives the socket this name and listens. Returns whether it listens; if not, errno says why.
bool ListenAs(const std::string& name, const Descriptor& socket);
/// Connects the socket with the socket that has this name. Returns whether it is connected; if not, errno says why:
/// EAGAIN if the listening socket has too many connections that are not accepted yet, and this socket does not wait
/// (SOCK_NONBLOCK).
bool ConnectTo(const std::string& name, const Descriptor& socket);
/// The process at the other end of a connection: the one that connected, or the one that listens. Nothing: the kernel
/// does not say.
std::optional<ucred> PeerOf(const Descriptor& connection);
/// Whether to speak with this process at all: whether it belongs to our user, or to root, who may do anything to us
/// anyway. The name of a socket does not say which user has it, because any user can take any name.
bool IsTrusted(const ucred& peer);
/// Whether accept(2) failed with this errno because this process or the machine has no descriptor, or no memory, left:
/// accept(2) then fails again, and at once, until there is some.
bool HasNoRoom(int error);
/// The name of a user, or the number if the user has no name.
std::string UserName(uid_t user);

}  // namespace mascot

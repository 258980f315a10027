// For programs that qemu-user runs (scripts/arm64 run): qemu 7.2 does not know the option of sockets that tells by
// which interface multicast leaves, and Fast DDS then sends nothing at all. Without it, multicast leaves by the
// interface that the routes of this machine say.
#include <dlfcn.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <cerrno>

extern "C" int setsockopt(int socket, int level, int name, const void* value, socklen_t size) noexcept {
  using Function = int (*)(int, int, int, const void*, socklen_t);
  static const auto next = reinterpret_cast<Function>(dlsym(RTLD_NEXT, "setsockopt"));
  const int result = next(socket, level, name, value, size);
  const bool is_unknown = result != 0 && errno == ENOPROTOOPT && level == IPPROTO_IP && name == IP_MULTICAST_IF;
  return is_unknown ? 0 : result;
}

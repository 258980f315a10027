// Preloaded into programs: a process whose name is $MASCOT_KILLED is killed at the moment at which it has written
// $MASCOT_KILLED_AT: neither earlier nor later, however busy the machine is.

#include <dlfcn.h>
#include <errno.h>
#include <signal.h>
#include <sys/uio.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string_view>

namespace {

/// The function of this name in the C library.
template <class Function>
Function* Real(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

bool IsTheMoment(std::string_view text) {
  const char *process = std::getenv("MASCOT_KILLED"), *moment = std::getenv("MASCOT_KILLED_AT");
  return process != nullptr && moment != nullptr && std::strcmp(process, program_invocation_short_name) == 0 &&
         text.find(moment) != std::string_view::npos;
}

void EndIf(bool is_the_moment) {
  if (is_the_moment) kill(getpid(), SIGKILL);
}

/// Kills this process if `text` is what it waits for, once all that was given to `file` is written.
void EndIfWritten(std::string_view text, FILE* file) {
  if (!IsTheMoment(text)) return;
  std::fflush(file);
  EndIf(true);
}

}  // namespace

extern "C" {
ssize_t write(int descriptor, const void* bytes, std::size_t count) {
  const ssize_t written = Real<decltype(write)>("write")(descriptor, bytes, count);
  EndIf(IsTheMoment({static_cast<const char*>(bytes), count}));
  return written;
}

ssize_t writev(int descriptor, const iovec* parts, int count) {
  const ssize_t written = Real<decltype(writev)>("writev")(descriptor, parts, count);
  for (int k = 0; k < count; ++k) EndIf(IsTheMoment({static_cast<const char*>(parts[k].iov_base), parts[k].iov_len}));
  return written;
}

std::size_t fwrite(const void* bytes, std::size_t size, std::size_t count, FILE* file) {
  const std::size_t written = Real<decltype(fwrite)>("fwrite")(bytes, size, count, file);
  EndIfWritten({static_cast<const char*>(bytes), size * count}, file);
  return written;
}

std::size_t fwrite_unlocked(const void* bytes, std::size_t size, std::size_t count, FILE* file) {
  const std::size_t written = Real<decltype(fwrite_unlocked)>("fwrite_unlocked")(bytes, size, count, file);
  EndIfWritten({static_cast<const char*>(bytes), size * count}, file);
  return written;
}
}

#include "system/failure.h"

#include <cxxabi.h>
#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <new>
#include <system_error>

#include "system/end_now.h"

namespace mascot {
namespace {

/// What stands before and after what() of an exception.
struct Words {
  const char *before = "", *after = "";
};

Words WordsFor(const std::exception& failure) {
  if (dynamic_cast<const std::bad_alloc*>(&failure) != nullptr)
    return {"out of memory (", "); is there a limit, such as ulimit -v?"};
  const auto* refused = dynamic_cast<const std::system_error*>(&failure);
  if (refused != nullptr && refused->code() == std::errc::resource_unavailable_try_again)
    return {"no thread can be started (", "); is there a limit, such as ulimit -u or -v?"};
  if (refused != nullptr &&
      refused->code() == std::errc::invalid_argument)  // Fast DDS joins a thread it could not start
    return {"a thread was not started (", "); is there a limit, such as ulimit -u or -v?"};
  return {};
}

/// A signal handler, called once: then SIGBUS ends the process.
void ExplainBusError(int signal) {
  constexpr char kWords[] = "error: /dev/shm is probably full: its memory cannot be had (SIGBUS)\n";
  if (write(STDERR_FILENO, kWords, sizeof kWords - 1) < 0) EndNow(128 + signal);
  raise(signal);
}

/// Prints what others have said, without memory: a byte that is no printable ASCII as "\x1b".
void PrintPlain(const char* text) {
  for (; *text != '\0'; ++text) {
    const auto byte = static_cast<unsigned char>(*text);
    if ((byte >= ' ' && byte < 0x7F) || byte == '\n' || byte == '\t')
      std::fputc(byte, stderr);
    else
      std::fprintf(stderr, "\\x%02x", static_cast<unsigned>(byte));
  }
}

/// What is said of an exception that is no std::exception, before the name of its type.
constexpr const char* kOther = "an exception of the C++ type ";

/// The name of the type of the exception that is being handled: the compiler's, such as "i" for int, if there is no
/// memory for another.
class CaughtType {
 public:
  const char* name() const { return readable_ ? readable_.get() : mangled_; }

 private:
  const char* const mangled_ = abi::__cxa_current_exception_type()->name();
  int status_ = 0;
  const std::unique_ptr<char, void (*)(void*)> readable_{abi::__cxa_demangle(mangled_, nullptr, nullptr, &status_),
                                                         std::free};
};

/// A terminate handler. There may be no memory for a string.
[[noreturn]] void SayAndExit() {
  try {
    if (const auto uncaught = std::current_exception()) std::rethrow_exception(uncaught);
    std::fputs("error: the program ended itself (std::terminate)\n", stderr);
  } catch (const std::exception& failure) {
    const Words words = WordsFor(failure);
    for (const char* piece : {"error: ", words.before, failure.what(), words.after, "\n"}) PrintPlain(piece);
  } catch (...) {
    const CaughtType type;
    for (const char* piece : {"error: ", kOther, type.name(), ", which nothing in ",
                              static_cast<const char*>(program_invocation_short_name), " has caught\n"})
      PrintPlain(piece);
  }
  EndNow(1);
}

}  // namespace

void SayWhatIsUncaught() {
  std::set_terminate(SayAndExit);
  struct sigaction action {};
  action.sa_handler = ExplainBusError;
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGBUS, &action, nullptr);
}

std::string InWords(const std::exception& failure) {
  const Words words = WordsFor(failure);
  return std::string(words.before) + failure.what() + words.after;
}

std::string CaughtInWords() {
  try {
    throw;
  } catch (const std::exception& failure) {
    return InWords(failure);
  } catch (...) {
    return std::string(kOther) + CaughtType().name();
  }
}

}  // namespace mascot

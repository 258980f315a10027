#pragma once

// What instances of FMI 2 and FMI 3 share: functions of the library, and what their answers mean.

#include <dlfcn.h>
#include <fmt/format.h>

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "agent/fmi/error.h"
#include "agent/fmi/instance.h"
#include "base/utf8.h"

namespace mascot {

/// What functions of an FMU return: the same numbers in FMI 2 and FMI 3.
enum FmuStatus : int { kFmuOk, kFmuWarning, kFmuDiscard, kFmuError, kFmuFatal, kFmuPending };

inline std::string_view NameOfFmuStatus(int status) {
  constexpr std::string_view kNames[] = {"OK", "warning", "discard", "error", "fatal", "pending"};
  return status >= 0 && status <= kFmuPending ? kNames[status] : "an unknown status";
}

/// Looks up a function of the library that an FMU may leave out; null if it is missing.
template <class Function>
Function OptionalFmuFunction(const FmuLibrary& library, const std::string& name) {
  return reinterpret_cast<Function>(::dlsym(library.handle, name.c_str()));
}

/// Looks up a function of the library. Throws FmuError if it is missing.
template <class Function>
Function FmuFunction(const FmuLibrary& library, const std::string& name) {
  const auto function = OptionalFmuFunction<Function>(library, name);
  if (function == nullptr) throw FmuError("its library has no function " + name);
  return function;
}

/// The function, which OptionalFmuFunction() has looked up. Throws FmuError if it was missing.
template <class Function>
Function Present(Function function, std::string_view name) {
  if (function == nullptr) throw FmuError("its library has no function " + std::string(name));
  return function;
}

/// Lets an instance log warnings and errors, if its description has categories for them. `Bool`: the type of booleans.
template <class Bool>
void LogErrors(const FmuLibrary& library, const std::string& function, void* instance) {
  using SetDebugLogging = int (*)(void* instance, Bool on, std::size_t count, const char* const* categories);
  const auto set = OptionalFmuFunction<SetDebugLogging>(library, function);
  std::vector<const char*> names;
  for (const std::string& category : library.model.error_categories) names.push_back(category.c_str());
  // Its answer says nothing of flight: an instance that does not log is flown as well.
  if (set != nullptr && !names.empty()) set(instance, Bool{1}, names.size(), names.data());
}

/// Keeps what an FMU logs: the last words for the message of an error, and warnings and errors for the log.
class FmuWords {
 public:
  FmuWords(const FmuLibrary& library, FmuLog log) : is_dead_(library.is_dead), log_(std::move(log)) {}
  /// Called by callbacks from C: lets no exception out.
  void Take(int status, const char* category, const char* message) noexcept {
    try {
      const std::string words = Shortened(PlainLine(message != nullptr ? message : ""), kLongest);
      if (status >= kFmuDiscard) last_ = words;
      if (status == kFmuOk || lines_ > kMost) return;
      if (lines_++ == kMost) return log_("(no more of its words are shown)");
      const std::string of = category != nullptr && *category != '\0' ? fmt::format(" ({})", PlainLine(category)) : "";
      log_(fmt::format("{}{}: {}", NameOfFmuStatus(status), of, words));
    } catch (...) {  // NOLINT(bugprone-empty-catch): there is no memory for words, and C code waits
    }
  }
  /// Throws FmuError unless the call of `function` has succeeded.
  void Require(int status, std::string_view function) {
    if (status == kFmuOk || status == kFmuWarning) {
      last_.clear();
      return;
    }
    has_failed_ = has_failed_ || status == kFmuError || status == kFmuFatal;
    if (status == kFmuFatal) *is_dead_ = true;
    Fail(function, NameOfFmuStatus(status));
  }
  [[noreturn]] void Fail(std::string_view function, std::string_view what) const {
    throw FmuError(fmt::format("{}: {}{}", function, what, last_.empty() ? "" : ": " + last_));
  }
  /// Whether the instance has had an error: it may only be freed.
  bool has_failed() const { return has_failed_; }
  bool is_dead() const { return *is_dead_; }  ///< as FmuLibrary has it

 private:
  static constexpr std::size_t kLongest = 500;
  static constexpr int kMost = 100;  // lines

  std::shared_ptr<std::atomic<bool>> is_dead_;
  FmuLog log_;
  std::string last_;
  int lines_ = 0;
  bool has_failed_ = false;
};

}  // namespace mascot

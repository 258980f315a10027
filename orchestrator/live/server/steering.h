#pragma once

#include <string>
#include <string_view>

namespace mascot {

/// Who may steer a run, or a recording: all who watch it, or those alone who know a token.
class Steering {
 public:
  enum class By { kAll, kToken };
  /// Draws a token from the system's random numbers, if one is needed. Throws std::runtime_error if there are none.
  explicit Steering(By by = By::kAll);

  /// 32 letters and digits; empty: all may steer.
  const std::string& token() const { return token_; }
  /// Whether a client may steer whose request is for `target`: a path, with steer=TOKEN in its query if it has the
  /// token.
  bool IsGranted(std::string_view target) const;

 private:
  std::string token_;
};

}  // namespace mascot

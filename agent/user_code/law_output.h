#pragma once

#include <cstddef>
#include <mutex>
#include <string>
#include <string_view>

namespace mascot {

/// While an object of this class lives, text that laws of users print in this process is dropped: for laws that run a
/// second time, on ideal bodies.
class SuppressedLawOutput {
 public:
  SuppressedLawOutput();
  ~SuppressedLawOutput();
  SuppressedLawOutput(const SuppressedLawOutput&) = delete;
  SuppressedLawOutput& operator=(const SuppressedLawOutput&) = delete;
};

/// Text that laws of users print. It goes to stderr, because stdout belongs to the program, and is fit for a terminal.
/// It goes there in whole lines, so that those of several laws do not mix. Several threads may use an object.
class LawOutput {
 public:
  enum class Kind {
    kUsual,   ///< dropped while a SuppressedLawOutput lives
    kErrors,  ///< never dropped
  };
  explicit LawOutput(Kind kind) : kind_(kind) {}
  LawOutput(const LawOutput&) = delete;
  LawOutput& operator=(const LawOutput&) = delete;

  /// Prints the lines that are complete. A line that is not over is printed by Flush(), when it gets long, and by
  /// PrintAll().
  void Add(std::string_view text);
  void Flush();
  /// As Flush(), also while a SuppressedLawOutput lives: for what was added before.
  void PrintAll();

 private:
  void Print(std::size_t bytes);
  bool IsDropped() const;

  const Kind kind_;
  std::mutex mutex_;
  std::string line_;
};

}  // namespace mascot

#include "system/console.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <cstdlib>
#include <functional>

#include "base/utf8.h"
#include "system/standard_streams.h"

namespace mascot {
namespace {

constexpr int kColours[] = {36, 33, 35, 32, 34, 96, 93, 95, 92, 94};  // without red, which is for errors

bool WantsColour() { return std::getenv("NO_COLOR") == nullptr && isatty(STDERR_FILENO); }

/// Terminal colour of a process, chosen by a hash of its name: always the same for the same process.
int ColourOf(const std::string& process) {
  std::size_t hash = 0;
  for (char c : process) hash = hash * 31 + static_cast<unsigned char>(c);
  return kColours[hash % std::size(kColours)];
}

/// As much of `text` as one line of the terminal shows: what is longer would leave its beginning behind when it is
/// rewritten.
std::string Fitting(const std::string& text) {
  winsize window{};
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &window) != 0 || window.ws_col == 0) return text;
  return std::string(CutUtf8(text, window.ws_col - 1u));
}

}  // namespace

Console::Console(bool quiet) : quiet_(quiet), terminal_(isatty(STDERR_FILENO)), colour_(WantsColour()) {}

void Console::EndProgress() {
  const std::lock_guard lock(mutex_);
  if (!progress_.empty()) PrintToTerminal("\n");
  progress_.clear();
}

void Console::EraseProgress() {
  if (!progress_.empty()) PrintToTerminal("\r\x1b[K");
}

void Console::Print(const std::string& line) {
  EraseProgress();
  PrintToTerminal(line + "\n" + Fitting(progress_));
}

void Console::Line(const std::string& text) {
  if (quiet_) return;
  const std::lock_guard lock(mutex_);
  Print(Plain(text));
}

void Console::Warning(const std::string& text) {
  const std::lock_guard lock(mutex_);
  Print("warning: " + Plain(text));
}

void Console::ChildLine(const std::string& process, const std::string& text) {
  if (quiet_) return;
  const std::lock_guard lock(mutex_);
  const std::string name = "[" + PlainLine(process) + "] ";
  const std::string in_colour = "\x1b[" + std::to_string(ColourOf(process)) + "m" + name + "\x1b[0m";
  Print((colour_ ? in_colour : name) + Plain(text));
}

void Console::Progress(double fraction, const std::string& text) {
  if (quiet_) return;
  const std::lock_guard lock(mutex_);
  if (terminal_) {
    EraseProgress();
    progress_ = PlainLine(text);
    PrintToTerminal(Fitting(progress_));
  } else if (const int tenths = static_cast<int>(fraction * 10); tenths > tenths_) {
    tenths_ = tenths;
    Print(PlainLine(text));
  }
}

}  // namespace mascot

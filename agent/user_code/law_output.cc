#include "agent/user_code/law_output.h"

#include <atomic>
#include <cstdio>

#include "base/after_last.h"
#include "base/utf8.h"

namespace mascot {
namespace {

constexpr std::size_t kLongestLine = 4096;

std::atomic<int> suppressed = 0;

}  // namespace

SuppressedLawOutput::SuppressedLawOutput() { ++suppressed; }
SuppressedLawOutput::~SuppressedLawOutput() { --suppressed; }

bool LawOutput::IsDropped() const { return kind_ == Kind::kUsual && suppressed != 0; }

void LawOutput::Add(std::string_view text) {
  if (IsDropped()) return;
  const std::lock_guard lock(mutex_);
  line_ += text;
  Print(line_.size() > kLongestLine ? line_.size() : line_.size() - AfterLast(line_, '\n').size());
}

void LawOutput::Flush() {
  if (!IsDropped()) PrintAll();
}

void LawOutput::PrintAll() {
  const std::lock_guard lock(mutex_);
  Print(line_.size());
}

void LawOutput::Print(std::size_t bytes) {
  if (bytes == 0) return;
  const std::string text = Plain(std::string_view(line_).substr(0, bytes));
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
  line_.erase(0, bytes);
}

}  // namespace mascot

#include "orchestrator/report/ending.h"

#include <filesystem>
#include <iostream>

namespace mascot {
namespace {

constexpr const char* kSummary = "summary.json";

/// Does a step. If it fails, says why, and a run that had ended well has failed. Returns whether it was done.
template <class Step>
bool Try(int& exit, const Step& step) try {
  step();
  return true;
} catch (const std::exception& failure) {
  std::cerr << "error: " << failure.what() << "\n";
  if (exit == 0) exit = 1;
  return false;
}

}  // namespace

int EndRun(const RunFolder& folder, int exit, const Ending& ending) {
  Try(exit, [&] { folder.Write(kSummary, ending.summary(std::nullopt)); });  // for drawing
  Try(exit, [&] {
    const int code = ending.draw();
    if (exit == 0) exit = code;
  });
  std::string summary = ending.summary(exit);
  if (!Try(exit, [&] { folder.Write(kSummary, summary); })) summary = ending.summary(exit);
  if (!Try(exit, [&] { ending.print(summary); })) {
    std::filesystem::remove(folder.File(kSummary));  // it may say 0, and the disk be full
    Try(exit, [&] { folder.Write(kSummary, ending.summary(exit)); });
  }
  return exit;
}

}  // namespace mascot

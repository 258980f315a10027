#include "agent/user_code/law_output.h"

#include <gtest/gtest.h>

#include <functional>
#include <string>

namespace mascot {
namespace {

std::string Printed(const std::function<void()>& print) {
  testing::internal::CaptureStderr();
  print();
  return testing::internal::GetCapturedStderr();
}

TEST(LawOutput, PrintsWholeLinesAndTheRestAtAFlush) {
  LawOutput output(LawOutput::Kind::kUsual);
  EXPECT_EQ(Printed([&] { output.Add("one\ntw"); }), "one\n");
  EXPECT_EQ(Printed([&] { output.Add("o"); }), "");
  EXPECT_EQ(Printed([&] { output.Flush(); }), "two");
  EXPECT_EQ(Printed([&] { output.Add("\x1b[31m\n"); }), "\\u001b[31m\n") << "is fit for a terminal";
  EXPECT_EQ(Printed([&] { output.Add(std::string(5000, 'x')); }), std::string(5000, 'x')) << "a line without an end";
}

TEST(LawOutput, DropsWhatIsPrintedWhileItIsSuppressedButForErrors) {
  LawOutput usual(LawOutput::Kind::kUsual), errors(LawOutput::Kind::kErrors);
  usual.Add("before");
  const SuppressedLawOutput suppressed;
  EXPECT_EQ(Printed([&] { usual.Add("now\n"), usual.Flush(); }), "");
  EXPECT_EQ(Printed([&] { errors.Add("mistake\n"); }), "mistake\n");
  EXPECT_EQ(Printed([&] { usual.PrintAll(); }), "before");
}

}  // namespace
}  // namespace mascot

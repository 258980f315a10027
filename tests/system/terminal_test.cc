// What is drawn on a terminal: the progress line of a run and of a sweep, on terminals of several widths.

#include <fcntl.h>
#include <gmock/gmock.h>
#include <poll.h>
#include <pty.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <functional>
#include <iostream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "base/utf8.h"
#include "system/console.h"
#include "system/standard_streams.h"
#include "tests/support/folders.h"
#include "tests/support/scratch.h"
#include "tests/support/waits.h"

namespace mascot::test {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

constexpr std::string_view kErase = "\r\x1b[K";

/// What was drawn, line by line: a line ends where the next one begins, or where it is erased. Without empty ones.
std::vector<std::string> Drawn(std::string_view bytes) {
  std::vector<std::string> lines(1);
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    if (bytes.substr(at).starts_with(kErase)) {
      at += kErase.size() - 1;
      lines.emplace_back();
    } else if (bytes[at] == '\n') {
      lines.emplace_back();
    } else if (bytes[at] != '\r') {  // a terminal writes \r\n for \n
      lines.back() += bytes[at];
    }
  }
  std::erase(lines, "");
  return lines;
}

winsize Columns(int width) {
  winsize size{};
  size.ws_row = 24;
  size.ws_col = static_cast<unsigned short>(width);
  return size;
}

/// All that there is to read from a terminal, which does not wait.
std::string ReadAll(int terminal) {
  std::string bytes;
  char buffer[4096];
  for (ssize_t count; (count = read(terminal, buffer, sizeof buffer)) > 0;)
    bytes.append(buffer, static_cast<std::size_t>(count));
  return bytes;
}

/// All that comes from a descriptor until no process has its other end any more.
std::string ReadToEnd(int descriptor) {
  std::string bytes;
  char buffer[4096];
  while (AwaitInput(descriptor, "the end of what is printed", kPatienceForRuns)) {
    const ssize_t count = read(descriptor, buffer, sizeof buffer);
    if (count <= 0) break;
    bytes.append(buffer, static_cast<std::size_t>(count));
  }
  return bytes;
}

/// A terminal in the place of this process's stderr, for as long as this object lives.
class Terminal {
 public:
  explicit Terminal(int width) {
    const winsize size = Columns(width);
    int theirs = -1;
    if (openpty(&ours_, &theirs, nullptr, nullptr, &size) != 0) throw std::runtime_error("no pseudo-terminal");
    before_ = dup(STDERR_FILENO);
    dup2(theirs, STDERR_FILENO);
    close(theirs);
    fcntl(ours_, F_SETFL, O_NONBLOCK);
  }
  ~Terminal() {
    dup2(before_, STDERR_FILENO);
    close(before_);
    close(ours_);
  }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  void Resize(int width) const {
    const winsize size = Columns(width);
    ioctl(ours_, TIOCSWINSZ, &size);
  }
  /// The lines that were drawn since the last call.
  std::vector<std::string> Drawn() const { return test::Drawn(ReadAll(ours_)); }

 private:
  int ours_ = -1, before_ = -1;
};

TEST(Console, CutsTheProgressLineToTheTerminal) {
  const std::string text = "t = 1.00 of 60 s | 12.3 x real time | 5 agents | disagreement 1.23 m";
  const Terminal terminal(40);
  Console console(/*quiet=*/false);
  console.Progress(0.1, text);
  EXPECT_THAT(terminal.Drawn(), ElementsAre(text.substr(0, 39))) << "the last column would move the cursor on";
  terminal.Resize(120);
  console.Progress(0.2, text);
  EXPECT_THAT(terminal.Drawn(), ElementsAre(text));
  terminal.Resize(20);
  console.Line("a line");
  EXPECT_THAT(terminal.Drawn(), ElementsAre("a line", text.substr(0, 19)));
  terminal.Resize(120);
  console.Line("another");
  EXPECT_THAT(terminal.Drawn(), ElementsAre("another", text)) << "there is room again";
  terminal.Resize(0);
  console.Progress(0.3, text + text + text);
  EXPECT_THAT(terminal.Drawn(), ElementsAre(text + text + text)) << "a terminal that does not say how wide it is";
  console.EndProgress();
  console.Line("the end");
  EXPECT_THAT(terminal.Drawn(), ElementsAre("the end"));
}

TEST(Console, CutsBetweenCharacters) {
  const Terminal terminal(10);
  Console console(/*quiet=*/false);
  console.Progress(0.1, "12345678\u00e9");
  EXPECT_THAT(terminal.Drawn(), ElementsAre("12345678"));
}

/// Runs the orchestrator in `folder`, on a terminal of this width. Returns the lines that it draws.
std::vector<std::string> DrawnBy(const std::vector<std::string>& words, const std::string& folder, int width) {
  const winsize size = Columns(width);
  int terminal = -1;
  const pid_t child = forkpty(&terminal, nullptr, nullptr, &size);
  if (child == 0) {
    std::vector<char*> argv{const_cast<char*>("orchestrator")};
    for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
    argv.push_back(nullptr);
    const std::string program = BuildFolder() + "/orchestrator";
    setenv("NO_COLOR", "1", 1);
    if (chdir(folder.c_str()) == 0) execv(program.c_str(), argv.data());
    _exit(127);
  }
  const std::string bytes = ReadToEnd(terminal);
  const int status = AwaitEndOf(child, "the end of a program that has closed its terminal");
  close(terminal);
  EXPECT_EQ(status, 0) << bytes;
  return Drawn(bytes);
}

std::vector<std::string> Having(const std::string& part, const std::vector<std::string>& lines) {
  std::vector<std::string> having;
  for (const std::string& line : lines)
    if (line.find(part) != std::string::npos) having.push_back(line);
  return having;
}

class TerminalOfWidth : public testing::TestWithParam<int> {
 protected:
  /// Each of the lines that begins like this fits, and there are some.
  void ExpectToFit(const std::vector<std::string>& progress) const {
    EXPECT_THAT(progress, Not(IsEmpty()));
    for (const std::string& line : progress) EXPECT_LT(line.size(), static_cast<std::size_t>(GetParam())) << line;
  }
  ScratchFolder folder_;
};

TEST_P(TerminalOfWidth, HoldsEachProgressLineOfARun) {
  WriteFile(folder_.File("run.toml"),
            "[run]\nduration_s = 20.0\n[agents]\ncount = 6\nmodel = \"double_integrator\"\n"
            "[graph]\ntopology = \"ring\"\n[law]\nname = \"consensus\"\n[output]\nsave_plot = false\n");
  const auto lines =
      DrawnBy({"up", "run.toml", "--engine", "inprocess", "--out", "run"}, folder_.File("."), GetParam());
  const auto progress = Having("t = ", lines);
  ExpectToFit(progress);
  EXPECT_THAT(progress.back(), StartsWith("t = 20.00 of 20 s | "));
  EXPECT_EQ(progress.back().find(" | disagreement ") != std::string::npos, GetParam() == 120) << progress.back();
}

TEST_P(TerminalOfWidth, HoldsEachProgressLineOfASweep) {
  WriteFile(folder_.File("run.toml"),
            "[run]\nduration_s = 1.0\n[agents]\ncount = 3\nmodel = \"double_integrator\"\n"
            "[graph]\ntopology = \"ring\"\n[law]\nname = \"consensus\"\n");
  const auto lines =
      DrawnBy({"sweep", "run.toml", "--set", "law.p_gain=0.1:0.1:1.0", "--no-plot", "--out", "sweep.csv"},
              folder_.File("."), GetParam());
  const auto progress = Having(" of 10 runs | ", lines);
  ExpectToFit(progress);
  EXPECT_THAT(progress.back(), StartsWith("10 of 10 runs | 0 failed | about "));
  EXPECT_EQ(progress.back().ends_with(" s left"), GetParam() == 120) << progress.back();
}

/// What `print` prints, in a process of its own whose streams are fit.
std::string PrintedBy(const std::function<void()>& print) {
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("no pipe");
  std::fflush(stdout);  // what is buffered here would be the child's to print, too
  const pid_t child = fork();
  if (child == 0) {
    dup2(ends[1], STDOUT_FILENO);
    dup2(ends[1], STDERR_FILENO);
    close(ends[1]);
    FitStandardStreams();
    print();
    std::cout << std::flush;
    _exit(0);
  }
  close(ends[1]);
  const std::string bytes = ReadToEnd(ends[0]);
  close(ends[0]);
  AwaitEndOf(child, "the end of a process that has printed");
  return bytes;
}

TEST(FitStreams, EscapeWhatActsOnATerminalAndKeepCharactersWhole) {
  EXPECT_EQ(PrintedBy([] {
              std::cout << "a\x1b[31m" << '\r' << "\xe2"
                        << "\x80"
                        << "\xae" << '\xc3' << '\xbc' << 7 << "\n\t";
            }),
            "a\\u001b[31m\\r\\u202e\u00fc7\n\t");
  EXPECT_EQ(PrintedBy([] { std::cout << "cut \xe2\x80"; }), "cut \uFFFD");
  EXPECT_EQ(PrintedBy([] { std::cerr << "\xe2\x80\xae\x7f\u00fc" << std::endl; }), "\\u202e\\u007f\u00fc\n");
  EXPECT_EQ(PrintedBy([] {
              std::cerr << "\xe2"
                        << "\x80\xae";
            }),
            "\uFFFD\uFFFD\uFFFD")
      << "never what it would be";
  EXPECT_EQ(PrintedBy([] {
              PrintToTerminal("\x1b[31m");
              std::cerr << "\x1b[31m";
            }),
            "\x1b[31m\\u001b[31m");
}

TEST(Console, PrintsColoursOfItsOwnAndNoneOfOthers) {
  EXPECT_EQ(PrintedBy([] {
              Console console(/*quiet=*/false);
              console.Line("warning: \x1b[2J\u202e");
              console.ChildLine("agent_1", "\x1b]0;title\x07\r\xff");
              console.Progress(0.5, "\x1b[31m\n");
            }),
            "warning: \\u001b[2J\\u202e\n[agent_1] \\u001b]0;title\\u0007\\r\uFFFD\n\\u001b[31m\\n\n");
  const Terminal terminal(100);
  Console console(/*quiet=*/false);
  console.Progress(0.1, "at \x1b[2J\n");
  EXPECT_THAT(terminal.Drawn(), ElementsAre("at \\u001b[2J\\n"));
  console.ChildLine("agent_1", "\x1b[2J");
  EXPECT_THAT(terminal.Drawn(), ElementsAre(testing::EndsWith("\\u001b[2J"), "at \\u001b[2J\\n"));
}

TEST(Words, OfOthersReachNoTerminalAsTheyAre) {
  const ScratchFolder folder;
  // As strangers, files and users write them: colours, text from right to left, no UTF-8.
  const std::string evil = "\x1b[31m\u202e\x9b\u2066", program = "'" + BuildFolder() + "/orchestrator' ";
  WriteFile(folder.File("good.toml"),
            "[run]\nname = \"x\"\nduration_s = 0.1\n[agents]\ncount = 2\nmodel = \"double_integrator\"\n[graph]\n"
            "topology = \"ring\"\n[output]\nsave_plot = false\n[law]\nname = \"consensus\"\n");
  WriteFile(folder.File("bad.toml"), "\"\\u001b[31m\\u202e\" = 1\n[law]\nname = \"\\u001b[31m\\u2066\"\n");
  WriteFile(folder.File("law.toml"),
            "[run]\nduration_s = 0.1\n[agents]\ncount = 1\nmodel = \"double_integrator\"\n[graph]\nedges = []\n"
            "[output]\nsave_plot = false\nfidelity = false\n[law]\nname = \"custom\"\npython = '''\nimport sys\n"
            "def control(t, me, neighbours):\n  print('printed \\x1b[31m\\u202e\\x9b')\n"
            "  print('warned \\x1b[31m\\u202e\\x9b', file=sys.stderr)\n"
            "  if t > 0.05:\n    raise ValueError('raised \\x1b[31m\\u202e\\x9b')\n  return 0, 0\n'''\n");
  const std::string out = folder.File(evil), good = folder.File("good.toml");
  const auto run = [&](const std::string& words) { return Shell(program + words + " </dev/null"); };
  ASSERT_EQ(run("up '" + good + "' --engine inprocess --out '" + out + "'").exit_code, 0);
  for (const std::string& words :
       std::vector<std::string>{"'" + evil + "'",
                                "check '" + folder.File("no" + evil) + "'",
                                "check '" + folder.File("bad.toml") + "'",
                                "check '" + good + "' --set 'law." + evil + "=1'",
                                "check '" + good + "' --set 'law.p_gain=" + evil + "'",
                                "check '" + good + "' '--" + evil + "'",
                                "up '" + good + "' --engine inprocess --force --out '" + out + "'",
                                "up '" + good + "' --engine '" + evil + "'",
                                "up '" + good + "' '--view=" + evil + "'",
                                "up '" + good + "' --view --allow-origin '" + evil + "'",
                                "info '" + out + "'",
                                "info --json '" + out + "'",
                                "verify '" + out + "'",
                                "compare '" + out + "' '" + out + "'",
                                "compare --json '" + out + "' '" + out + "'",
                                "export '" + out + "' --format csv",
                                "recover '" + out + "'",
                                "view '" + evil + "'",
                                "send --run '" + evil + "' pause",
                                "plot '" + evil + "'"}) {
    const Ran ran = run(words);
    EXPECT_EQ(Plain(ran.output), ran.output) << words;
    EXPECT_THAT(ran.output, Not(IsEmpty())) << words;
  }
  const Ran law = run("up '" + folder.File("law.toml") + "' --engine inprocess --force --out '" + out + "'");
  EXPECT_EQ(law.exit_code, 1);
  EXPECT_EQ(Plain(law.output), law.output);
  for (const char* how : {"printed", "warned", "raised"})
    EXPECT_THAT(law.output, testing::HasSubstr(how + std::string(" \\u001b[31m\\u202e\\u009b")));
  const std::string summary = ReadFile(out + "/summary.json");
  EXPECT_THAT(summary, testing::HasSubstr("raised "));
  EXPECT_EQ(Plain(summary), summary);
}

TEST(Words, OfAnAgentThatIsStartedByHandAreFit) {
  const Ran ran = Shell("'" + BuildFolder() + "/agent' --id 1 --domain 3 '--\x1b[31m\u202e' </dev/null");
  EXPECT_EQ(ran.exit_code, 2);
  EXPECT_EQ(Plain(ran.output), ran.output);
  EXPECT_THAT(ran.output, testing::HasSubstr("\\u001b[31m\\u202e"));
}

INSTANTIATE_TEST_SUITE_P(Widths, TerminalOfWidth, testing::Values(40, 120));

}  // namespace
}  // namespace mascot::test

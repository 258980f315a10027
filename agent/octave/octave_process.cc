#include "agent/octave/octave_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <limits>
#include <optional>
#include <regex>
#include <sstream>

#include "agent/octave/octave_driver.h"
#include "agent/octave/octave_text.h"
#include "base/utf8.h"
#include "system/environment.h"
#include "system/spawn.h"

namespace mascot {
namespace {

constexpr double kRead = 0, kParams = 1, kCall = 2;  // what is asked
constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
constexpr int kLookEvery_ms = 50;

std::int64_t SteadyNs() { return std::chrono::steady_clock::now().time_since_epoch() / std::chrono::nanoseconds(1); }

std::int64_t DeadlineOf(const LawLimits& limits) {
  return limits.limit_s > 0 ? SteadyNs() + static_cast<std::int64_t>(limits.limit_s * 1e9) : kNever;
}

/// While an object of this class lives, a pipe whose reader has ended gives its thread an error, and no signal.
class WithoutPipeSignal {
 public:
  WithoutPipeSignal() {
    sigemptyset(&pipe_);
    sigaddset(&pipe_, SIGPIPE);
    pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
  }
  ~WithoutPipeSignal() {
    const int error = errno;
    const timespec now{};
    if (error == EPIPE && sigismember(&before_, SIGPIPE) == 0) sigtimedwait(&pipe_, nullptr, &now);
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
    errno = error;
  }
  WithoutPipeSignal(const WithoutPipeSignal&) = delete;
  WithoutPipeSignal& operator=(const WithoutPipeSignal&) = delete;

 private:
  sigset_t pipe_{}, before_{};
};

ssize_t WriteSome(int descriptor, const char* bytes, std::size_t size) {
  const WithoutPipeSignal quiet;
  return write(descriptor, bytes, size);
}

void MakeNonBlocking(const Descriptor& descriptor) { fcntl(descriptor.number(), F_SETFL, O_NONBLOCK); }

std::vector<std::string> Words(const std::string& program, const std::string& start) {
  std::vector<std::string> words = {"env"};
  // No functions of the user's own folders, no windows, no pool of threads, texts in UTF-8.
  for (const char* name : {"DISPLAY", "OCTAVE_PATH", "OCTAVE_HOME", "OCTAVE_EXEC_HOME"})
    words.insert(words.end(), {"-u", name});
  words.insert(words.end(),
               {"LC_ALL=C.UTF-8", "OPENBLAS_NUM_THREADS=1", "OMP_NUM_THREADS=1", program, "--quiet", "--norc",
                "--no-history", "--no-gui", "--no-window-system", "--no-line-editing", "--eval", start});
  return words;
}

}  // namespace

OctaveProcess::OctaveProcess(const OctaveCode& code, std::uint64_t seed, int stream, std::size_t max_message)
    : file_(code.file), line_(code.line), max_message_(max_message) {
  const std::string program = FindInPath("octave-cli");
  if (program.empty()) throw std::runtime_error("expected Octave, got no octave-cli in PATH: apt install octave");
  folder_.Write(kOctaveDriver, kOctaveDriverText);
  folder_.Write(kOctaveLaw, code.text);
  for (const auto& [name, text] : code.modules) folder_.Write(name, text);
  Pipe questions = MakePipe(), answers = MakePipe(), printed = MakePipe();
  const int to = questions.reads.number(), from = answers.writes.number(), prints = printed.writes.number();
  const std::string start = fmt::format("cd({}); mascot_driver(\"/dev/fd/{}\", \"/dev/fd/{}\", [{}; {}; {}], {});",
                                        QuotedForOctave(folder_.path().string()), to, from, seed & 0xffffffffU,
                                        seed >> 32U, stream, max_message);
  process_ = Spawn({.words = Words(program, start),
                    .group = Program::Group::kOwn,
                    .signals = Program::Signals::kDefault,
                    .input = Program::kNowhere,
                    .output = prints,
                    .errors = prints,
                    .shared = {to, from, lifeline_.shared()}});
  lifeline_.Tie(process_.number());
  to_ = std::move(questions.writes);
  from_ = std::move(answers.reads);
  printed_ = std::move(printed.reads);
  MakeNonBlocking(to_);
  MakeNonBlocking(from_);
  MakeNonBlocking(printed_);
  // Only now may it run code of the user: it has a lifeline.
  Send({{&kRead, 1}}, kNever, {});
}

OctaveProcess::~OctaveProcess() {
  process_ = ChildProcess();
  TakeOutput();
  output_.Flush();
}

OctaveSignature OctaveProcess::Begin(const LawLimits& limits) {
  const std::span<const double> answer = Receive(limits);
  return {static_cast<int>(answer[0]), static_cast<int>(answer[1])};
}

void OctaveProcess::SetParams(const Value& params, const LawLimits& limits) {
  const std::string text = ToOctave(params);
  const std::vector<double> characters(text.begin(), text.end());  // ASCII
  Send({{&kParams, 1}, characters}, DeadlineOf(limits), limits);
}

OctaveProcess::Answer OctaveProcess::Control(const OctaveValues& values, const LawLimits& limits) {
  const double call[] = {kCall, static_cast<double>(values.sizes().size())};
  Send({call, values.sizes(), values.numbers()}, DeadlineOf(limits), limits);
  const std::span<const double> answer = Receive(limits);
  if (answer[0] != 2 && answer[0] != 3) FailAsGarbled();
  const auto size = static_cast<std::size_t>(answer[0]);
  if (answer.size() < 1 + size || answer.size() > 1 + size + max_message_) FailAsGarbled();
  return {answer.subspan(1, size), answer.subspan(1 + size)};
}

void OctaveProcess::Send(std::initializer_list<std::span<const double>> numbers, std::int64_t deadline_ns,
                         const LawLimits& limits) {
  sent_.assign(1, 0);
  for (const std::span<const double> some : numbers) sent_.insert(sent_.end(), some.begin(), some.end());
  sent_.front() = static_cast<double>(sent_.size() - 1);
  const char* next = reinterpret_cast<const char*>(sent_.data());
  const char* const end = next + sent_.size() * sizeof(double);
  while (next != end) {
    const ssize_t written = WriteSome(to_.number(), next, static_cast<std::size_t>(end - next));
    if (written > 0)
      next += written;
    else if (errno == EAGAIN)
      Await(POLLOUT, to_.number(), deadline_ns, limits);
    else if (errno != EINTR)
      FailAsEnded();
  }
}

std::span<const double> OctaveProcess::Receive(const LawLimits& limits) {
  constexpr double kMaxNumbers = 1 << 20;
  constexpr unsigned kCallsPerLook = 256;
  const std::int64_t deadline_ns = DeadlineOf(limits);
  double count = 0;
  Read({&count, 1}, deadline_ns, limits);
  if (!(count >= 3 && count <= kMaxNumbers)) FailAsGarbled();
  received_.resize(static_cast<std::size_t>(count));
  Read(received_, deadline_ns, limits);
  TakeOutput();
  if (calls_++ % kCallsPerLook == 0) RequireLittleMemory(limits);
  const std::span<const double> answer = std::span<const double>(received_).subspan(1);
  if (received_.front() != 0) FailWith(answer);
  return answer;
}

void OctaveProcess::Read(std::span<double> numbers, std::int64_t deadline_ns, const LawLimits& limits) {
  char* next = reinterpret_cast<char*>(numbers.data());
  char* const end = next + numbers.size_bytes();
  while (next != end) {
    Await(POLLIN, from_.number(), deadline_ns, limits);
    const ssize_t got = read(from_.number(), next, static_cast<std::size_t>(end - next));
    if (got > 0) next += got;
    if (got == 0 || (got < 0 && errno != EINTR && errno != EAGAIN)) FailAsEnded();
  }
}

/// Waits until the descriptor is ready. What the code prints is taken meanwhile, so that it need not wait.
void OctaveProcess::Await(short events, int descriptor, std::int64_t deadline_ns, const LawLimits& limits) {
  for (;;) {
    pollfd ready[] = {{descriptor, events, 0}, {printed_.number(), POLLIN, 0}};
    const int count = poll(ready, std::size(ready), kLookEvery_ms);
    if (count > 0 && ready[0].revents != 0) return;
    if (count > 0 && ready[1].revents != 0) TakeOutput();
    if (count == 0) RequireLittleMemory(limits);
    if (SteadyNs() <= deadline_ns) continue;
    process_.Signal(SIGKILL);
    throw std::runtime_error(fmt::format("TimeoutError: took longer than {} = {} s", limits.source, limits.limit_s));
  }
}

void OctaveProcess::TakeOutput() {
  constexpr int kMostReads = 64;  // code that prints without end is to be noticed
  char bytes[4096];
  for (int k = 0; k < kMostReads && printed_.is_open(); ++k) {
    const ssize_t got = read(printed_.number(), bytes, sizeof bytes);
    if (got == 0) printed_ = Descriptor();  // Octave has ended
    if (got <= 0) return;
    output_.Add({bytes, static_cast<std::size_t>(got)});
  }
}

void OctaveProcess::RequireLittleMemory(const LawLimits& limits) {
  if (limits.memory_mb <= 0 || MemoryOf_mb(process_.number()) <= limits.memory_mb) return;
  process_.Signal(SIGKILL);
  throw std::runtime_error(fmt::format("MemoryError: needs more than control.python_memory_mb = {}", limits.memory_mb));
}

void OctaveProcess::FailAsGarbled() const {
  process_.Signal(SIGKILL);
  throw std::runtime_error("its code has written into the pipes of Octave");
}

void OctaveProcess::FailAsEnded() {
  constexpr auto kGrace = std::chrono::seconds(5);  // to end after its pipes have ended
  const auto until = std::chrono::steady_clock::now() + kGrace;
  std::optional<int> status;
  while (!(status = process_.ReapIfEnded()) && std::chrono::steady_clock::now() < until) poll(nullptr, 0, 1);
  TakeOutput();
  output_.Flush();
  process_.Signal(SIGKILL);
  if (!status) throw std::runtime_error("its code has closed the pipes of Octave");
  throw std::runtime_error("Octave " + EndText(*status));
}

void OctaveProcess::FailWith(std::span<const double> text) const {
  std::string words;
  for (const double c : text) words += c >= 0 && c < 256 ? static_cast<char>(static_cast<unsigned char>(c)) : '?';
  std::istringstream stream(words);
  std::string file, line_text, column_text;
  std::getline(stream, file);
  std::getline(stream, line_text);
  std::getline(stream, column_text);
  std::string message(std::istreambuf_iterator<char>(stream), {});
  int line = std::max(std::atoi(line_text.c_str()), 1), column = std::max(std::atoi(column_text.c_str()), 1);
  // A parse error says where it is in words, and points at it.
  static const std::regex kParse(
      R"(parse error near line (\d+) of file ([^\n]*)\s*([^\n]*)(?:\s*>>> [^\n]*\n( *)\^)?)");
  std::smatch match;
  if (std::regex_search(message, match, kParse)) {
    constexpr int kPrompt = 4;  // ">>> "
    line = std::atoi(match[1].str().c_str());
    column = std::max(1, static_cast<int>(match[4].length()) - kPrompt + 1);
    file = match[2];
    message = match[3].length() > 0 ? match[3].str() : "parse error";
  }
  file = std::filesystem::path(file).filename().string();
  if (file.empty() || file == kOctaveLaw) {
    file = file_;
    line += line_ - 1;
  }
  throw OctaveError(PlainLine(message), fmt::format("{}:{}:{}", file, line, column));
}

}  // namespace mascot

#include "system/children.h"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>

#include <algorithm>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "system/descriptor.h"
#include "system/left_file.h"
#include "system/nursery.h"
#include "system/spawn.h"

namespace mascot {

using namespace std::chrono_literals;
using WallClock = std::chrono::steady_clock;

namespace {

constexpr auto kLongestDeath = 10s;  // of a child that was killed: then it is given up
constexpr int kAskEvery_ms = 20;     // from one look whether to go on to the next

enum class Wait { kOver, kInterrupted, kTooLong };

/// Waits until there is something to read, or the end.
Wait AwaitInput(int descriptor, const Children::Patience& patience) {
  const auto deadline = WallClock::now() + std::chrono::duration<double>(patience.limit_s);
  for (pollfd input{descriptor, POLLIN, 0}; poll(&input, 1, kAskEvery_ms) <= 0;) {
    if (!patience.go_on()) return Wait::kInterrupted;
    if (WallClock::now() > deadline) return Wait::kTooLong;
  }
  return Wait::kOver;
}

}  // namespace

std::filesystem::path ProgramFolder() { return std::filesystem::read_symlink("/proc/self/exe").parent_path(); }

std::optional<int> Exit::code() const { return WIFEXITED(status) ? std::optional(WEXITSTATUS(status)) : std::nullopt; }

Children::~Children() {
  Stop(0ms);
  for (Child& child : running_) child.process.Release();  // in a call of the kernel that does not end
}

pid_t Children::Spawn(const std::string& process, const std::string& program, const std::vector<std::string>& arguments,
                      const std::filesystem::path& log, const Streams& streams) {
  const Descriptor output = logs_.Open(process, log);
  std::vector<std::string> words{program};
  words.insert(words.end(), arguments.begin(), arguments.end());
  ChildProcess child = mascot::Spawn({.words = std::move(words),
                                      .group = Program::Group::kOwn,
                                      .signals = Program::Signals::kDefault,
                                      .input = streams.input >= 0 ? streams.input : Program::kNowhere,
                                      .output = streams.output >= 0 ? streams.output : output.number(),
                                      .errors = output.number(),
                                      .shared = shared_});
  const pid_t number = child.number();
  running_.push_back({process, std::move(child)});
  return number;
}

std::vector<pid_t> Children::SpawnCopies(const std::string& program, const std::vector<CopyOf>& copies,
                                         const Patience& patience) {
  if (copies.empty()) return {};
  std::vector<Descriptor> outputs;
  std::vector<Copy> orders;
  for (const CopyOf& copy : copies) {
    outputs.push_back(logs_.Open(copy.process, copy.log));
    orders.push_back({.words = {program}, .output = outputs.back().number()});
    orders.back().words.insert(orders.back().words.end(), copy.arguments.begin(), copy.arguments.end());
  }
  Pipe order = MakePipe(), numbers = MakePipe();
  std::vector<int> shared = shared_;
  for (const Descriptor& output : outputs) shared.push_back(output.number());
  shared.push_back(numbers.writes.number());
  ChildProcess nursery = mascot::Spawn({.words = {program, kNursery, NurseryRoom(orders)},
                                        .group = Program::Group::kOwn,
                                        .signals = Program::Signals::kDefault,
                                        .input = order.reads.number(),
                                        .output = outputs.front().number(),
                                        .errors = outputs.front().number(),
                                        .shared = shared});
  order.reads = Descriptor();
  const bool told = WriteAll(order.writes.number(), NurseryOrder(orders, numbers.writes.number()));
  order.writes = Descriptor();
  numbers.writes = Descriptor();
  const std::string cannot = "cannot start " + program + " " + std::to_string(copies.size()) + " times: it ";
  switch (AwaitInput(numbers.reads.number(), patience)) {
    case Wait::kOver:
      break;
    case Wait::kInterrupted:
      return {};
    case Wait::kTooLong:
      throw std::runtime_error(cannot + fmt::format("has not made its copies within {:g} s", patience.limit_s));
  }
  std::istringstream born(ReadToEnd(numbers.reads.number()));
  std::vector<pid_t> ids;
  for (pid_t number = 0; born >> number;) ids.push_back(number);
  const std::optional<int> end = nursery.Reap();  // then they are ours
  if (!told || ids.size() != copies.size()) throw std::runtime_error(cannot + EndText(end.value_or(kUnknownEnd)));
  for (std::size_t k = 0; k < ids.size(); ++k) running_.push_back({copies[k].process, ChildProcess(ids[k])});
  return ids;
}

/// Returns its status from waitpid once it has ended.
std::optional<int> Children::Reap(ChildProcess& child) {
  const std::optional<int> status = child.ReapIfEnded();
  if (status && WIFSIGNALED(*status)) killed_at_ = WallClock::now();
  return status;
}

std::vector<Exit> Children::Reap() {
  std::vector<Exit> exits;
  for (Child& child : running_)
    if (const auto status = Reap(child.process)) exits.push_back({child.name, *status});
  std::erase_if(running_, [](const Child& child) { return child.process.number() == 0; });
  return exits;
}

bool Children::WaitAll(std::chrono::milliseconds grace) {
  // SIGCHLD is blocked and goes to the StopSignal of the run, which is not read here: poll instead.
  const auto deadline = WallClock::now() + grace;
  for (; Reap(), !running_.empty() && WallClock::now() < deadline;) poll(nullptr, 0, 2);
  return running_.empty();
}

void Children::Stop(std::chrono::milliseconds grace) {
  if (running_.empty()) return;
  if (grace > 0ms) {
    Signal(SIGTERM);
    if (WaitAll(grace)) return;
  }
  Kill();
}

void Children::Kill() {
  Signal(SIGKILL);
  WaitAll(kLongestDeath);
}

void Children::Kill(const std::string& process) {
  const auto is_it = [&](const Child& child) { return child.name == process; };
  for (Child& child : running_)
    if (is_it(child)) child.process.Signal(SIGKILL);
  const auto deadline = WallClock::now() + kLongestDeath;
  while (std::ranges::any_of(running_, is_it) && WallClock::now() < deadline) {
    std::erase_if(running_, [&](Child& child) { return is_it(child) && Reap(child.process); });
    poll(nullptr, 0, 2);
  }
}

void Children::Signal(int signal) {
  for (const Child& child : running_) child.process.Signal(signal);
}

}  // namespace mascot

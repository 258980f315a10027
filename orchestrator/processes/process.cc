#include "orchestrator/processes/process.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <utility>

extern char** environ;

namespace mascot {

using namespace std::chrono_literals;
using WallClock = std::chrono::steady_clock;

std::filesystem::path ProgramFolder() { return std::filesystem::read_symlink("/proc/self/exe").parent_path(); }

// --- logs -----------------------------------------------------------------------------------------------

struct ChildLogs::Stream {
  std::string process;
  int descriptor = -1;
  std::ofstream file;
  std::string partial;           // what came since the last end of line
  std::deque<std::string> last;  // kLastLines of them
};

namespace {

constexpr std::size_t kLastLines = 10;
constexpr auto kPipeIsDry = 2s;  // a dead child's last words are in the pipe already

void MakePipe(int (&ends)[2]) {
  if (pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error(std::string("cannot make a pipe: ") + std::strerror(errno));
}

}  // namespace

ChildLogs::ChildLogs(const RunFolder& folder, Console& console) : folder_(folder), console_(console) {
  MakePipe(wake_);
  thread_ = std::thread([this] { Copy(); });
}

ChildLogs::~ChildLogs() {
  {
    const std::lock_guard lock(mutex_);
    closing_ = true;
  }
  if (write(wake_[1], "", 1) < 0) std::perror("pipe");
  thread_.join();
  close(wake_[0]);
  close(wake_[1]);
}

int ChildLogs::Open(const std::string& process) {
  int ends[2];
  MakePipe(ends);
  fcntl(ends[0], F_SETFL, O_NONBLOCK);
  auto stream = std::make_unique<Stream>();
  stream->process = process;
  stream->descriptor = ends[0];
  stream->file.open(folder_.Log(process), std::ios::binary);
  if (!stream->file)
    throw std::runtime_error("cannot write " + folder_.Log(process).string() + ": " + std::strerror(errno));
  {
    const std::lock_guard lock(mutex_);
    streams_.push_back(std::move(stream));
  }
  if (write(wake_[1], "", 1) < 0) throw std::runtime_error("cannot wake the thread that copies logs");
  return ends[1];
}

void ChildLogs::Copy() {
  for (bool closing = false;;) {
    std::vector<pollfd> polled{{wake_[0], POLLIN, 0}};
    {
      const std::lock_guard lock(mutex_);
      for (const auto& stream : streams_) polled.push_back({stream->descriptor, POLLIN, 0});
      closing = closing_;
    }
    // The children have gone by the time of closing; what they started may hold their pipes open for ever.
    if (poll(polled.data(), polled.size(), closing ? 0 : -1) == 0) break;
    char buffer[256];
    if (polled[0].revents != 0 && read(wake_[0], buffer, sizeof buffer) < 0) break;
    const std::lock_guard lock(mutex_);
    for (std::size_t i = 1; i < polled.size(); ++i)
      if (polled[i].revents != 0) Read(*streams_[i - 1]);
  }
  const std::lock_guard lock(mutex_);
  for (const auto& stream : streams_) Close(*stream);
}

void ChildLogs::Close(Stream& stream) {
  if (!stream.partial.empty()) TakeLine(stream, stream.partial);
  stream.partial.clear();
  if (stream.descriptor >= 0) close(std::exchange(stream.descriptor, -1));
}

void ChildLogs::Read(Stream& stream) {
  char buffer[4096];
  const ssize_t size = read(stream.descriptor, buffer, sizeof buffer);
  if (size < 0 && (errno == EAGAIN || errno == EINTR)) return;
  if (size <= 0) return Close(stream);
  stream.partial.append(buffer, static_cast<std::size_t>(size));
  for (std::size_t end; (end = stream.partial.find('\n')) != std::string::npos; stream.partial.erase(0, end + 1))
    TakeLine(stream, stream.partial.substr(0, end));
}

void ChildLogs::TakeLine(Stream& stream, const std::string& line) {
  stream.file << line << std::endl;
  stream.last.push_back(line);
  if (stream.last.size() > kLastLines) stream.last.pop_front();
  console_.ChildLine(stream.process, line);
}

std::vector<std::string> ChildLogs::LastLines(const std::string& process) {
  for (const auto deadline = WallClock::now() + kPipeIsDry;; poll(nullptr, 0, 1)) {
    const std::lock_guard lock(mutex_);
    for (const auto& stream : streams_)
      if (stream->process == process && (stream->descriptor < 0 || WallClock::now() > deadline))
        return {stream->last.begin(), stream->last.end()};
    if (WallClock::now() > deadline) return {};
  }
}

// --- children -------------------------------------------------------------------------------------------

std::string Exit::Text() const {
  if (WIFSIGNALED(status))
    return "was killed by signal " + std::to_string(WTERMSIG(status)) + " (" + strsignal(WTERMSIG(status)) + ")";
  return "exited with code " + std::to_string(WEXITSTATUS(status));
}

Children::~Children() { Stop(0ms); }

void Children::Spawn(const std::string& process, const std::string& program,
                     const std::vector<std::string>& arguments) {
  const int output = logs_.Open(process);
  std::vector<char*> argv{const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);

  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&files, output, STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&files, output, STDERR_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none, all;
  sigemptyset(&none);
  sigfillset(&all);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setsigdefault(&attributes, &all);
  posix_spawnattr_setpgroup(&attributes, 0);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETPGROUP);

  pid_t pid = 0;
  const int error = posix_spawn(&pid, program.c_str(), &files, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  close(output);
  if (error != 0) throw std::runtime_error("cannot start " + program + ": " + std::strerror(error));
  running_[pid] = process;
}

std::vector<Exit> Children::Reap() {
  std::vector<Exit> exits;
  for (auto child = running_.begin(); child != running_.end();) {
    int status = 0;
    if (const pid_t gone = waitpid(child->first, &status, WNOHANG); gone != 0) {  // < 0: somebody else reaped it
      exits.push_back({child->second, status});
      child = running_.erase(child);
    } else {
      ++child;
    }
  }
  return exits;
}

bool Children::WaitAll(std::chrono::milliseconds grace) {
  // SIGCHLD is blocked and belongs to the run's StopSignal, which is no longer asked: look again often.
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
  WaitAll(10s);
}

void Children::Signal(int signal) {
  for (const auto& [pid, process] : running_) kill(pid, signal);
}

}  // namespace mascot

#include "bus/descendants.h"

#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

namespace mascot {
namespace {

namespace fs = std::filesystem;

struct Kin {
  pid_t pid = 0;
  bool is_zombie = false;
  bool is_ssh = false;
};

/// All processes, by their parents.
std::multimap<pid_t, Kin> ProcessesByParent() {
  std::multimap<pid_t, Kin> processes;
  std::error_code error;
  for (fs::directory_iterator entry("/proc", error), end; !error && entry != end; entry.increment(error)) {
    const std::string name = entry->path().filename();
    Kin process;
    if (std::from_chars(name.data(), name.data() + name.size(), process.pid).ptr != name.data() + name.size()) continue;
    std::string stat;
    std::getline(std::ifstream(entry->path() / "stat"), stat, '\0');
    const auto begin = stat.find('('), close = stat.rfind(')');
    if (begin == std::string::npos || close == std::string::npos) continue;
    std::istringstream fields(stat.substr(close + 1));
    char state = 0;
    pid_t parent = 0;
    fields >> state >> parent;
    process.is_zombie = state == 'Z' || state == 'X';
    process.is_ssh = stat.substr(begin + 1, close - begin - 1) == "ssh";
    processes.emplace(parent, process);
  }
  return processes;
}

/// Adds what descends from `parent` to `descendants`.
void AddDescendants(const std::multimap<pid_t, Kin>& processes, pid_t parent, const std::vector<pid_t>& spared,
                    std::vector<Kin>& descendants) {
  for (auto [child, end] = processes.equal_range(parent); child != end; ++child) {
    const Kin& kin = child->second;
    if (kin.is_ssh || std::ranges::find(spared, kin.pid) != spared.end()) continue;
    descendants.push_back(kin);
    AddDescendants(processes, kin.pid, spared, descendants);
  }
}

}  // namespace

void AdoptDescendants() { prctl(PR_SET_CHILD_SUBREAPER, 1); }

void KillDescendants(const std::vector<pid_t>& spared) {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(2);
  for (; std::chrono::steady_clock::now() < deadline; poll(nullptr, 0, 2)) {  // killed parents leave us their children
    std::vector<Kin> descendants;
    AddDescendants(ProcessesByParent(), getpid(), spared, descendants);
    if (descendants.empty()) return;
    for (const Kin& kin : descendants) {
      if (!kin.is_zombie) kill(kin.pid, SIGKILL);
      waitpid(kin.pid, nullptr, WNOHANG);  // those that are our own children
    }
  }
}

}  // namespace mascot

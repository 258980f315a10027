#include "system/descendants.h"

#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <map>
#include <random>
#include <sstream>
#include <string>

#include "system/processes.h"

namespace mascot {
namespace {

struct Kin {
  pid_t pid = 0;
  bool is_zombie = false;
  bool is_ssh = false;
};

/// All processes, by their parents.
std::multimap<pid_t, Kin> ProcessesByParent() {
  std::multimap<pid_t, Kin> processes;
  for (const pid_t pid : Processes()) {
    Kin process{.pid = pid};
    std::string stat;
    std::getline(std::ifstream("/proc/" + std::to_string(pid) + "/stat"), stat, '\0');
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

constexpr const char* kMark = "MASCOT_RUN";

/// Whether the environment with which a process began has this variable.
bool Has(pid_t process, const std::string& variable) {
  std::ifstream environment("/proc/" + std::to_string(process) + "/environ", std::ios::binary);
  for (std::string entry; std::getline(environment, entry, '\0');)
    if (entry == variable) return true;
  return false;
}

}  // namespace

void MarkDescendants() {
  const std::string mark = std::to_string(getpid()) + "-" + std::to_string(std::random_device()());
  setenv(kMark, mark.c_str(), /*overwrite=*/1);
}

void KillMarked() {
  const char* const mark = std::getenv(kMark);
  if (mark == nullptr) return;
  const std::string variable = std::string(kMark) + "=" + mark;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(2);
  for (bool any = true; any && std::chrono::steady_clock::now() < deadline; poll(nullptr, 0, 2)) {
    any = false;  // until none is left: one that dies may just have started another
    for (const auto& [parent, kin] : ProcessesByParent()) {
      if (kin.pid == getpid() || kin.is_zombie || kin.is_ssh || !Has(kin.pid, variable)) continue;
      any = kill(kin.pid, SIGKILL) == 0 || any;
    }
  }
}

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

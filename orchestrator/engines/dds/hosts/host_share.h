#pragma once

#include <chrono>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "orchestrator/engines/dds/hosts/host_words.h"
#include "orchestrator/engines/dds/machine/domain_lock.h"
#include "orchestrator/engines/dds/machine/janitor.h"
#include "system/child_logs.h"
#include "system/children.h"
#include "system/line_pipe.h"
#include "system/private_folder.h"
#include "system/stop_signal.h"

namespace mascot {

/// A host's share of a run: what `orchestrator host` does there. It reads from standard input which processes to start,
/// and writes to standard output what they print and how they end. When its input ends, when nothing comes for a while,
/// or when a signal comes, it ends its processes, and leaves nothing.
class HostShare {
 public:
  explicit HostShare(StopSignal& stop);
  /// Returns an exit code: 0 the share ended in order; 1 its input ended early, or it cannot do its job; 128 + signal.
  int Run();

 private:
  using Time = std::chrono::steady_clock::time_point;

  bool Look();
  void Obey(const std::string& line);
  void Start(const HostJob& job);
  void TellExits();
  void TakeLine(const std::string& process, const std::string& line);
  void TellLine(const std::string& process, std::string_view line);
  void Tell(HostWords words);
  void Leave();

  StopSignal& stop_;
  const std::string node_;
  LineReader input_;
  LineWriter output_;
  std::set<std::string> losing_;  // processes whose newest line is lost; only for the thread that copies logs
  ChildLogs logs_;
  std::optional<DomainLock> lock_;
  std::optional<Janitor> janitor_;
  std::optional<PrivateFolder> credentials_;  // with network.security
  Children children_;
  int domain_ = -1;
  std::chrono::duration<double> silence_{60};
  Time heard_, told_;
  bool ending_ = false;
  Time end_by_;
  int code_ = 0;
};

}  // namespace mascot

#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "bus/security.h"
#include "experiment/experiment.h"
#include "idl/topics.h"
#include "system/private_folder.h"

namespace mascot {

/// The place of a process in the order of all GUIDs of a run, 0 to kMaxRank. Of two participants, the one with the
/// smaller GUID begins to authenticate itself when it discovers the other. If the other has not discovered it by then,
/// its first word is lost, and Fast DDS waits a second before the next. So a process of lower rank announces itself to
/// those of higher rank, and these to it only in answer.
inline constexpr int kMaxRank = 127;

/// Makes the credentials of the processes of a run with network.security = "graph": one authority signs all
/// certificates and documents. Its private key, on P-256, is in the memory of this process alone, and goes with this
/// object. What names a certificate is the enclave of its process, in the words of SROS2: "/agent_3".
class CertificateAuthority {
 public:
  /// `domain`: the only one in which the credentials allow anything. `experiment` must outlive this object. Throws
  /// std::runtime_error if the library for cryptography fails, as do the functions below.
  CertificateAuthority(const Experiment& experiment, int domain);
  ~CertificateAuthority();
  CertificateAuthority(const CertificateAuthority&) = delete;
  CertificateAuthority& operator=(const CertificateAuthority&) = delete;

  /// New credentials of a process of the run, and what its participants are known by.
  struct Issued {
    Credentials credentials;
    ProcessKey key;
  };
  /// The process may read and write what RightsOf() says. `start`: which start of the process it is, from 0: the key
  /// differs from that of other starts.
  Issued Issue(const std::string& process, int rank, int start = 0) const;
  /// Those of the orchestrator, whom all credentials name.
  const Issued& OfOrchestrator() const { return orchestrator_; }

 private:
  struct Keys;
  const Experiment& experiment_;
  const int domain_;
  const std::vector<Topic> topics_;  // of the run
  std::unique_ptr<const Keys> keys_;
  std::string governance_;  // signed
  Issued orchestrator_;
};

/// The credentials of the processes of a run, as files in a folder that only this user may enter, and that goes with
/// this object, or soon after its process. Each process that is started by another removes its file once it has read
/// it.
class RunCredentials {
 public:
  /// As CertificateAuthority().
  RunCredentials(const Experiment& experiment, int domain) : authority_(experiment, domain) {}

  /// Those of this process.
  std::shared_ptr<const Credentials> Own() const;
  /// New credentials, for a process that is started now.
  Credentials Issue(const std::string& process, int rank);
  /// Writes them to a new file. Throws std::runtime_error.
  std::filesystem::path Write(const Credentials& credentials);
  /// Fits the newest process of this name that has got credentials.
  ProcessKey KeyOf(const std::string& process) const { return newest_.at(process).key; }

 private:
  struct Newest {
    ProcessKey key;
    int starts = 0;
  };
  const CertificateAuthority authority_;
  PrivateFolder folder_;
  std::map<std::string, Newest> newest_;  // by process
  int files_ = 0;
};

}  // namespace mascot

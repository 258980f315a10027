#pragma once

#include <fastdds/dds/domain/qos/DomainParticipantQos.hpp>
#include <filesystem>
#include <string>

#include "bus/process_key.h"
#include "system/private_folder.h"

namespace mascot {

/// What a process needs to take part in a run with network.security = "graph": the documents that DDS Security asks for
/// (OMG, DDS Security 1.1), made by the orchestrator for this process and this run.
struct Credentials {
  std::string process;         ///< the name of the process: "agent_3"
  std::string identity_ca;     ///< PEM: the certificate of the authority that has signed all certificates of the run
  std::string certificate;     ///< PEM
  std::string private_key;     ///< PEM
  std::string permissions_ca;  ///< PEM: the certificate of the authority that has signed the two documents below
  std::string governance;      ///< S/MIME: what is protected, the same for all processes
  std::string permissions;     ///< S/MIME: which topics this process may read and write
  ProcessKey orchestrator;     ///< fits the participant whose certificate is the orchestrator's
};

/// The credentials as one text: a TOML file.
std::string ToText(const Credentials& credentials);
/// The inverse. Throws ConfigError, with `name` as the file's, for other text.
Credentials CredentialsFrom(const std::string& text, const std::string& name);
/// Reads a file that ToText() has made. Throws ConfigError, and std::runtime_error if it cannot be read or others than
/// its owner may read or write it.
Credentials ReadCredentials(const std::filesystem::path& file);

/// The documents as files, as an enclave of SROS2 has them, while Fast DDS reads them: it takes nothing but files, and
/// reads them when it makes the participant. Only this user may enter the folder, which goes with this object.
class Enclave {
 public:
  /// Throws std::runtime_error if the files cannot be written.
  explicit Enclave(const Credentials& credentials);
  /// Has a participant take part with these documents, and with nobody who has no such.
  void Secure(eprosima::fastdds::dds::DomainParticipantQos& qos) const;

 private:
  PrivateFolder folder_;
};

}  // namespace mascot

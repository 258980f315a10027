#include "bus/security.h"

#include <sys/stat.h>

#include <cstdint>
#include <stdexcept>
#include <utility>

#include "base/number.h"
#include "experiment/toml/input.h"
#include "experiment/toml/section.h"

namespace mascot {
namespace {

/// One of the documents: its key in the text of the credentials, and its file in an enclave.
struct Document {
  std::string_view key;
  std::string_view file;
  std::string Credentials::*text;
};
constexpr Document kDocuments[] = {
    {"identity_ca", "identity_ca.cert.pem", &Credentials::identity_ca},
    {"certificate", "cert.pem", &Credentials::certificate},
    {"private_key", "key.pem", &Credentials::private_key},
    {"permissions_ca", "permissions_ca.cert.pem", &Credentials::permissions_ca},
    {"governance", "governance.p7s", &Credentials::governance},
    {"permissions", "permissions.p7s", &Credentials::permissions},
};

constexpr Key kKeys[] = {
    key::Text("process", "whose credentials these are").Required(),
    key::Text("orchestrator", "how the GUID of the orchestrator begins").Required(),
    key::Text("identity_ca", "certificate, PEM").Required(),
    key::Text("certificate", "certificate, PEM").Required(),
    key::Text("private_key", "private key, PEM").Required(),
    key::Text("permissions_ca", "certificate, PEM").Required(),
    key::Text("governance", "signed document, S/MIME").Required(),
    key::Text("permissions", "signed document, S/MIME").Required(),
};

/// Throws std::runtime_error if others than the owner of the file may read or write it.
void RequirePrivate(const std::filesystem::path& file) {
  struct stat info {};
  if (::stat(file.c_str(), &info) != 0) return;  // reading it says why
  if ((info.st_mode & (S_IRWXG | S_IRWXO)) != 0)
    throw std::runtime_error(file.string() +
                             ": expected a file that only its owner may read (chmod 600), got one that " +
                             "others may read or write, with a private key in it");
}

}  // namespace

std::string ToText(const Credentials& credentials) {
  std::string text =
      "# The credentials of a process of a run: keep them secret. When the run has ended, they are of no use.\n";
  const auto add = [&text](std::string_view key, const std::string& value) {
    text += std::string(key) + " = " + ToToml(Value{value}) + "\n";
  };
  add("process", credentials.process);
  add("orchestrator", credentials.orchestrator.ToHex());
  for (const Document& document : kDocuments) add(document.key, credentials.*document.text);
  return text;
}

Credentials CredentialsFrom(const std::string& text, const std::string& name) {
  Section section = Section::FromText(text, name);
  section.Use(kKeys);
  Credentials credentials;
  credentials.process = section.Text("process");
  const std::string orchestrator = section.Text("orchestrator");
  if (const auto key = ProcessKey::FromHex(orchestrator))
    credentials.orchestrator = *key;
  else if (!section.Wrong("orchestrator"))
    section.Fail("orchestrator", "expected twelve hexadecimal digits, got '" + orchestrator + "'");
  for (const Document& document : kDocuments) credentials.*document.text = section.Text(document.key);
  section.Done();
  section.ThrowIfWrong();
  return credentials;
}

Credentials ReadCredentials(const std::filesystem::path& file) {
  RequirePrivate(file);
  return CredentialsFrom(ReadInput(file.string()), file.string());
}

Enclave::Enclave(const Credentials& credentials) {
  for (const Document& document : kDocuments) folder_.Write(document.file, credentials.*document.text);
}

void Enclave::Secure(eprosima::fastdds::dds::DomainParticipantQos& qos) const {
  const auto add = [&](std::string key, const std::string& value) {
    qos.properties().properties().emplace_back("dds.sec." + std::move(key), value);
  };
  const auto file = [&](std::string_view name) { return "file://" + (folder_.path() / name).string(); };
  const std::string identity = "auth.builtin.PKI-DH.", access = "access.builtin.Access-Permissions.";
  add("auth.plugin", "builtin.PKI-DH");
  add(identity + "identity_ca", file("identity_ca.cert.pem"));
  add(identity + "identity_certificate", file("cert.pem"));
  add(identity + "private_key", file("key.pem"));
  add("access.plugin", "builtin.Access-Permissions");
  add(access + "permissions_ca", file("permissions_ca.cert.pem"));
  add(access + "governance", file("governance.p7s"));
  add(access + "permissions", file("permissions.p7s"));
  add("crypto.plugin", "builtin.AES-GCM-GMAC");
}

}  // namespace mascot

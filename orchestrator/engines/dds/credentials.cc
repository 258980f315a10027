#include "orchestrator/engines/dds/credentials.h"

#include <fmt/format.h>
#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/pkcs7.h>
#include <openssl/rand.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include <algorithm>
#include <array>
#include <map>
#include <stdexcept>
#include <utility>

#include "bus/peers.h"
#include "orchestrator/engines/dds/rights.h"

namespace mascot {
namespace {

// Hosts need not agree about the time: what is signed is valid from the past to the far future, and of no use after the
// run, because nobody has the authority's key then.
constexpr const char* kNotBefore = "20000101000000Z";
constexpr const char* kNotAfter = "21000101000000Z";
constexpr const char* kValidity =
    "<validity><not_before>2000-01-01T00:00:00</not_before><not_after>2100-01-01T00:00:00</not_after></validity>";

template <class Object, void (*free)(Object*)>
struct Free {
  void operator()(Object* object) const { free(object); }
};
using PrivateKey = std::unique_ptr<EVP_PKEY, Free<EVP_PKEY, EVP_PKEY_free>>;
using Certificate = std::unique_ptr<X509, Free<X509, X509_free>>;
using Name = std::unique_ptr<X509_NAME, Free<X509_NAME, X509_NAME_free>>;
using Signature = std::unique_ptr<PKCS7, Free<PKCS7, PKCS7_free>>;
using Buffer = std::unique_ptr<BIO, Free<BIO, BIO_free_all>>;

void Require(bool worked) {
  if (worked) return;
  std::array<char, 256> why{};
  ERR_error_string_n(ERR_get_error(), why.data(), why.size());
  throw std::runtime_error(std::string("network.security: the credentials cannot be made: ") + why.data());
}

template <class Object>
Object Made(Object object) {
  Require(object != nullptr);
  return object;
}

Buffer NewBuffer() { return Made(Buffer(BIO_new(BIO_s_mem()))); }

std::string TextOf(const Buffer& buffer) {
  char* bytes = nullptr;
  const long size = BIO_get_mem_data(buffer.get(), &bytes);
  return {bytes, static_cast<std::size_t>(size)};
}

PrivateKey NewKey() { return Made(PrivateKey(EVP_EC_gen("P-256"))); }

/// Who a certificate is for. `unit` tells apart what has the same name.
struct Subject {
  std::string common_name, unit;
  /// As the permissions have it: RFC 2253.
  std::string Text() const { return "CN=" + common_name + ",OU=" + unit; }
};

Name NameOf(const Subject& subject) {
  Name name = Made(Name(X509_NAME_new()));
  const auto add = [&](int part, const std::string& text) {
    Require(X509_NAME_add_entry_by_NID(name.get(), part, MBSTRING_UTF8,
                                       reinterpret_cast<const unsigned char*>(text.data()),
                                       static_cast<int>(text.size()), -1, 0) == 1);
  };
  add(NID_organizationalUnitName, subject.unit);
  add(NID_commonName, subject.common_name);
  return name;
}

using Digest = std::array<unsigned char, EVP_MAX_MD_SIZE>;

Digest DigestOf(const Subject& subject) {
  Digest digest{};
  unsigned size = 0;
  Require(X509_NAME_digest(NameOf(subject).get(), EVP_sha256(), digest.data(), &size) == 1);
  return digest;
}

/// The subject of a start of a process. GUIDs begin with the digest of the subject (ProcessKey::WithSubject()): the
/// unit is chosen so that its first seven bits are the rank.
Subject SubjectOf(const std::string& process, int rank, int start) {
  for (int choice = 0;; ++choice) {
    Subject subject{.common_name = "/" + process, .unit = fmt::format("start {} choice {}", start, choice)};
    if (DigestOf(subject)[0] >> 1 == rank) return subject;
  }
}

void DrawSerial(X509* certificate) {
  std::array<unsigned char, 16> bytes{};
  Require(RAND_bytes(bytes.data(), static_cast<int>(bytes.size())) == 1);
  bytes[0] &= 0x7f;  // positive
  const std::unique_ptr<BIGNUM, Free<BIGNUM, BN_free>> number =
      Made(std::unique_ptr<BIGNUM, Free<BIGNUM, BN_free>>(BN_bin2bn(bytes.data(), bytes.size(), nullptr)));
  Require(BN_to_ASN1_INTEGER(number.get(), X509_get_serialNumber(certificate)) != nullptr);
}

void Extend(X509* certificate, int extension, const char* value) {
  using Extension = std::unique_ptr<X509_EXTENSION, Free<X509_EXTENSION, X509_EXTENSION_free>>;
  const Extension made = Made(Extension(X509V3_EXT_conf_nid(nullptr, nullptr, extension, value)));
  Require(X509_add_ext(certificate, made.get(), -1) == 1);
}

/// A certificate for `key`, signed by `issuer_key`.
Certificate Certify(const Subject& subject, EVP_PKEY* key, const Subject& issuer, EVP_PKEY* issuer_key) {
  Certificate certificate = Made(Certificate(X509_new()));
  constexpr long kVersion3 = 2;
  Require(X509_set_version(certificate.get(), kVersion3) == 1);
  DrawSerial(certificate.get());
  Require(ASN1_TIME_set_string_X509(X509_getm_notBefore(certificate.get()), kNotBefore) == 1);
  Require(ASN1_TIME_set_string_X509(X509_getm_notAfter(certificate.get()), kNotAfter) == 1);
  Require(X509_set_subject_name(certificate.get(), NameOf(subject).get()) == 1);
  Require(X509_set_issuer_name(certificate.get(), NameOf(issuer).get()) == 1);
  Require(X509_set_pubkey(certificate.get(), key) == 1);
  const bool is_authority = key == issuer_key;
  Extend(certificate.get(), NID_basic_constraints, is_authority ? "critical,CA:TRUE" : "critical,CA:FALSE");
  Require(X509_sign(certificate.get(), issuer_key, EVP_sha256()) > 0);
  return certificate;
}

std::string Pem(X509* certificate) {
  const Buffer buffer = NewBuffer();
  Require(PEM_write_bio_X509(buffer.get(), certificate) == 1);
  return TextOf(buffer);
}

std::string Pem(EVP_PKEY* key) {
  const Buffer buffer = NewBuffer();
  Require(PEM_write_bio_PrivateKey(buffer.get(), key, nullptr, nullptr, 0, nullptr, nullptr) == 1);
  return TextOf(buffer);
}

/// `text`, signed, as S/MIME.
std::string Signed(const std::string& text, X509* certificate, EVP_PKEY* key) {
  constexpr int kFlags = PKCS7_TEXT | PKCS7_DETACHED | PKCS7_STREAM;
  const Buffer content = Made(Buffer(BIO_new_mem_buf(text.data(), static_cast<int>(text.size()))));
  const Signature signature = Made(Signature(PKCS7_sign(certificate, key, nullptr, content.get(), kFlags)));
  const Buffer buffer = NewBuffer();
  Require(SMIME_write_PKCS7(buffer.get(), signature.get(), content.get(), kFlags) == 1);
  return TextOf(buffer);
}

/// network.protection is that of whole submessages: of who may read a topic, each has the key of its writer.
std::string Governance(int domain, Protection protection) {
  const std::string_view kinds[] = {"NONE", "SIGN", "ENCRYPT"};
  return fmt::format(
      R"(<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
     xsi:noNamespaceSchemaLocation="http://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_governance.xsd">
<domain_access_rules><domain_rule>
<domains><id>{}</id></domains>
<allow_unauthenticated_participants>false</allow_unauthenticated_participants>
<enable_join_access_control>true</enable_join_access_control>
<discovery_protection_kind>NONE</discovery_protection_kind>
<liveliness_protection_kind>NONE</liveliness_protection_kind>
<rtps_protection_kind>NONE</rtps_protection_kind>
<topic_access_rules><topic_rule>
<topic_expression>*</topic_expression>
<enable_discovery_protection>false</enable_discovery_protection>
<enable_liveliness_protection>false</enable_liveliness_protection>
<enable_read_access_control>true</enable_read_access_control>
<enable_write_access_control>true</enable_write_access_control>
<metadata_protection_kind>{}</metadata_protection_kind>
<data_protection_kind>NONE</data_protection_kind>
</topic_rule></topic_access_rules>
</domain_rule></domain_access_rules>
</dds>
)",
      domain, kinds[static_cast<std::size_t>(protection)]);
}

/// The topics that a process may use in one way; nothing, if there are none. `all` are the topics of the run: several
/// topics of a kind of which the process may use all are one expression, "rt/agent*/command", because each participant
/// sends its permissions to all others.
std::string Allowed(const char* how, const std::vector<Topic>& topics, const std::vector<Topic>& all) {
  if (topics.empty()) return "";
  std::string text = fmt::format("<{}><topics>\n", how);
  std::map<TopicKind, std::vector<Topic>> by_kind;
  for (const Topic& topic : topics) by_kind[topic.kind].push_back(topic);
  for (const auto& [kind, of_kind] : by_kind) {
    if (of_kind.size() > 1 && std::cmp_equal(of_kind.size(), std::ranges::count(all, kind, &Topic::kind)))
      text += fmt::format("<topic>rt/agent*/{}</topic>\n", TraitsOf(kind).name);
    else
      for (const Topic& topic : of_kind) text += "<topic>" + topic.DdsName() + "</topic>\n";
  }
  return text + fmt::format("</topics></{}>\n", how);
}

std::string Permissions(int domain, const Subject& subject, const Rights& rights, const std::vector<Topic>& all) {
  return fmt::format(
      R"(<?xml version="1.0" encoding="UTF-8"?>
<dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
     xsi:noNamespaceSchemaLocation="http://www.omg.org/spec/DDS-SECURITY/20170901/omg_shared_ca_permissions.xsd">
<permissions><grant name="{0}">
<subject_name>{1}</subject_name>
{2}
<allow_rule>
<domains><id>{3}</id></domains>
{4}{5}</allow_rule>
<default>DENY</default>
</grant></permissions>
</dds>
)",
      subject.common_name, subject.Text(), kValidity, domain, Allowed("publish", rights.writes, all),
      Allowed("subscribe", rights.reads, all));
}

const Subject& Authority() {
  static const Subject subject{.common_name = "MASCOT", .unit = "run"};
  return subject;
}

constexpr int kRankOfOrchestrator = kMaxRank - 1;  // below the physics server's

}  // namespace

struct CertificateAuthority::Keys {
  PrivateKey key = NewKey();
  Certificate certificate = Certify(Authority(), key.get(), Authority(), key.get());
};

CertificateAuthority::CertificateAuthority(const Experiment& experiment, int domain)
    : experiment_(experiment),
      domain_(domain),
      topics_(RightsOf(experiment, kOrchestrator).reads),
      keys_(std::make_unique<const Keys>()),
      governance_(
          Signed(Governance(domain, experiment.network.protection), keys_->certificate.get(), keys_->key.get())) {
  orchestrator_ = Issue(kOrchestrator, kRankOfOrchestrator);
  orchestrator_.credentials.orchestrator = orchestrator_.key;
}

CertificateAuthority::~CertificateAuthority() = default;

CertificateAuthority::Issued CertificateAuthority::Issue(const std::string& process, int rank, int start) const {
  const Subject subject = SubjectOf(process, rank, start);
  const PrivateKey key = NewKey();
  const Certificate certificate = Certify(subject, key.get(), Authority(), keys_->key.get());
  const std::string permissions = Permissions(domain_, subject, RightsOf(experiment_, process), topics_);
  const std::string authority = Pem(keys_->certificate.get());
  return {.credentials = {.process = process,
                          .identity_ca = authority,
                          .certificate = Pem(certificate.get()),
                          .private_key = Pem(key.get()),
                          .permissions_ca = authority,
                          .governance = governance_,
                          .permissions = Signed(permissions, keys_->certificate.get(), keys_->key.get()),
                          .orchestrator = orchestrator_.key},
          .key = ProcessKey::WithSubject(DigestOf(subject))};
}

std::shared_ptr<const Credentials> RunCredentials::Own() const {
  return std::make_shared<const Credentials>(authority_.OfOrchestrator().credentials);
}

Credentials RunCredentials::Issue(const std::string& process, int rank) {
  Newest& newest = newest_[process];
  CertificateAuthority::Issued issued = authority_.Issue(process, rank, newest.starts++);
  newest.key = issued.key;
  return std::move(issued.credentials);
}

std::filesystem::path RunCredentials::Write(const Credentials& credentials) {
  const std::string name = credentials.process + "_" + std::to_string(files_++) + ".toml";
  folder_.Write(name, ToText(credentials));
  return folder_.path() / name;
}

}  // namespace mascot

#include "agent/law_library.h"

#include <dlfcn.h>

#include <filesystem>
#include <stdexcept>
#include <string_view>

namespace mascot {
namespace {

constexpr const char* kSymbol = "mascot_plugin_law";
constexpr const char* kAlignment = "EIGEN_MAX_STATIC_ALIGN_BYTES";

[[noreturn]] void Refuse(const std::string& expected, const std::string& got) {
  throw std::runtime_error("expected " + expected + ", got " + got);
}

/// Before the loader looks: it would wait for ever for somebody to write into a pipe, and has odd words for a folder.
void RefuseWhatIsNoFile(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (error) Refuse("a shared library", path + ": " + error.message());
  if (!fs::is_regular_file(status)) Refuse("a shared library", path + ": not a regular file");
}

/// The loader's reason, which mostly begins with the path.
std::string Reason(const std::string& path) {
  const char* text = ::dlerror();
  const std::string reason = text != nullptr ? text : "the loader gives no reason";
  return reason.starts_with(path + ": ") ? reason : path + ": " + reason;
}

/// All symbols at once, so that one that is missing is found now and not in flight; none of them for anybody else, so
/// that two libraries may use the same names.
void* Load(const std::string& path) {
  RefuseWhatIsNoFile(path);
  void* library = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) Refuse("a shared library", Reason(path));
  return library;
}

const PluginFact* Find(const PluginFact* facts, std::string_view name) {
  while (facts->name != nullptr && facts->name != name) ++facts;
  return facts->name != nullptr ? facts : nullptr;
}

/// "alignof(Motion) = 32 (here 16), ...": what the library was compiled with, where this program was not.
std::string Differences(const PluginFact* theirs) {
  std::string text;
  for (const PluginFact* ours = kPluginFacts; ours->name != nullptr; ++ours) {
    const PluginFact* their = Find(theirs, ours->name);
    if (their != nullptr && their->value == ours->value) continue;
    text += (text.empty() ? "" : ", ") + std::string(ours->name) + " = " +
            (their != nullptr ? std::to_string(their->value) : "nothing") + " (here " + std::to_string(ours->value) +
            ")";
  }
  return text;
}

/// What usually makes Eigen's alignment another.
std::string Advice(const PluginFact* theirs) {
  const PluginFact* their = Find(theirs, kAlignment);
  const PluginFact* ours = Find(kPluginFacts, kAlignment);
  if (their == nullptr || their->value == ours->value) return "";
  return "; -march=native and -mavx change Eigen's alignment: leave them out or add -D" + std::string(kAlignment) +
         "=" + std::to_string(ours->value);
}

}  // namespace

LawLibrary::LawLibrary(const std::string& path) : law_(static_cast<const PluginExport*>(::dlsym(Load(path), kSymbol))) {
  if (law_ == nullptr)
    Refuse("a library that exports " + std::string(kSymbol) + " (by MASCOT_PLUGIN_LAW)", path + " without it");
  if (law_->interface != kLawInterface)
    Refuse(
        "a library of law interface " + std::to_string(kLawInterface),
        path + " of interface " + std::to_string(law_->interface) + " (compile it against the headers of this MASCOT)");
  const std::string differences = Differences(law_->facts);
  if (!differences.empty())
    Refuse("a library compiled as this program was", path + " with " + differences + Advice(law_->facts));
}

}  // namespace mascot

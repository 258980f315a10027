#include "agent/laws/plugin/law_library.h"

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

/// Throws unless `path` is a regular file. The loader would wait for ever on a pipe, and its message for a folder is
/// misleading.
void RequireRegularFile(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (error) Refuse("a shared library", path + ": " + error.message());
  if (!fs::is_regular_file(status)) Refuse("a shared library", path + ": not a regular file");
}

/// The loader's reason for its last failure, with `path` in front.
std::string Reason(const std::string& path) {
  const char* text = ::dlerror();
  const std::string reason = text != nullptr ? text : "the loader gives no reason";
  return reason.starts_with(path + ": ") ? reason : path + ": " + reason;
}

/// Loads a library. RTLD_NOW finds a missing symbol now and not during a run; RTLD_LOCAL lets two libraries use the
/// same names.
void* Load(const std::string& path) {
  RequireRegularFile(path);
  void* library = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) Refuse("a shared library", Reason(path));
  return library;
}

const PluginFact* Find(const PluginFact* facts, std::string_view name) {
  while (facts->name != nullptr && facts->name != name) ++facts;
  return facts->name != nullptr ? facts : nullptr;
}

/// What differs between the compilation of the library and of this program: "alignof(Motion) = 32 (here 16), ...".
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

/// A hint at the usual reason if Eigen's alignment differs; else empty.
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

#include "agent/fmi/fmu.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <atomic>
#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "agent/fmi/archive.h"
#include "agent/fmi/error.h"
#include "base/fnv.h"
#include "base/utf8.h"
#include "system/private_folder.h"

namespace mascot {
namespace {

constexpr const char* kModelDescription = "modelDescription.xml";
constexpr std::string_view kResources = "resources/";

#if defined(__aarch64__)
constexpr std::string_view kPlatformsOfFmi2[] = {"aarch64-linux"};  // the standard has none; tools use that of FMI 3
constexpr std::string_view kPlatformsOfFmi3[] = {"aarch64-linux"};
#else
constexpr std::string_view kPlatformsOfFmi2[] = {"linux64"};
constexpr std::string_view kPlatformsOfFmi3[] = {"x86_64-linux"};
#endif

ModelDescription ReadModel(const FmuArchive& archive) {
  if (!archive.Has(kModelDescription)) throw FmuError("an archive without modelDescription.xml");
  return ModelDescription::FromXml(archive.Read(kModelDescription));
}

std::string Listed(const std::set<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

/// The folder in the archive with the library for this platform: "binaries/linux64/". Throws FmuError if there is none.
std::string BinariesIn(const FmuArchive& archive, const ModelDescription& model) {
  const auto platforms = model.version == 2 ? std::span(kPlatformsOfFmi2) : std::span(kPlatformsOfFmi3);
  const std::string library = model.model_identifier + ".so";
  for (const std::string_view platform : platforms) {
    std::string folder = "binaries/" + std::string(platform) + "/";
    if (archive.Has(folder + library)) return folder;
  }
  std::set<std::string> others;
  bool has_sources = false;
  for (const auto& [name, size] : archive.sizes()) {
    has_sources = has_sources || name.starts_with("sources/");
    constexpr std::string_view kBinaries = "binaries/";
    if (const auto slash = name.find('/', kBinaries.size()); name.starts_with(kBinaries) && slash != name.npos)
      others.insert(name.substr(kBinaries.size(), slash - kBinaries.size()));
  }
  const std::string missing = fmt::format("an FMU without binaries/{}/{}", platforms.front(), library);
  if (!others.empty()) throw FmuError(missing + "; it has binaries for " + Listed(others));
  throw FmuError(missing + (has_sources ? ": it has sources alone, compile it first" : ""));
}

/// A library that is loaded stays; its folder goes when the process exits.
void KeepUntilExit(std::shared_ptr<const Fmu> fmu) {
  static std::mutex mutex;
  static std::vector<std::shared_ptr<const Fmu>> kept;
  const std::lock_guard lock(mutex);
  kept.push_back(std::move(fmu));
}

class LoadedFmu final : public Fmu, public std::enable_shared_from_this<LoadedFmu> {
 public:
  explicit LoadedFmu(const std::string& bytes)
      : bytes_(bytes), archive_(bytes), model_(ReadModel(archive_)), binaries_(BinariesIn(archive_, model_)) {}

  const std::string& bytes() const { return bytes_; }
  const ModelDescription& model() const override { return model_; }
  std::unique_ptr<FmuInstance> Instantiate(const std::string& name, FmuLog log) const override;

 private:
  /// An instance that is counted, and keeps the FMU.
  class Counted;

  /// Unpacks and loads the library, once.
  const FmuLibrary& Library() const;

  const std::string bytes_;
  const FmuArchive archive_;
  const ModelDescription model_;
  const std::string binaries_;
  mutable std::mutex mutex_;
  mutable std::optional<PrivateFolder> folder_;
  mutable std::optional<FmuLibrary> library_;
  mutable std::atomic<int> instances_ = 0;
};

class LoadedFmu::Counted final : public FmuInstance {
 public:
  Counted(std::shared_ptr<const LoadedFmu> fmu, const std::string& name, FmuLog log) : fmu_(std::move(fmu)) {
    const FmuLibrary& library = fmu_->Library();
    if (*library.is_dead) throw FmuError("it has had a fatal error, after which this process must not use it");
    if (fmu_->instances_.fetch_add(1) > 0 && fmu_->model_.once_per_process) {
      --fmu_->instances_;
      throw FmuError(
          "a process can have it only once (canBeInstantiatedOnlyOncePerProcess), and another agent has it: fly the "
          "experiment over DDS, with a process for each agent (network.agents_per_process = 1)");
    }
    try {
      one_ = fmu_->model_.version == 2 ? MakeFmi2Instance(library, name, std::move(log))
                                       : MakeFmi3Instance(library, name, std::move(log));
    } catch (...) {
      --fmu_->instances_;
      throw;
    }
  }
  ~Counted() override {
    one_.reset();
    --fmu_->instances_;
  }
  Counted(const Counted&) = delete;
  Counted& operator=(const Counted&) = delete;

  void Begin(const FmuSettings& settings) override { one_->Begin(settings); }
  void Start() override { one_->Start(); }
  void Set(FmuNumbers& numbers) override { one_->Set(numbers); }
  void Set(const FmuTexts& texts) override { one_->Set(texts); }
  void Get(FmuNumbers& numbers) override { one_->Get(numbers); }
  void Step(double t_s, double step_s) override { one_->Step(t_s, step_s); }

 private:
  std::shared_ptr<const LoadedFmu> fmu_;
  std::unique_ptr<FmuInstance> one_;
};

const FmuLibrary& LoadedFmu::Library() const {
  const std::lock_guard lock(mutex_);
  if (library_) return *library_;
  folder_.emplace();
  for (const auto& [name, size] : archive_.sizes())
    if (name.starts_with(binaries_) || name.starts_with(kResources))
      folder_->Write(name, archive_.Read(name), archive_.executables().contains(name));
  std::filesystem::create_directories(folder_->path() / kResources);
  const std::string path = (folder_->path() / (binaries_ + model_.model_identifier + ".so")).string();
  void* const handle = ::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) {
    const char* const reason = ::dlerror();
    throw FmuError("its library cannot be loaded: " + PlainLine(reason != nullptr ? reason : "no reason is given"));
  }
  library_.emplace(FmuLibrary{handle, model_, (folder_->path() / kResources).string()});
  KeepUntilExit(shared_from_this());
  return *library_;
}

std::unique_ptr<FmuInstance> LoadedFmu::Instantiate(const std::string& name, FmuLog log) const {
  return std::make_unique<Counted>(shared_from_this(), name, std::move(log));
}

}  // namespace

std::string Fmu::Pack(std::string archive) {
  const FmuArchive all(std::move(archive));
  const std::string binaries = BinariesIn(all, ReadModel(all));
  std::map<std::string, std::string> files;
  for (const auto& [name, size] : all.sizes())
    if (name == kModelDescription || name.starts_with(binaries) || name.starts_with(kResources))
      files[name] = all.Read(name);
  return PackFiles(files, all.executables());
}

std::shared_ptr<const Fmu> Fmu::Of(const std::string& archive) {
  static std::mutex mutex;
  static std::map<std::uint64_t, std::weak_ptr<const LoadedFmu>> known;  // by hash of the bytes
  const std::lock_guard lock(mutex);
  std::weak_ptr<const LoadedFmu>& place = known[Fnv1a(archive)];
  if (const auto fmu = place.lock(); fmu && fmu->bytes() == archive) return fmu;
  auto fmu = std::make_shared<const LoadedFmu>(archive);
  place = fmu;
  return fmu;
}

}  // namespace mascot

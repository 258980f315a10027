#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "experiment/toml/section.h"
#include "system/private_folder.h"

namespace mascot {

/// The files of law.data: they travel with the experiment, and each process that runs the law has copies of them.
class LawData {
 public:
  using Files = std::map<std::string, std::string>;  ///< contents by name, as law.data has it
  explicit LawData(Files files) : files_(std::move(files)) {}

  /// The absolute paths of the copies, by name. The first call writes them, into a folder that lives as long as this
  /// object. Throws std::runtime_error if they cannot be written. Several threads may call it.
  const std::map<std::string, std::string>& Paths() const;

 private:
  const Files files_;
  mutable std::once_flag written_;
  mutable std::optional<PrivateFolder> folder_;
  mutable std::map<std::string, std::string> paths_;
};

/// The largest size of the files of a law together (bytes).
inline constexpr std::size_t kMaxLawData = std::size_t{4} << 20;

/// Reads law.data, from law.data_base64 if the law has that, as resolved experiments do, else from the files beside the
/// experiment.
std::shared_ptr<const LawData> ReadLawData(Section& law);

}  // namespace mascot

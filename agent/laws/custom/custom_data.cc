// The files that a law in Python reads, law.data.
#include "agent/laws/custom/custom_data.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <vector>

#include "base/base64.h"
#include "base/utf8.h"

namespace mascot {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSizeExpected = "expected files of at most 4 MiB together, which travel with the experiment";

/// What is wrong with a name, "expected ..., got ..."; empty: nothing.
std::string NameMistake(const std::string& name) {
  const fs::path path(name);
  const bool is_inside = path.is_relative() && std::ranges::none_of(path, [](const fs::path& part) {
                           return part == ".." || part == "." || part.empty();
                         });
  if (!name.empty() && is_inside && Plain(name) == name) return "";
  return "expected the path of a file in the folder of this file or below it, such as \"weights/w.npy\", got '" +
         PlainLine(name) + "'";
}

/// The contents of a file beside the experiment; notes a mistake in entry `k` of the list if it cannot be read, or is
/// too large with the others, whose size is `others`.
std::string Contents(Section& law, std::size_t k, const std::string& name, std::size_t others) {
  const std::string path = (fs::path(law.PlaceOfText("data").folder) / name).string();
  std::error_code error;
  if (const auto size = fs::file_size(path, error); !error && size > kMaxLawData - others) {
    law.FailRow("data", k, std::string(kSizeExpected) + ", got " + std::to_string(others + size) + " bytes");
    return "";
  }
  try {
    std::string contents = ReadRegularFile(path);
    if (contents.size() <= kMaxLawData - others) return contents;
    law.FailRow("data", k, std::string(kSizeExpected) + ", got more: it grows while it is read");
  } catch (const ConfigError& mistake) {
    law.FailRow("data", k, std::string("expected a readable file, got ") + mistake.what());
  }
  return "";
}

/// The contents in law.data_base64. Notes what is no base64.
LawData::Files Decoded(Section& law, const Value& recorded) {
  LawData::Files files;
  std::size_t size = 0;
  for (const auto& [name, text] : std::get<Value::Table>(recorded.data)) {
    const auto* words = std::get_if<std::string>(&text.data);
    const auto bytes = words != nullptr ? FromBase64(*words) : std::nullopt;
    if (!bytes)
      law.FailInside("data_base64", name,
                     words != nullptr ? "expected base64, got other text" : "expected base64, got no text");
    size += bytes ? bytes->size() : 0;
    files[name] = bytes.value_or("");
  }
  if (size > kMaxLawData)
    law.Fail("data_base64", std::string(kSizeExpected) + ", got " + std::to_string(size) + " bytes");
  return files;
}

/// The contents of the files beside the experiment, and what the resolved experiment has of them.
LawData::Files FromDisk(Section& law, const std::vector<std::string>& names) {
  LawData::Files files;
  Value recorded;
  std::size_t size = 0;
  for (std::size_t k = 0; k < names.size() && !law.Wrong("data"); ++k) {
    files[names[k]] = Contents(law, k, names[k], size);
    size += files[names[k]].size();
    std::get<Value::Table>(recorded.data)[names[k]].data = ToBase64(files[names[k]]);
  }
  law.Free("data_base64", recorded);
  return files;
}

}  // namespace

const std::map<std::string, std::string>& LawData::Paths() const {
  std::call_once(written_, [this] {
    if (files_.empty()) return;
    folder_.emplace();
    for (const auto& [name, bytes] : files_) {
      folder_->Write(name, bytes);
      paths_[name] = (folder_->path() / name).string();
    }
  });
  return paths_;
}

std::shared_ptr<const LawData> ReadLawData(Section& law) {
  law.Supersede("data", {"data_base64"});
  if (!law.Has("data")) {
    if (law.Has("data_base64")) law.Fail("data_base64", "expected law.data with it, got none");
    return std::make_shared<LawData>(LawData::Files());
  }
  const std::vector<std::string> names = law.Texts("data");
  std::set<std::string> seen;
  for (std::size_t k = 0; k < names.size() && !law.Wrong("data"); ++k) {
    if (const std::string mistake = NameMistake(names[k]); !mistake.empty()) law.FailRow("data", k, mistake);
    if (!seen.insert(names[k]).second) law.FailRow("data", k, EachOnce("file", names[k]));
  }
  if (law.Wrong("data")) return std::make_shared<LawData>(LawData::Files());
  if (!law.Has("data_base64")) return std::make_shared<LawData>(FromDisk(law, names));
  const Value recorded = law.Free("data_base64");
  if (!std::holds_alternative<Value::Table>(recorded.data)) {
    law.Fail("data_base64", "expected a table, got a " + law.Kind("data_base64"));
    return std::make_shared<LawData>(LawData::Files());
  }
  LawData::Files files = Decoded(law, recorded);
  const bool are_same = files.size() == names.size() &&
                        std::ranges::all_of(names, [&](const std::string& name) { return files.contains(name); });
  if (!are_same && !law.Wrong("data_base64")) law.Fail("data_base64", "expected the files that law.data names");
  return std::make_shared<LawData>(std::move(files));
}

}  // namespace mascot

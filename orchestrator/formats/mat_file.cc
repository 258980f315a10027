#include "orchestrator/formats/mat_file.h"

#include <fcntl.h>
#include <matio.h>
#include <unistd.h>

#include <cassert>
#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "orchestrator/formats/bytes.h"
#include "orchestrator/formats/create_file.h"

namespace mascot {
namespace {

/// Most data bytes of a variable, so that it stays below 2 GiB together with its name and tags (less than 256 bytes).
constexpr std::uint64_t kMaxDataBytes = (std::uint64_t{1} << 31) - 256;

using File = std::unique_ptr<mat_t, decltype(&Mat_Close)>;
using Var = std::unique_ptr<matvar_t, decltype(&Mat_VarFree)>;

/// The product of `dimensions`. Throws std::runtime_error if so many doubles do not fit in a variable.
std::uint64_t CountValues(const std::string& name, std::span<const std::size_t> dimensions) {
  std::uint64_t values = 1;
  for (const std::size_t extent : dimensions) {
    values *= extent;
    if (values > kMaxDataBytes / sizeof(double))
      throw std::runtime_error(name + " does not fit a MATLAB file, whose variables are limited to 2 GiB");
  }
  return values;
}

/// Converts to UTF-16, MATLAB's encoding of characters. `utf8` must be valid.
std::u16string ToUtf16(std::string_view utf8) {
  std::u16string utf16;
  for (std::size_t i = 0; i < utf8.size();) {
    const auto lead = static_cast<unsigned char>(utf8[i]);
    const std::size_t bytes = lead < 0x80 ? 1 : lead < 0xE0 ? 2 : lead < 0xF0 ? 3 : 4;
    char32_t code = bytes == 1 ? lead : lead & (0x7Fu >> bytes);
    for (std::size_t k = 1; k < bytes; ++k) code = code << 6 | (static_cast<unsigned char>(utf8.at(i + k)) & 0x3Fu);
    i += bytes;
    if (code < 0x10000) {
      utf16.push_back(static_cast<char16_t>(code));
    } else {  // a surrogate pair
      utf16.push_back(static_cast<char16_t>(0xD800 + ((code - 0x10000) >> 10)));
      utf16.push_back(static_cast<char16_t>(0xDC00 + ((code - 0x10000) & 0x3FF)));
    }
  }
  return utf16;
}

/// Flushes the file to disk. Throws std::runtime_error, also for delayed write errors.
void Sync(const std::string& path) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const bool ok = fd >= 0 && ::fsync(fd) == 0;
  const int error = errno;
  if (fd >= 0) ::close(fd);
  if (!ok) throw std::runtime_error("cannot flush " + path + ": " + std::generic_category().message(error));
}

}  // namespace

/// What is compared when a variable is read back.
struct MatWriter::Variable {
  std::string name;
  std::vector<std::size_t> dimensions;
  std::uint32_t crc = 0;  // CRC-32 of the data

  explicit Variable(const matvar_t& var)
      : name(var.name),
        dimensions(var.dims, var.dims + var.rank),
        crc(Crc32(0, {static_cast<const std::uint8_t*>(var.data), var.nbytes})) {}
  bool operator==(const Variable&) const = default;
};

struct MatWriter::Impl {
  File file{nullptr, Mat_Close};
  std::vector<Variable> written;

  void Write(const std::string& name, matio_classes kind, matio_types type, std::span<const std::size_t> dimensions,
             const void* data, const std::string& path) {
    std::vector<std::size_t> dims(dimensions.begin(), dimensions.end());  // matio's API is not const
    const Var var(Mat_VarCreate(name.c_str(), kind, type, static_cast<int>(dims.size()), dims.data(),
                                const_cast<void*>(data), MAT_F_DONT_COPY_DATA),
                  Mat_VarFree);
    if (!var || Mat_VarWrite(file.get(), var.get(), MAT_COMPRESSION_NONE) != 0)
      throw std::runtime_error("cannot write " + name + " to " + path);
    written.emplace_back(*var);
  }
  bool ReadsBack(const std::string& path) const {
    const File back(Mat_Open(path.c_str(), MAT_ACC_RDONLY), Mat_Close);
    if (!back) return false;
    for (const Variable& variable : written) {
      const Var var(Mat_VarReadNext(back.get()), Mat_VarFree);
      if (!var || var->data == nullptr || Variable(*var) != variable) return false;
    }
    return true;
  }
};

MatWriter::MatWriter(const std::string& path) : part_(path), impl_(std::make_unique<Impl>()) {
  constexpr const char* kHeader = "MATLAB 5.0 MAT-file, written by MASCOT";  // matio's own has the time of day
  ::close(CreateFile(part_.name(), O_WRONLY));                               // matio would follow a link of that name
  impl_->file.reset(Mat_CreateVer(part_.name().c_str(), kHeader, MAT_FT_MAT5));
  if (!impl_->file)
    throw std::runtime_error("cannot create " + part_.name() + ": " + std::generic_category().message(errno));
}

MatWriter::~MatWriter() = default;

void MatWriter::RequireFits(const std::string& name, std::span<const std::size_t> dimensions) {
  CountValues(name, dimensions);
}

void MatWriter::Add(const std::string& name, std::span<const std::size_t> dimensions, std::span<const double> values) {
  [[maybe_unused]] const std::uint64_t count = CountValues(name, dimensions);
  assert(values.size() == count);
  impl_->Write(name, MAT_C_DOUBLE, MAT_T_DOUBLE, dimensions, values.data(), part_.name());
}

void MatWriter::AddText(const std::string& name, std::string_view text) {
  const std::u16string characters = ToUtf16(text);
  const std::size_t row[] = {1, characters.size()};
  impl_->Write(name, MAT_C_CHAR, MAT_T_UTF16, row, characters.data(), part_.name());
}

void MatWriter::Close() {
  const bool closed = Mat_Close(impl_->file.release()) == 0;
  if (!closed || !impl_->ReadsBack(part_.name()))
    throw std::runtime_error("cannot write " + part_.name() + ": it does not read back as written; is the disk full?");
  Sync(part_.name());
  part_.Commit();
}

}  // namespace mascot

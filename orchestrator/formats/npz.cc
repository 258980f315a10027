#include "orchestrator/formats/npz.h"

#include <fcntl.h>
#include <unistd.h>
#include <zlib.h>

#include <cassert>
#include <cerrno>
#include <functional>
#include <numeric>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "orchestrator/formats/bytes.h"
#include "orchestrator/formats/create_file.h"
#include "orchestrator/formats/output_file.h"
#include "orchestrator/formats/part_file.h"
#include "orchestrator/formats/zip.h"

namespace mascot {
namespace {

constexpr std::size_t kNpzBufferBytes = std::size_t{64} << 10;

[[noreturn]] void Fail(const std::string& what, const std::string& path) {
  throw std::runtime_error("cannot " + what + " " + path + ": " + std::generic_category().message(errno));
}

/// An array that grows in an unlinked temporary file, which is removed whenever the process ends.
class Spool {
 public:
  explicit Spool(std::string path) : path_(std::move(path)) {
    fd_ = CreateFile(path_, O_RDWR);
    ::unlink(path_.c_str());
    buffer_.reserve(kNpzBufferBytes);
  }
  ~Spool() { ::close(fd_); }
  Spool(const Spool&) = delete;
  Spool& operator=(const Spool&) = delete;

  void Append(ByteSpan bytes) {
    mascot::Append(buffer_, bytes);
    size_ += bytes.size();
    if (buffer_.size() >= kNpzBufferBytes) Flush();
  }
  /// Passes all bytes to `sink`, in pieces.
  void CopyTo(const std::function<void(ByteSpan)>& sink) {
    Flush();
    buffer_.resize(kNpzBufferBytes);
    for (std::uint64_t done = 0; done < size_;) {
      const ssize_t got = ::pread(fd_, buffer_.data(), buffer_.size(), static_cast<off_t>(done));
      if (got < 0 && errno == EINTR) continue;
      if (got == 0) errno = EIO;  // the file was shortened
      if (got <= 0) Fail("read", path_);
      sink(ByteSpan(buffer_).first(static_cast<std::size_t>(got)));
      done += static_cast<std::uint64_t>(got);
    }
    buffer_.clear();
  }
  std::uint64_t size() const { return size_; }
  std::uint32_t crc() const { return Crc32(crc_, buffer_); }

 private:
  void Flush() {
    crc_ = Crc32(crc_, buffer_);
    if (!WriteFully(fd_, buffer_)) Fail("write", path_);
    buffer_.clear();
  }

  std::string path_;
  int fd_ = -1;
  std::uint64_t size_ = 0;
  std::uint32_t crc_ = 0;  // CRC of the bytes flushed
  Bytes buffer_;
};

struct Array {
  std::string name;
  std::string dtype;
  std::vector<std::size_t> row_shape;
  std::unique_ptr<Spool> spool;

  std::size_t row_values() const {
    return std::accumulate(row_shape.begin(), row_shape.end(), std::size_t{1}, std::multiplies<>());
  }
};

/// .npy header as in numpy/lib/format.py, version 1.0: magic, version, u16 length, a Python dict padded with spaces so
/// that the data begins at a multiple of 64.
Bytes NpyHeader(const Array& array) {
  const std::uint64_t rows = array.spool->size() / (array.row_values() * sizeof(double));
  std::string shape = std::to_string(rows) + ",";
  for (const std::size_t extent : array.row_shape) shape += " " + std::to_string(extent) + ",";
  if (!array.row_shape.empty()) shape.pop_back();  // a tuple with one element keeps its comma
  std::string dict = "{'descr': '" + array.dtype + "', 'fortran_order': False, 'shape': (" + shape + "), }";
  constexpr std::size_t kPrefixBytes = 10;
  dict.append(63 - (kPrefixBytes + dict.size()) % 64, ' ').push_back('\n');

  Bytes header;
  Append(header, AsBytes(std::string_view("\x93NUMPY\x01\x00", 8)));
  Append(header, static_cast<std::uint16_t>(dict.size()));
  Append(header, AsBytes(dict));
  return header;
}

}  // namespace

struct NpzWriter::Impl {
  std::string path;
  std::vector<Array> arrays;

  int Add(const std::string& name, const std::string& dtype, std::vector<std::size_t> row_shape) {
    auto spool = std::make_unique<Spool>(path + "." + std::to_string(arrays.size()) + ".part");
    arrays.push_back({name, dtype, std::move(row_shape), std::move(spool)});
    return static_cast<int>(arrays.size()) - 1;
  }
  void Join(const std::string& target);
};

NpzWriter::NpzWriter(const std::string& path) : impl_(std::make_unique<Impl>()) { impl_->path = path; }
NpzWriter::~NpzWriter() = default;

int NpzWriter::AddArray(const std::string& name, std::vector<std::size_t> row_shape) {
  return impl_->Add(name, "<f8", std::move(row_shape));
}

void NpzWriter::Append(int array, std::span<const double> row) {
  const Array& target = impl_->arrays.at(static_cast<std::size_t>(array));
  assert(row.size() == target.row_values());
  target.spool->Append(AsBytes(row));
}

void NpzWriter::AddConstant(const std::string& name, std::span<const std::int64_t> values) {
  const int array = impl_->Add(name, "<i8", {});
  impl_->arrays[static_cast<std::size_t>(array)].spool->Append(AsBytes(values));
}

void NpzWriter::Close() {
  PartFile part(impl_->path);
  impl_->Join(part.name());
  part.Commit();
}

void NpzWriter::Impl::Join(const std::string& target) {
  ZipWriter zip(target);
  for (const Array& array : arrays) {
    const Bytes header = NpyHeader(array);
    const std::uint64_t size = array.spool->size();
    const std::uint32_t crc =
        static_cast<std::uint32_t>(::crc32_combine(Crc32(0, header), array.spool->crc(), static_cast<z_off_t>(size)));
    zip.Begin(array.name + ".npy", header.size() + size, crc);
    zip.Write(header);
    array.spool->CopyTo([&zip](ByteSpan bytes) { zip.Write(bytes); });
  }
  zip.Close();
  arrays.clear();
}

}  // namespace mascot

#include "orchestrator/formats/npz.h"

#include <zlib.h>

#include <algorithm>
#include <cassert>
#include <functional>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "orchestrator/formats/bytes.h"
#include "orchestrator/formats/unnamed_file.h"
#include "orchestrator/formats/zip.h"

namespace mascot {
namespace {

constexpr std::size_t kNpzBufferBytes = std::size_t{64} << 10;
static_assert(sizeof(double) == sizeof(std::int64_t));

struct Array {
  std::string name;
  std::string dtype;
  std::vector<std::size_t> row_shape;
  bool is_constant;

  std::uint64_t max_rows = 0, rows = 0;
  std::uint64_t begin = 0;  // of its rows, in the file
  std::uint64_t flushed = 0;
  std::uint32_t crc = 0;  // of the bytes flushed
  Bytes buffer = {};

  std::size_t row_values() const {
    return std::accumulate(row_shape.begin(), row_shape.end(), std::size_t{1}, std::multiplies<>());
  }
  std::uint64_t Size(std::uint64_t of_rows) const { return of_rows * row_values() * sizeof(double); }
};

/// .npy header as in numpy/lib/format.py, version 1.0: magic, version, u16 length, a Python dict padded with spaces so
/// that the data begins at a multiple of 64.
Bytes NpyHeader(const Array& array, std::uint64_t rows) {
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
  UnnamedFile file;
  std::string path;
  std::uint64_t max_rows, max_bytes;
  std::vector<Array> arrays = {};
  bool has_rows = false;

  /// Gives each array room for its rows: for as many as may come, or as fit into the largest file.
  void MakeRoom();
  /// Gives each array its place. It has all the rows that it may have, or those that have come.
  void Place(std::uint64_t Array::*rows);
  void Flush(Array& array);
};

void NpzWriter::Impl::MakeRoom() {
  std::uint64_t row_bytes = 0;
  for (const Array& array : arrays)
    if (!array.is_constant) row_bytes += array.Size(1);
  for (Array& array : arrays)
    array.max_rows = array.is_constant ? array.rows : std::min(max_rows, max_bytes / row_bytes);
  Place(&Array::max_rows);
}

void NpzWriter::Impl::Place(std::uint64_t Array::*rows) {
  ZipRecords zip;
  std::uint64_t end = 0;
  for (Array& array : arrays) {
    const std::uint64_t header = NpyHeader(array, array.*rows).size(), size = array.Size(array.*rows);
    const std::uint64_t begin = end + zip.Add(array.name + ".npy", end, header + size, 0).size() + header;
    file.MoveDown(std::exchange(array.begin, begin), begin, array.flushed);
    end = begin + size;
  }
}

void NpzWriter::Impl::Flush(Array& array) {
  file.WriteAt(array.begin + array.flushed, array.buffer);
  array.crc = Crc32(array.crc, array.buffer);
  array.flushed += array.buffer.size();
  array.buffer.clear();
}

NpzWriter::NpzWriter(const std::string& path, std::uint64_t max_rows, std::uint64_t max_bytes)
    : impl_(new Impl{.file = UnnamedFile(path), .path = path, .max_rows = max_rows, .max_bytes = max_bytes}) {}
NpzWriter::~NpzWriter() = default;

int NpzWriter::AddArray(const std::string& name, std::vector<std::size_t> row_shape) {
  assert(!impl_->has_rows);
  impl_->arrays.push_back({name, "<f8", std::move(row_shape), false});
  return static_cast<int>(impl_->arrays.size()) - 1;
}

void NpzWriter::AddConstant(const std::string& name, std::span<const std::int64_t> values) {
  assert(!impl_->has_rows);
  Array& array = impl_->arrays.emplace_back(Array{name, "<i8", {}, true});
  array.rows = values.size();
  mascot::Append(array.buffer, AsBytes(values));
}

void NpzWriter::Append(int array, std::span<const double> row) {
  Array& target = impl_->arrays.at(static_cast<std::size_t>(array));
  assert(row.size() == target.row_values());
  if (!std::exchange(impl_->has_rows, true)) impl_->MakeRoom();
  if (target.rows == impl_->max_rows)
    throw std::logic_error("NpzWriter: array " + target.name + " has its " + std::to_string(target.rows) + " rows");
  if (target.rows == target.max_rows)
    throw std::runtime_error("cannot write " + impl_->path + ": it has " + std::to_string(target.rows) +
                             " rows, and no room for more");
  ++target.rows;
  mascot::Append(target.buffer, AsBytes(row));
  if (target.buffer.size() >= kNpzBufferBytes) impl_->Flush(target);
}

void NpzWriter::Close() {
  Impl& npz = *impl_;
  npz.Place(&Array::rows);
  ZipRecords zip;
  std::uint64_t end = 0;
  for (Array& array : npz.arrays) {
    npz.Flush(array);
    const Bytes npy = NpyHeader(array, array.rows);
    const auto crc =
        static_cast<std::uint32_t>(::crc32_combine(Crc32(0, npy), array.crc, static_cast<z_off_t>(array.flushed)));
    Bytes header = zip.Add(array.name + ".npy", end, npy.size() + array.flushed, crc);
    mascot::Append(header, npy);
    npz.file.WriteAt(end, header);
    end = array.begin + array.flushed;
  }
  const Bytes records = zip.End(end);
  npz.file.WriteAt(end, records);
  npz.file.Commit(end + records.size());
}

}  // namespace mascot

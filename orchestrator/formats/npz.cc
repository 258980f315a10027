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
constexpr std::uint64_t kLargestFile = std::uint64_t{1} << 62;  // no file system has larger ones
static_assert(sizeof(double) == sizeof(std::int64_t));

struct Array {
  std::string name;
  std::string dtype;
  std::vector<std::size_t> row_shape;
  bool is_constant;

  std::uint64_t rows = 0, room = 0;  // that it has, and that it has a place for
  std::uint64_t begin = 0;           // of its rows, in the file
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
  /// Where everything is in the file.
  struct Layout {
    struct Entry {
      std::uint64_t begin = 0;
      Bytes headers = {};  // of zip and of npy; the rows follow
      std::uint64_t rows() const { return begin + headers.size(); }
    };
    std::vector<Entry> entries = {};  // of the arrays
    std::uint64_t end = 0;            // of the last one
    ZipRecords zip = ZipRecords();
  };

  UnnamedFile file;
  std::uint64_t max_rows;
  std::vector<Array> arrays = {};
  bool has_places = false;
  std::uint64_t room = 0;  // of each array that grows, in rows

  /// Makes room for all rows that may come, or for as many as the file system grants.
  void MakeRoom();
  /// The places of the arrays, each with the rows that it has or has room for.
  Layout LayOut(std::uint64_t Array::*rows) const;
  void Move(Array& array, const Layout::Entry& to);
  void Flush(Array& array);
};

void NpzWriter::Impl::MakeRoom() {
  std::uint64_t row_bytes = 1;
  for (const Array& array : arrays) row_bytes += array.is_constant ? 0 : array.Size(1);
  const std::uint64_t largest = std::min(max_rows, kLargestFile / row_bytes);
  std::uint64_t more = room == 0 ? largest : std::min(room, largest - room);
  const auto with_more = [&] {
    for (Array& array : arrays) array.room = array.is_constant ? array.rows : room + more;
    return LayOut(&Array::room);
  };
  while (more > 1 && !file.TryResize(with_more().end)) more /= 2;
  const Layout layout = with_more();
  file.Resize(layout.end);
  for (std::size_t i = arrays.size(); i > 0; --i) Move(arrays[i - 1], layout.entries[i - 1]);
  room += more;
  has_places = true;
}

NpzWriter::Impl::Layout NpzWriter::Impl::LayOut(std::uint64_t Array::*rows) const {
  Layout layout;
  for (const Array& array : arrays) {
    const Bytes npy = NpyHeader(array, array.*rows);
    const auto crc =
        static_cast<std::uint32_t>(::crc32_combine(Crc32(0, npy), array.crc, static_cast<z_off_t>(array.flushed)));
    const std::uint64_t size = array.Size(array.*rows);
    Layout::Entry& entry = layout.entries.emplace_back(Layout::Entry{.begin = layout.end});
    entry.headers = layout.zip.Add(array.name + ".npy", entry.begin, npy.size() + size, crc);
    mascot::Append(entry.headers, npy);
    layout.end = entry.rows() + size;
  }
  return layout;
}

void NpzWriter::Impl::Move(Array& array, const Layout::Entry& to) {
  file.Move(std::exchange(array.begin, to.rows()), to.rows(), array.flushed);
}

void NpzWriter::Impl::Flush(Array& array) {
  file.WriteAt(array.begin + array.flushed, array.buffer);
  array.crc = Crc32(array.crc, array.buffer);
  array.flushed += array.buffer.size();
  array.buffer.clear();
}

NpzWriter::NpzWriter(const std::string& path, std::uint64_t max_rows)
    : impl_(new Impl{.file = UnnamedFile(path), .max_rows = max_rows}) {}
NpzWriter::~NpzWriter() = default;

int NpzWriter::AddArray(const std::string& name, std::vector<std::size_t> row_shape) {
  assert(!impl_->has_places);
  impl_->arrays.push_back({name, "<f8", std::move(row_shape), false});
  return static_cast<int>(impl_->arrays.size()) - 1;
}

void NpzWriter::AddConstant(const std::string& name, std::span<const std::int64_t> values) {
  assert(!impl_->has_places);
  Array& array = impl_->arrays.emplace_back(Array{name, "<i8", {}, true});
  array.rows = values.size();
  mascot::Append(array.buffer, AsBytes(values));
}

void NpzWriter::Append(int array, std::span<const double> row) {
  Array& target = impl_->arrays.at(static_cast<std::size_t>(array));
  assert(row.size() == target.row_values());
  if (target.rows == impl_->max_rows)
    throw std::logic_error("NpzWriter: array " + target.name + " has its " + std::to_string(target.rows) + " rows");
  if (!impl_->has_places || target.rows == impl_->room) impl_->MakeRoom();
  ++target.rows;
  mascot::Append(target.buffer, AsBytes(row));
  if (target.buffer.size() >= kNpzBufferBytes) impl_->Flush(target);
}

void NpzWriter::Close() {
  if (!impl_->has_places) impl_->MakeRoom();
  for (Array& array : impl_->arrays) impl_->Flush(array);
  UnnamedFile& file = impl_->file;
  Impl::Layout layout = impl_->LayOut(&Array::rows);
  for (std::size_t i = 0; i < layout.entries.size(); ++i) {
    impl_->Move(impl_->arrays[i], layout.entries[i]);
    file.WriteAt(layout.entries[i].begin, layout.entries[i].headers);
  }
  const Bytes records = layout.zip.End(layout.end);
  file.WriteAt(layout.end, records);
  file.Commit(layout.end + records.size());
}

}  // namespace mascot

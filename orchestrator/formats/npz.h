#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace mascot {

/// Writes a NumPy .npz (uncompressed zip of .npy, zip64 where needed) whose arrays grow row by row on disk, so that
/// memory does not grow with the run. Byte-deterministic. np.load reads it without pickle. From the first row on, each
/// array has room in the file for all its rows, or for as many as the file system grants; full arrays are moved apart,
/// and Close() moves all together. Without Close() there is no file (UnnamedFile). Failures throw std::runtime_error.
class NpzWriter {
 public:
  /// `max_rows`: how many rows an array has at most.
  NpzWriter(const std::string& path, std::uint64_t max_rows);
  ~NpzWriter();
  NpzWriter(const NpzWriter&) = delete;
  NpzWriter& operator=(const NpzWriter&) = delete;

  /// Adds a float64 array of shape (rows, row_shape...) without rows. Returns its handle for Append. Arrays are in the
  /// file in the order in which they are added, all before the first row.
  int AddArray(const std::string& name, std::vector<std::size_t> row_shape);
  /// Adds a complete int64 array of shape (values.size()).
  void AddConstant(const std::string& name, std::span<const std::int64_t> values);
  /// Appends one row to an array: as many values as the product of its row_shape, in C order.
  void Append(int array, std::span<const double> row);
  /// Completes the file. No other call may follow.
  void Close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mascot

#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace mascot {

/// Writes a NumPy .npz (uncompressed zip of .npy, zip64 where needed) whose arrays grow row by row on disk, so that
/// memory does not grow with the run. Byte-deterministic. np.load reads it without pickle. Until Close(), each array is
/// an unlinked temporary file on the disk of `path`; Close() copies them into one file, in the order in which they were
/// added. Without Close() there is no file. Failures throw std::runtime_error.
class NpzWriter {
 public:
  explicit NpzWriter(const std::string& path);
  ~NpzWriter();
  NpzWriter(const NpzWriter&) = delete;
  NpzWriter& operator=(const NpzWriter&) = delete;

  /// Adds a float64 array of shape (rows, row_shape...) without rows. Returns its handle for Append.
  int AddArray(const std::string& name, std::vector<std::size_t> row_shape);
  /// Appends one row to an array: as many values as the product of its row_shape, in C order.
  void Append(int array, std::span<const double> row);
  /// Adds a complete int64 array of shape (values.size()).
  void AddConstant(const std::string& name, std::span<const std::int64_t> values);
  /// Completes the file. No other call may follow.
  void Close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mascot

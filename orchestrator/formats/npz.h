#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace mascot {

/// Writes a NumPy .npz (uncompressed zip of .npy, zip64 where needed) whose arrays grow row by row on
/// disk, so that memory does not grow with the run. Byte-deterministic. np.load reads it without pickle.
/// While open, one nameless temporary file per array takes room where `path` is; Close() joins them, in the
/// order in which they were added. Without Close() nothing is left. Failures throw std::runtime_error.
class NpzWriter {
 public:
  explicit NpzWriter(const std::string& path);
  ~NpzWriter();
  NpzWriter(const NpzWriter&) = delete;
  NpzWriter& operator=(const NpzWriter&) = delete;

  /// A float64 array of shape (rows, shape...), rows counted as they come. Returns its handle.
  int AddArray(const std::string& name, std::vector<std::size_t> row_shape);
  /// Appends one row: exactly the product of row_shape values, C order.
  void Append(int array, std::span<const double> row);
  /// A complete int64 array of shape (values.size()).
  void AddConstant(const std::string& name, std::span<const std::int64_t> values);
  void Close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mascot

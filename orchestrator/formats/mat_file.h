#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "orchestrator/formats/part_file.h"

namespace mascot {

/// Writes a MATLAB file (MAT 5, uncompressed: load() of every MATLAB since 5, Octave, SciPy). Byte-deterministic.
/// Failures throw std::runtime_error; without Close() there is no file.
class MatWriter {
 public:
  explicit MatWriter(const std::string& path);
  ~MatWriter();

  /// Throws if doubles of these dimensions do not fit a variable, which MAT 5 limits to 2 GiB.
  static void RequireFits(const std::string& name, std::span<const std::size_t> dimensions);
  /// A variable of doubles, in MATLAB's order: the first index runs fastest.
  void Add(const std::string& name, std::span<const std::size_t> dimensions, std::span<const double> values);
  /// A row of characters. `text` is UTF-8.
  void AddText(const std::string& name, std::string_view text);
  /// Completes the file and reads it back: matio (1.5.23) does not notice when the disk is full.
  void Close();

 private:
  struct Variable;
  struct Impl;
  PartFile part_;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mascot

#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "orchestrator/formats/part_file.h"

namespace mascot {

/// Writes a MATLAB file (MAT 5, uncompressed; MATLAB 5 and later, Octave and SciPy load it). Byte-deterministic.
/// Failures throw std::runtime_error; without Close() there is no file.
class MatWriter {
 public:
  explicit MatWriter(const std::string& path);
  ~MatWriter();

  /// Throws if an array of doubles of these dimensions exceeds the 2 GiB to which MAT 5 limits a variable.
  static void RequireFits(const std::string& name, std::span<const std::size_t> dimensions);
  /// Adds an array of doubles in column-major order (the first index runs fastest). Throws as RequireFits does.
  void Add(const std::string& name, std::span<const std::size_t> dimensions, std::span<const double> values);
  /// Adds a character row vector. `text` is UTF-8.
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

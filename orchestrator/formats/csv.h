#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "orchestrator/formats/output_file.h"
#include "orchestrator/formats/part_file.h"

namespace mascot {

/// Writes a table of numbers as comma-separated values below one line of column names. A double is written as the
/// shortest text that reads back as the same bits. Failures throw std::runtime_error; without Close() there is no file.
class CsvWriter {
 public:
  CsvWriter(const std::string& path, std::span<const std::string> columns);

  void Add(double value);
  void Add(std::int64_t value);
  void EndRow();
  void Close();

 private:
  template <class Number>
  void Put(Number value);
  void Flush();

  PartFile part_;
  OutputFile file_;
  std::string buffer_;
};

}  // namespace mascot

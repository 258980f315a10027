#include "orchestrator/formats/csv.h"

#include <charconv>

#include "orchestrator/formats/bytes.h"

namespace mascot {
namespace {

constexpr std::size_t kCsvBufferBytes = std::size_t{64} << 10;

}  // namespace

CsvWriter::CsvWriter(const std::string& path, std::span<const std::string> columns) : part_(path), file_(part_.name()) {
  for (const std::string& column : columns) buffer_.append(column).push_back(',');
  EndRow();
}

void CsvWriter::Add(double value) { Put(value); }
void CsvWriter::Add(std::int64_t value) { Put(value); }

template <class Number>
void CsvWriter::Put(Number value) {
  char text[32];  // the longest double takes 24 characters
  const auto result = std::to_chars(std::begin(text), std::end(text), value);
  buffer_.append(text, result.ptr).push_back(',');
}

void CsvWriter::EndRow() {
  buffer_.back() = '\n';  // in place of the last comma
  if (buffer_.size() >= kCsvBufferBytes) Flush();
}

void CsvWriter::Close() {
  Flush();
  file_.SyncAndClose();
  part_.Commit();
}

void CsvWriter::Flush() {
  file_.Write(AsBytes(buffer_));
  buffer_.clear();
}

}  // namespace mascot

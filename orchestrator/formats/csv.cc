#include "orchestrator/formats/csv.h"

#include <algorithm>
#include <charconv>

#include "orchestrator/formats/bytes.h"

namespace mascot {
namespace {

constexpr std::size_t kCsvBufferBytes = std::size_t{64} << 10;

void AppendCell(std::string_view cell, std::string& row) {
  if (cell.find_first_of(",\"\r\n") == std::string_view::npos) {
    row += cell;
    return;
  }
  row += '"';
  for (const char c : cell) row.append(c == '"' ? 2 : 1, c);
  row += '"';
}

/// Takes a quoted cell off `text`, up to what follows its last quote. Returns whether it has that quote.
bool TakeQuoted(std::string_view& text, std::string& cell) {
  for (text.remove_prefix(1); !text.empty(); text.remove_prefix(1)) {
    if (text.starts_with("\"\""))
      text.remove_prefix(1);
    else if (text[0] == '"')
      break;
    cell += text[0];
  }
  if (text.empty()) return false;
  text.remove_prefix(1);
  return true;
}

}  // namespace

std::string CsvRow(std::span<const std::string> cells) {
  std::string row;
  for (const std::string& cell : cells) {
    if (&cell != &cells.front()) row += ',';
    AppendCell(cell, row);
  }
  return row + "\n";
}

std::vector<std::string> TakeCsvRow(std::string_view& text) {
  std::vector<std::string> cells(1);
  bool is_quoted = false;
  std::size_t at = 0;
  for (; at < text.size() && (is_quoted || text[at] != '\n'); ++at) {
    if (text[at] == '"' && is_quoted && text.substr(at + 1).starts_with('"'))
      cells.back() += text[++at];
    else if (text[at] == '"')
      is_quoted = !is_quoted;
    else if (text[at] == ',' && !is_quoted)
      cells.emplace_back();
    else
      cells.back() += text[at];
  }
  text.remove_prefix(std::min(at + 1, text.size()));
  return cells;
}

std::string_view TakeForeignCsvRow(std::string_view& text, std::vector<std::string>& cells) {
  for (;;) {
    std::string& cell = cells.emplace_back();
    const bool is_quoted = text.starts_with('"');
    if (is_quoted && !TakeQuoted(text, cell)) return "no second quote";
    const std::string_view bare = text.substr(0, text.find_first_of(",\n"));
    text.remove_prefix(bare.size());
    const bool ends = text.empty() || text[0] == '\n';
    const std::string_view rest = ends && bare.ends_with('\r') ? bare.substr(0, bare.size() - 1) : bare;
    if (is_quoted && !rest.empty()) return "a character behind the second quote";
    if (rest.find('"') != rest.npos) return "a quote in a cell without quotes";
    cell += rest;
    if (!text.empty()) text.remove_prefix(1);
    if (ends) return {};
  }
}

std::string_view WholeCsvRows(std::string_view text) {
  bool is_quoted = false;
  std::size_t whole = 0;
  for (std::size_t at = 0; at < text.size(); ++at) {
    if (text[at] == '"') is_quoted = !is_quoted;  // a doubled quote changes it twice
    if (text[at] == '\n' && !is_quoted) whole = at + 1;
  }
  return text.substr(0, whole);
}

CsvWriter::CsvWriter(const std::string& path, std::span<const std::string> columns)
    : part_(path), file_(part_.name()), buffer_(CsvRow(columns)) {}

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

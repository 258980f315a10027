#include "experiment/toml/section.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "base/base64.h"
#include "experiment/toml/input.h"
#include "experiment/toml/section_internal.h"

namespace mascot {
namespace {

std::optional<Eigen::Vector3d> VectorIn(const toml::node& node, const Range& range) {
  const toml::array* list = node.as_array();
  if (list == nullptr || list->size() != 3) return std::nullopt;
  Eigen::Vector3d vector;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto number = NumberIn((*list)[axis], range);
    if (!number) return std::nullopt;
    vector[static_cast<Eigen::Index>(axis)] = *number;
  }
  return vector;
}

}  // namespace

// --- readers ----------------------------------------------------------------------------------------

Section::Section(std::shared_ptr<Document> document, std::shared_ptr<Table> table)
    : document_(std::move(document)), table_(std::move(table)) {}

bool Section::Has(std::string_view key) const { return table_->Find(key) != nullptr; }

bool Section::Wrong(std::string_view key) const { return table_->Wrong(key); }

std::string Section::Kind(std::string_view key) const {
  const toml::node* node = table_->Find(key);
  return node != nullptr ? KindOf(*node) : "";
}

void Section::Use(std::span<const Key> rows) {
  const auto same = [&](std::span<const Key> known) { return known.data() == rows.data(); };
  if (std::ranges::none_of(table_->rows, same)) table_->rows.push_back(rows);
}

double Section::Number(std::string_view key, std::optional<double> fallback) {
  return table_->Number(key, table_->RowOf(key).range, fallback);
}

double Section::Number(std::string_view key, double min, double max, std::optional<double> fallback) {
  return table_->Number(key, {min, max}, fallback);
}

double Section::Positive(std::string_view key, double max, std::optional<double> fallback) {
  return table_->Number(key, {0, max, true}, fallback);
}

std::int64_t Section::Integer(std::string_view key) {
  const Key& row = table_->RowOf(key);
  return Integer(key, row.min_integer, row.max_integer);
}

std::int64_t Section::Integer(std::string_view key, std::int64_t min, std::int64_t max,
                              std::optional<std::int64_t> fallback) {
  const std::string expected = "an integer in [" + std::to_string(min) + ", " + std::to_string(max) + "]";
  const std::int64_t value = table_->Read<std::int64_t>(
      key, expected, fallback, std::clamp<std::int64_t>(0, min, max), [&](const toml::node& node) {
        const auto integer = node.value_exact<std::int64_t>();
        return integer && *integer >= min && *integer <= max ? integer : std::nullopt;
      });
  table_->Record(key, std::to_string(value));
  return value;
}

bool Section::Boolean(std::string_view key, std::optional<bool> fallback) {
  const bool value = table_->Read<bool>(key, "true or false", fallback, false,
                                        [](const toml::node& node) { return node.value_exact<bool>(); });
  table_->Record(key, value ? "true" : "false");
  return value;
}

std::string Section::Text(std::string_view key, std::optional<std::string> fallback) {
  std::string value = table_->Read<std::string>(key, "a string", fallback, "", TextIn);
  table_->Record(key, StringToml(value));
  return value;
}

Section::Place Section::PlaceOfText(std::string_view key) const {
  const toml::node* node = table_->Get(key);
  const toml::source_region place = table_->PlaceOf(key);
  const auto origin = document_->OriginOf(place);
  const std::filesystem::path file(origin || DescriptorOf(document_->name) ? "" : document_->name);
  Place text{origin.value_or(file.filename().string()), file.parent_path().string(),
             origin ? 1 : static_cast<int>(place.begin.line)};
  const auto value = node != nullptr ? node->value_exact<std::string>() : std::nullopt;
  if (!value || origin) return text;
  // TOML drops a line break right after the opening quotes: the node then spans one line more than the text.
  const auto breaks = std::count(value->begin(), value->end(), '\n');
  if (static_cast<std::ptrdiff_t>(place.end.line - place.begin.line) == breaks + 1) ++text.line;
  return text;
}

std::string Section::Where(std::string_view key) const { return document_->PlaceText(table_->PlaceOf(key)); }

Section::FileText Section::TextOfFile(std::string_view key, std::string_view text_key) {
  const std::filesystem::path file = FileOf(key);
  std::string text = ReadFileOf(key, file);
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";  // some editors write it
  if (text.starts_with(kByteOrderMark)) text.erase(0, kByteOrderMark.size());
  table_->Record(text_key, StringToml(text));
  return {text, file.filename().string(), file.parent_path().string()};
}

Section::FileContents Section::ContentsOfFile(std::string_view key, std::string_view base64_key, std::size_t max) {
  FileContents contents = ContentsOfFile(key, max);
  table_->Record(base64_key, StringToml(ToBase64(contents.bytes)));
  return contents;
}

Section::FileContents Section::ContentsOfFile(std::string_view key, std::size_t max) {
  const std::filesystem::path file = FileOf(key);
  std::error_code error;
  if (const auto size = std::filesystem::file_size(file, error); !table_->Wrong(key) && !error && size > max)
    Fail(key, fmt::format("expected a file of at most {} bytes, which travels with the experiment, got {}", max, size));
  return {ReadFileOf(key, file, std::max(max, kMaxRegularFile)), file.filename().string()};
}

std::filesystem::path Section::FileOf(std::string_view key) {
  const std::string path = table_->Read<std::string>(key, "the path of a file", std::nullopt, "", TextIn);
  return std::filesystem::path(PlaceOfText(key).folder) / path;
}

std::string Section::ReadFileOf(std::string_view key, const std::filesystem::path& file, std::size_t max) {
  if (table_->Wrong(key)) return "";
  try {
    return ReadRegularFile(file.string(), max);
  } catch (const ConfigError& error) {
    Fail(key, std::string("expected a readable file, got ") + error.what());
    return "";
  }
}

std::string Section::PathOfFile(std::string_view key) {
  namespace fs = std::filesystem;
  const std::string given = table_->Read<std::string>(
      key, "the path of a file", std::nullopt, "", [](const toml::node& node) -> std::optional<std::string> {
        const std::optional<std::string> text = TextIn(node);
        return text && !text->empty() && !HasControls(*text) ? text : std::nullopt;
      });
  if (table_->Wrong(key)) return "";
  // Follows symbolic links to folders, so that ".." means what it means to the system; the file keeps its name.
  const fs::path beside = fs::absolute(fs::path(PlaceOfText(key).folder) / given);
  std::error_code error;
  const fs::path folder = fs::weakly_canonical(beside.parent_path(), error);
  const std::string path = (error ? beside : folder / beside.filename()).string();
  table_->Record(key, QuotedToml(path));
  return path;
}

std::string Section::OneOf(std::string_view key) { return OneOf(key, table_->RowOf(key).names); }

std::string Section::OneOf(std::string_view key, std::span<const std::string_view> names,
                           std::optional<std::string> fallback) {
  const toml::node* node = table_->Find(key);
  const auto text = node != nullptr ? node->value_exact<std::string>() : std::nullopt;
  if (text && std::find(names.begin(), names.end(), *text) != names.end()) {
    table_->Record(key, QuotedToml(*text));
    return *text;
  }
  if (!fallback) fallback = table_->RowDefault<std::string>(key, TextIn);
  const std::string value = fallback.value_or(names.empty() ? "" : std::string(names.front()));
  if (text) {
    const auto nearest = DidYouMean(*text, names);
    Fail(key, "expected one of " + Joined(names) + ", got '" + Printable(*text) + "'" +
                  (nearest ? " (did you mean \"" + *nearest + "\"?)" : ""));
  } else if (node != nullptr || !fallback) {
    table_->Expected(key, table_->PathOf(key), node, "one of " + Joined(names));
  }
  table_->Record(key, QuotedToml(value));
  return value;
}

std::vector<std::string> Section::Texts(std::string_view key, std::optional<std::vector<std::string>> fallback) {
  return table_->Texts(key, std::move(fallback));
}

Eigen::Vector3d Section::Vector3(std::string_view key, std::optional<Eigen::Vector3d> fallback) {
  const Range& range = table_->RowOf(key).range;
  if (!fallback)
    fallback = table_->RowDefault<Eigen::Vector3d>(key, [&](const toml::node& node) { return VectorIn(node, range); });
  return table_->Vector3(key, range, fallback);
}

Eigen::Vector3d Section::Vector3(std::string_view key, double min, double max,
                                 std::optional<Eigen::Vector3d> fallback) {
  return table_->Vector3(key, {min, max}, fallback);
}

std::vector<double> Section::Numbers(std::string_view key) { return table_->Numbers(key, table_->RowOf(key).range); }

std::vector<double> Section::Numbers(std::string_view key, double min, double max) {
  return table_->Numbers(key, {min, max});
}

std::vector<std::vector<double>> Section::Rows(std::string_view key) {
  return table_->Lists(key, table_->RowOf(key).range);
}

std::vector<std::vector<double>> Section::Rows(std::string_view key, double min, double max) {
  return table_->Lists(key, {min, max});
}

std::vector<Eigen::Vector3d> Section::Points(std::string_view key) {
  return table_->Points(key, table_->RowOf(key).range);
}

std::vector<Eigen::Vector3d> Section::Points(std::string_view key, double min, double max) {
  return table_->Points(key, {min, max});
}

std::vector<std::vector<Eigen::Vector3d>> Section::PointLists(std::string_view key) {
  return table_->PointLists(key, table_->RowOf(key).range);
}

Section Section::Child(std::string_view key) {
  const toml::node* node = table_->Find(key);
  if (const Table::Entry* entry = table_->Recorded(key)) return {document_, entry->tables.front()};
  if (node != nullptr && !node->is_table()) table_->Expected(key, table_->PathOf(key), node, "a table");
  auto child = table_->MakeChild(key, node, table_->PathOf(key));
  child->inherited = table_->inherited || table_->Inherits(key);
  table_->entries.push_back({std::string(key), "", {child}, false});
  return {document_, child};
}

std::vector<Section> Section::Children(std::string_view key) {
  const std::string expected = "a list of tables ([[" + table_->PathOf(key) + "]])";
  std::vector<Section> children;
  if (const toml::array* list = table_->List(key, expected)) {
    Table::Entry entry{std::string(key), "", {}, true};
    for (std::size_t i = 0; i < list->size(); ++i) {
      const std::string path = Indexed(table_->PathOf(key), i);
      if (!(*list)[i].is_table()) table_->Expected(key, path, list->get(i), "a table");
      entry.tables.push_back(table_->MakeChild(key, list->get(i), path));
      children.push_back({document_, entry.tables.back()});
    }
    table_->entries.push_back(std::move(entry));
  }
  return children;
}

Section Section::Child(std::string_view key, std::size_t index) {
  const toml::array* list = table_->Find(key)->as_array();
  auto child = table_->MakeChild(key, list->get(index), Indexed(table_->PathOf(key), index));
  table_->entries.push_back({std::string(key), "", {child}, true});
  return {document_, child};
}

void Section::InheritFrom(const Section& base, std::initializer_list<std::string_view> own) {
  table_->base = base.table_.get();
  table_->superseded.insert(own.begin(), own.end());
}

void Section::TakeOneOf(std::initializer_list<std::string_view> keys) {
  for (const std::string_view key : keys) {
    std::vector<std::string_view> others;
    std::ranges::copy_if(keys, std::back_inserter(others), [key](std::string_view other) { return other != key; });
    Supersede(key, others);
  }
}

void Section::Supersede(std::string_view key, std::span<const std::string_view> others) {
  if (!table_->Has(key)) return;
  table_->superseded.insert(others.begin(), others.end());
  const auto is_on_command_line = [&](std::string_view of) {
    return document_->origin.empty() && document_->OriginOf(table_->PlaceOf(of)).has_value();
  };
  if (!is_on_command_line(key)) return;
  for (const std::string_view other : others)
    if (table_->Has(other) && !is_on_command_line(other)) {
      table_->known.emplace(other);
      table_->left_out.emplace(other);
    }
}

Value Section::Free(std::string_view key, const Value& absent) {
  const toml::node* node = table_->Find(key);
  Value value = node != nullptr ? ToValue(*node) : absent;
  table_->Record(key, ToToml(value));
  return value;
}

// --- mistakes ---------------------------------------------------------------------------------------

void Section::Fail(std::string_view key, const std::string& message) {
  table_->wrong.emplace(key);
  document_->Note(table_->PlaceOf(key), table_->PathOf(key), PlainLine(message));
}

void Section::FailRow(std::string_view key, std::size_t row, const std::string& message) {
  table_->wrong.emplace(key);
  const toml::node* node = table_->Get(key);
  const toml::array* list = node != nullptr ? node->as_array() : nullptr;
  const toml::node* element = list != nullptr ? list->get(row) : nullptr;
  document_->Note(element != nullptr ? element->source() : table_->PlaceOf(key), Indexed(table_->PathOf(key), row),
                  message);
}

void Section::FailInside(std::string_view key, const std::string& inner, const std::string& message) {
  table_->wrong.emplace(key);
  const toml::node* node = table_->Get(key);
  const toml::table* values = node != nullptr ? node->as_table() : nullptr;
  const toml::node* value = values != nullptr ? values->get(inner.substr(0, inner.find_first_of(".["))) : nullptr;
  document_->Note(value != nullptr ? value->source() : table_->PlaceOf(key),
                  table_->PathOf(key) + "." + PlainLine(inner), PlainLine(message));
}

void Section::FailInText(std::string_view key, const std::string& place, const std::string& message) {
  table_->wrong.emplace(key);
  document_->NoteText(table_->PlaceOf(key), place + ": " + table_->PathOf(key) + ": " + message);
}

void Section::Done() {
  if (table_->toml == nullptr || table_->inherited) return;
  const std::vector<std::string_view> known(table_->known.begin(), table_->known.end());
  for (const auto& [key, node] : *table_->toml) {
    if (table_->known.contains(key.str())) continue;
    const auto nearest = DidYouMean(key.str(), known);
    if (nearest)
      document_->Note(key.source(), table_->PathOf(key.str()), "unknown key (did you mean \"" + *nearest + "\"?)");
    else
      document_->NoteUnknown(key.source(), table_->PathOf(key.str()), std::string(key.str()));
  }
}

void Section::ThrowIfWrong() const { document_->ThrowIfWrong(); }

std::string Section::Resolved() const {
  const std::string text = document_->top->Resolved("", false);
  return !text.empty() && text.front() == '\n' ? text.substr(1) : text;
}

Value::Table Section::AsRead() const {
  return std::get<Value::Table>(ToValue(ParseToml(table_->Resolved("", false), table_->path)).data);
}

Value::Table Section::InTheFile() const {
  Value::Table values = table_->toml == nullptr ? Value::Table() : std::get<Value::Table>(ToValue(*table_->toml).data);
  for (const std::string& key : table_->left_out)
    std::erase_if(values, [&](const auto& entry) { return entry.first == key; });
  return values;
}

}  // namespace mascot

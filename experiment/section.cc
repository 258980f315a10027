#include "experiment/section.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "experiment/section_internal.h"

namespace mascot {
namespace {

std::string KindOf(const toml::node& node) {
  switch (node.type()) {
    case toml::node_type::string:
      return "string";
    case toml::node_type::integer:
    case toml::node_type::floating_point:
      return "number";
    case toml::node_type::boolean:
      return "boolean";
    case toml::node_type::array:
      return "list";
    case toml::node_type::table:
      return "table";
    default:
      return "date or time";
  }
}

/// What the user wrote, for "got ...".
std::string Got(const toml::node& node) {
  if (const auto text = node.value_exact<std::string>()) return "'" + Printable(*text) + "'";
  if (const auto integer = node.value_exact<std::int64_t>()) return std::to_string(*integer);
  if (const auto number = node.value_exact<double>()) return ShortestFloat(*number);
  if (const auto boolean = node.value_exact<bool>()) return *boolean ? "true" : "false";
  if (const toml::array* list = node.as_array()) return "a list of " + std::to_string(list->size());
  return "a " + KindOf(node);
}

/// The number in `node` if it is one that `range` holds and a double holds exactly.
std::optional<double> NumberIn(const toml::node& node, const NumberRange& range) {
  if (const auto integer = node.value_exact<std::int64_t>()) {
    constexpr std::int64_t kExact = std::int64_t{1} << 53;
    if (*integer < -kExact || *integer > kExact) return std::nullopt;
  }
  const auto value = node.is_number() ? node.value<double>() : std::nullopt;
  return value && range.Holds(*value) ? value : std::nullopt;
}

/// "a number in [0, 1]"; says "finite" to those who wrote nan or inf.
std::string ExpectedNumber(const toml::node* node, const NumberRange& range) {
  const auto value = node != nullptr ? node->value_exact<double>() : std::nullopt;
  return (value && !std::isfinite(*value) ? "a finite number in " : "a number in ") + range.Text();
}

std::string Indexed(std::string_view path, std::size_t index) {
  return std::string(path) + "[" + std::to_string(index) + "]";
}

std::vector<std::string> NumberTexts(std::span<const double> values) {
  std::vector<std::string> texts;
  for (const double value : values) texts.push_back(ShortestFloat(value));
  return texts;
}

/// As the user wrote them: an agent's id in a list of edges stays an integer.
std::vector<std::string> AsWritten(const toml::array& list, const std::vector<double>& values) {
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto integer = list[i].value_exact<std::int64_t>();
    texts.push_back(integer ? std::to_string(*integer) : ShortestFloat(values[i]));
  }
  return texts;
}

/// "[a, b]", or one item per line where that would be too long to read.
std::string ListText(const std::vector<std::string>& items) {
  constexpr std::size_t kLongestLine = 100;
  const std::string line = "[" + Joined(items) + "]";
  if (line.size() <= kLongestLine || !items.front().starts_with('[')) return line;
  std::string lines = "[\n";
  for (const std::string& item : items) lines += "  " + item + ",\n";
  return lines + "]";
}

bool IsBareKey(std::string_view key) {
  return !key.empty() &&
         std::all_of(key.begin(), key.end(), [](unsigned char c) { return std::isalnum(c) || c == '_' || c == '-'; });
}

}  // namespace

// --- one table --------------------------------------------------------------------------------------

std::string Section::Table::PathOf(std::string_view key) const {
  const std::string name = IsBareKey(key) || key.empty() ? std::string(key) : QuotedToml(CutShort(key));
  return path.empty() || name.empty() ? path + name : path + "." + name;
}

const toml::node* Section::Table::Get(std::string_view key) const {
  const toml::node* node = toml != nullptr ? toml->get(key) : nullptr;
  return node == nullptr && base ? base->Get(key) : node;
}

bool Section::Table::Inherits(std::string_view key) const {
  return base && (toml == nullptr || toml->get(key) == nullptr) && base->Get(key) != nullptr;
}

toml::source_region Section::Table::PlaceOf(std::string_view key) const {
  const toml::node* node = Get(key);
  return node != nullptr ? node->source() : place;
}

const toml::node* Section::Table::Find(std::string_view key) {
  known.emplace(key);
  return Get(key);
}

bool Section::Table::Wrong(std::string_view key) const {
  if (broken || (key.empty() ? !wrong.empty() : wrong.contains(key))) return true;
  return std::any_of(entries.begin(), entries.end(), [&](const Entry& entry) {
    return (key.empty() || entry.key == key) &&
           std::any_of(entry.tables.begin(), entry.tables.end(), [](const auto& table) { return table->Wrong(""); });
  });
}

Section::Table::Entry* Section::Table::Recorded(std::string_view key) {
  const auto entry = std::find_if(entries.begin(), entries.end(), [&](const Entry& e) { return e.key == key; });
  return entry != entries.end() ? &*entry : nullptr;
}

void Section::Table::Record(std::string_view key, std::string value) {
  if (Entry* entry = Recorded(key))
    entry->value = std::move(value);
  else
    entries.push_back({std::string(key), std::move(value), {}, false});
}

std::shared_ptr<Section::Table> Section::Table::MakeChild(const toml::node* node, const std::string& child_path) {
  auto child = std::make_shared<Table>();
  child->path = child_path;
  child->toml = node != nullptr ? node->as_table() : nullptr;
  child->place = child->toml != nullptr && node->source().begin ? node->source() : place;
  child->broken = broken || (node != nullptr && child->toml == nullptr);
  child->document = document;
  return child;
}

void Section::Table::Expected(std::string_view key, const std::string& where, const toml::node* node,
                              const std::string& expected) {
  wrong.emplace(key);
  // What stands in place of this table was complained about already; what it inherits, where it stands.
  if ((node == nullptr && broken) || inherited || Inherits(key)) return;
  document->Note(node != nullptr ? node->source() : place, where,
                 "expected " + expected + ", got " + (node != nullptr ? Got(*node) : "nothing"));
}

template <class T, class Accept>
T Section::Table::Read(std::string_view key, const std::string& expected, const std::optional<T>& fallback, T legal,
                       Accept accept) {
  const toml::node* node = Find(key);
  if (node == nullptr && fallback) return *fallback;
  if (node != nullptr)
    if (std::optional<T> value = accept(*node)) return *value;
  Expected(key, PathOf(key), node, expected);
  return fallback.value_or(legal);
}

double Section::Table::Number(std::string_view key, const NumberRange& range, std::optional<double> fallback) {
  const std::string expected = ExpectedNumber(Get(key), range);
  const double value = Read<double>(key, expected, fallback, range.Legal(),
                                    [&](const toml::node& node) { return NumberIn(node, range); });
  Record(key, ShortestFloat(value));
  return value;
}

std::vector<double> Section::Table::Numbers(std::string_view key, const std::string& where, const toml::array& list,
                                            const NumberRange& range) {
  std::vector<double> values;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const auto value = NumberIn(list[i], range);
    if (!value) Expected(key, Indexed(where, i), list.get(i), ExpectedNumber(list.get(i), range));
    values.push_back(value.value_or(range.Legal()));
  }
  return values;
}

Eigen::Vector3d Section::Table::Vector3(std::string_view key, const std::string& where, const toml::node* node,
                                        const NumberRange& range) {
  const toml::array* list = node != nullptr ? node->as_array() : nullptr;
  if (list == nullptr || list->size() != 3) {
    Expected(key, where, node, "three numbers in " + range.Text());
    return Eigen::Vector3d::Constant(range.Legal());
  }
  const std::vector<double> values = Numbers(key, where, *list, range);
  return {values[0], values[1], values[2]};
}

const toml::array* Section::Table::List(std::string_view key, const std::string& expected) {
  const toml::node* node = Find(key);
  if (node == nullptr) return nullptr;
  if (!node->is_array()) Expected(key, PathOf(key), node, expected);
  return node->as_array();
}

// --- readers ----------------------------------------------------------------------------------------

Section::Section(std::shared_ptr<Document> document, std::shared_ptr<Table> table)
    : document_(std::move(document)), table_(std::move(table)) {}

bool Section::Has(std::string_view key) const { return table_->Find(key) != nullptr; }

bool Section::Wrong(std::string_view key) const { return table_->Wrong(key); }

std::string Section::Kind(std::string_view key) const {
  const toml::node* node = table_->Find(key);
  return node != nullptr ? KindOf(*node) : "";
}

double Section::Number(std::string_view key, double min, double max, std::optional<double> fallback) {
  return table_->Number(key, {min, max}, fallback);
}

double Section::Positive(std::string_view key, double max, std::optional<double> fallback) {
  return table_->Number(key, {0, max, true}, fallback);
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

bool Section::Boolean(std::string_view key, bool fallback) {
  const bool value = table_->Read<bool>(key, "true or false", fallback, fallback,
                                        [](const toml::node& node) { return node.value_exact<bool>(); });
  table_->Record(key, value ? "true" : "false");
  return value;
}

std::string Section::Text(std::string_view key, std::optional<std::string> fallback) {
  std::string value = table_->Read<std::string>(key, "a string", fallback, "",
                                                [](const toml::node& node) { return node.value_exact<std::string>(); });
  table_->Record(key, StringToml(value));
  return value;
}

Section::Place Section::PlaceOfText(std::string_view key) const {
  const toml::node* node = table_->Get(key);
  const toml::source_region place = table_->PlaceOf(key);
  const bool overridden = place.path && *place.path != document_->name;
  const std::filesystem::path file(overridden ? "" : document_->name);
  Place text{overridden ? *place.path : file.filename().string(), file.parent_path().string(),
             overridden ? 1 : static_cast<int>(place.begin.line)};
  const auto value = node != nullptr ? node->value_exact<std::string>() : std::nullopt;
  if (!value || overridden) return text;
  // TOML drops a line break right after the opening quotes; what is left of it is one line more than the text has.
  const auto breaks = std::count(value->begin(), value->end(), '\n');
  if (static_cast<std::ptrdiff_t>(place.end.line - place.begin.line) == breaks + 1) ++text.line;
  return text;
}

Section::FileText Section::TextOfFile(std::string_view key, std::string_view text_key) {
  const std::string path =
      table_->Read<std::string>(key, "the path of a file", std::nullopt, "",
                                [](const toml::node& node) { return node.value_exact<std::string>(); });
  std::string text;
  if (!table_->Wrong(key)) {
    try {
      text = ReadRegularFile((std::filesystem::path(PlaceOfText(key).folder) / path).string());
    } catch (const ConfigError& error) {
      Fail(key, std::string("expected a readable file, got ") + error.what());
    }
  }
  table_->Record(text_key, StringToml(text));
  return {text, std::filesystem::path(path).filename().string()};
}

std::string Section::OneOf(std::string_view key, std::span<const std::string_view> names,
                           std::optional<std::string> fallback) {
  const toml::node* node = table_->Find(key);
  const auto text = node != nullptr ? node->value_exact<std::string>() : std::nullopt;
  std::string value = fallback.value_or(names.empty() ? "" : std::string(names.front()));
  if (text && std::find(names.begin(), names.end(), *text) != names.end()) {
    value = *text;
  } else if (text) {
    const auto nearest = DidYouMean(*text, names);
    Fail(key, "expected one of " + Joined(names) + ", got '" + Printable(*text) + "'" +
                  (nearest ? " (did you mean \"" + *nearest + "\"?)" : ""));
  } else if (node != nullptr || !fallback) {
    table_->Expected(key, table_->PathOf(key), node, "one of " + Joined(names));
  }
  table_->Record(key, QuotedToml(value));
  return value;
}

std::vector<std::string> Section::Texts(std::string_view key, std::vector<std::string> fallback) {
  std::vector<std::string> values, quoted;
  if (const toml::array* list = table_->List(key, "a list of strings")) {
    for (std::size_t i = 0; i < list->size(); ++i) {
      const auto text = (*list)[i].value_exact<std::string>();
      if (!text) table_->Expected(key, Indexed(table_->PathOf(key), i), list->get(i), "a string");
      values.push_back(text.value_or(""));
    }
  } else {
    values = std::move(fallback);
  }
  for (const std::string& value : values) quoted.push_back(QuotedToml(value));
  table_->Record(key, ListText(quoted));
  return values;
}

Eigen::Vector3d Section::Vector3(std::string_view key, double min, double max,
                                 std::optional<Eigen::Vector3d> fallback) {
  const toml::node* node = table_->Find(key);
  const Eigen::Vector3d value =
      node == nullptr && fallback ? *fallback : table_->Vector3(key, table_->PathOf(key), node, {min, max});
  table_->Record(key, ListText(NumberTexts({value.data(), 3})));
  return value;
}

std::vector<double> Section::Numbers(std::string_view key, double min, double max) {
  const toml::array* list = table_->List(key, "a list of numbers");
  if (list == nullptr) return {};
  const std::vector<double> values = table_->Numbers(key, table_->PathOf(key), *list, {min, max});
  table_->Record(key, ListText(NumberTexts(values)));
  return values;
}

std::vector<std::vector<double>> Section::Rows(std::string_view key, double min, double max) {
  const toml::array* list = table_->List(key, "a list of lists of numbers");
  if (list == nullptr) return {};
  std::vector<std::vector<double>> rows(list->size());
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < list->size(); ++i) {
    const std::string path = Indexed(table_->PathOf(key), i);
    const toml::array* row = (*list)[i].as_array();
    if (row == nullptr) {
      table_->Expected(key, path, list->get(i), "a list of numbers");
      continue;
    }
    rows[i] = table_->Numbers(key, path, *row, {min, max});
    texts.push_back(ListText(AsWritten(*row, rows[i])));
  }
  table_->Record(key, ListText(texts));
  return rows;
}

std::vector<Eigen::Vector3d> Section::Points(std::string_view key, double min, double max) {
  const toml::array* list = table_->List(key, "a list of points [x, y, z]");
  if (list == nullptr) return {};
  std::vector<Eigen::Vector3d> points;
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < list->size(); ++i) {
    points.push_back(table_->Vector3(key, Indexed(table_->PathOf(key), i), list->get(i), {min, max}));
    texts.push_back(ListText(NumberTexts({points.back().data(), 3})));
  }
  table_->Record(key, ListText(texts));
  return points;
}

Section Section::Child(std::string_view key) {
  const toml::node* node = table_->Find(key);
  if (const Table::Entry* entry = table_->Recorded(key)) return {document_, entry->tables.front()};
  if (node != nullptr && !node->is_table()) table_->Expected(key, table_->PathOf(key), node, "a table");
  auto child = table_->MakeChild(node, table_->PathOf(key));
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
      entry.tables.push_back(table_->MakeChild(list->get(i), path));
      children.push_back({document_, entry.tables.back()});
    }
    table_->entries.push_back(std::move(entry));
  }
  return children;
}

void Section::InheritFrom(const Section& base) { table_->base = base.table_; }

Value Section::Free(std::string_view key) {
  const toml::node* node = table_->Find(key);
  Value value = node != nullptr ? ToValue(*node) : Value{};
  table_->Record(key, ToToml(value));
  return value;
}

// --- mistakes ---------------------------------------------------------------------------------------

void Section::Fail(std::string_view key, const std::string& message) {
  table_->wrong.emplace(key);
  document_->Note(table_->PlaceOf(key), table_->PathOf(key), message);
}

void Section::FailRow(std::string_view key, std::size_t row, const std::string& message) {
  table_->wrong.emplace(key);
  const toml::node* node = table_->Get(key);
  const toml::array* list = node != nullptr ? node->as_array() : nullptr;
  const toml::node* element = list != nullptr ? list->get(row) : nullptr;
  document_->Note(element != nullptr ? element->source() : table_->PlaceOf(key), Indexed(table_->PathOf(key), row),
                  message);
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
    document_->Note(key.source(), table_->PathOf(key.str()),
                    "unknown key" + (nearest ? " (did you mean \"" + *nearest + "\"?)" : std::string()));
  }
}

void Section::ThrowIfWrong() const { document_->ThrowIfWrong(); }

// --- what was read ----------------------------------------------------------------------------------

std::optional<std::string> Section::Table::ResolvedInline() const {
  constexpr std::size_t kLongestInline = 100;
  std::vector<std::string> items;
  for (const Entry& entry : entries) {
    if (!entry.tables.empty() || entry.value.find('\n') != std::string::npos) return std::nullopt;
    items.push_back(entry.key + " = " + entry.value);
  }
  const std::string text = "{ " + Joined(items) + " }";
  return text.size() <= kLongestInline ? std::optional(text) : std::nullopt;
}

std::string Section::Table::Resolved(const std::string& header, bool in_list) const {
  // TOML wants the keys of a table before the tables inside it.
  std::string keys, tables;
  for (const Entry& entry : entries) {
    const std::string inner = header.empty() ? entry.key : header + "." + entry.key;
    for (const std::shared_ptr<Table>& table : entry.tables) {
      const bool may_be_inline = !header.empty() && !entry.is_list && !table->entries.empty();
      if (const auto text = may_be_inline ? table->ResolvedInline() : std::nullopt)
        keys += entry.key + " = " + *text + "\n";
      else
        tables += table->Resolved(inner, entry.is_list);
    }
    if (entry.tables.empty() && !entry.is_list) keys += entry.key + " = " + entry.value + "\n";
  }
  if (header.empty() || (keys.empty() && !in_list)) return keys + tables;
  return "\n" + (in_list ? "[[" + header + "]]" : "[" + header + "]") + "\n" + keys + tables;
}

std::string Section::Resolved() const {
  const std::string text = document_->top->Resolved("", false);
  return !text.empty() && text.front() == '\n' ? text.substr(1) : text;
}

}  // namespace mascot

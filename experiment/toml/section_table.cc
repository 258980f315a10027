// One table of a TOML file: its rows, what was asked of it, and the text of what was read.
#include <algorithm>
#include <cmath>
#include <iterator>

#include "experiment/toml/section_internal.h"

namespace mascot {
namespace {

/// "a number in [0, 1]"; "a finite number in ..." if the value is nan or inf.
std::string ExpectedNumber(const toml::node* node, const Range& range) {
  const auto value = node != nullptr ? node->value_exact<double>() : std::nullopt;
  return (value && !std::isfinite(*value) ? "a finite number in " : "a number in ") + range.Text();
}

std::optional<std::vector<std::string>> TextsIn(const toml::node& node) {
  std::vector<std::string> texts;
  for (const toml::node& item : *node.as_array()) texts.push_back(item.value_exact<std::string>().value());
  return texts;
}

std::vector<std::string> NumberTexts(std::span<const double> values) {
  std::vector<std::string> texts;
  for (const double value : values) texts.push_back(ShortestFloat(value));
  return texts;
}

/// Numbers as the user wrote them: an id in a list of edges stays an integer.
std::vector<std::string> AsWritten(const toml::array& list, const std::vector<double>& values) {
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto integer = list[i].value_exact<std::int64_t>();
    texts.push_back(integer ? std::to_string(*integer) : ShortestFloat(values[i]));
  }
  return texts;
}

/// "[a, b]"; a long list of lists has one item per line.
std::string ListText(const std::vector<std::string>& items) {
  constexpr std::size_t kLongestLine = 100;
  const std::string line = "[" + Joined(items) + "]";
  if (line.size() <= kLongestLine || !items.front().starts_with('[')) return line;
  std::string lines = "[\n";
  for (const std::string& item : items) lines += "  " + item + ",\n";
  return lines + "]";
}

constexpr std::size_t kMaxItems = 1000000;  // of a list; some lists have lower limits

bool IsBareKey(std::string_view key) { return !key.empty() && std::ranges::all_of(key, IsBare); }

}  // namespace

bool IsBare(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-'; }

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

std::string Got(const toml::node& node) {
  if (const auto text = node.value_exact<std::string>()) return "'" + Printable(*text) + "'";
  if (const auto integer = node.value_exact<std::int64_t>()) return std::to_string(*integer);
  if (const auto number = node.value_exact<double>()) return ShortestFloat(*number);
  if (const auto boolean = node.value_exact<bool>()) return *boolean ? "true" : "false";
  if (const toml::array* list = node.as_array()) return "a list of " + std::to_string(list->size());
  return "a " + KindOf(node);
}

std::optional<double> NumberIn(const toml::node& node, const Range& range) {
  if (const auto integer = node.value_exact<std::int64_t>()) {
    constexpr std::int64_t kExact = std::int64_t{1} << 53;
    if (*integer < -kExact || *integer > kExact) return std::nullopt;
  }
  const auto value = node.is_number() ? node.value<double>() : std::nullopt;
  return value && range.Holds(*value) ? value : std::nullopt;
}

std::optional<std::string> TextIn(const toml::node& node) { return node.value_exact<std::string>(); }

std::string Indexed(std::string_view path, std::size_t index) {
  return std::string(path) + "[" + std::to_string(index) + "]";
}

std::string Section::Table::PathOf(std::string_view key) const {
  const std::string name = IsBareKey(key) || key.empty() ? std::string(key) : QuotedToml(CutShort(key));
  return path.empty() || name.empty() ? path + name : path + "." + name;
}

const toml::node* Section::Table::Get(std::string_view key) const {
  if (Has(key)) return toml->get(key);
  return base && !superseded.contains(key) ? base->Get(key) : nullptr;
}

bool Section::Table::Inherits(std::string_view key) const { return !Has(key) && Get(key) != nullptr; }

toml::source_region Section::Table::PlaceOf(std::string_view key) const {
  const toml::node* node = Get(key);
  return node != nullptr ? node->source() : place;
}

const toml::node* Section::Table::Find(std::string_view key) {
  known.emplace(key);
  return Get(key);
}

std::vector<std::string> Section::Table::PathsWith(std::string_view key) const {
  std::vector<std::string> paths;
  if (known.contains(key)) paths.push_back(PathOf(key));
  for (const Entry& entry : entries) {
    if (entry.is_list) continue;
    for (const std::shared_ptr<Table>& table : entry.tables)
      std::ranges::move(table->PathsWith(key), std::back_inserter(paths));
  }
  return paths;
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
  if (!document->is_recorded) return;
  if (Entry* entry = Recorded(key))
    entry->value = std::move(value);
  else
    entries.push_back({std::string(key), std::move(value), {}, false});
}

const Key* Section::Table::Row(std::string_view key) const {
  for (const std::span<const Key> table : rows) {
    const auto row = std::ranges::find(table, key, &Key::name);
    if (row != table.end()) return &*row;
  }
  return nullptr;
}

const Key& Section::Table::RowOf(std::string_view key) const {
  if (const Key* row = Row(key)) return *row;
  throw std::logic_error("no row says what the key " + PathOf(key) + " may be");
}

std::shared_ptr<Section::Table> Section::Table::MakeChild(std::string_view key, const toml::node* node,
                                                          const std::string& child_path) {
  auto child = std::make_shared<Table>();
  child->path = child_path;
  child->toml = node != nullptr ? node->as_table() : nullptr;
  child->place = child->toml != nullptr && node->source().begin ? node->source() : place;
  child->broken = broken || (node != nullptr && child->toml == nullptr);
  child->document = document;
  if (const Key* row = Row(key)) child->rows = {row->keys};
  return child;
}

void Section::Table::Expected(std::string_view key, const std::string& where, const toml::node* node,
                              const std::string& expected) {
  wrong.emplace(key);
  // A wrong value in place of this table has been noted already; mistakes in inherited keys are noted by the base's
  // reader.
  if ((node == nullptr && broken) || inherited || Inherits(key)) return;
  document->Note(node != nullptr ? node->source() : place, where,
                 "expected " + expected + ", got " + (node != nullptr ? Got(*node) : "nothing"));
}

double Section::Table::Number(std::string_view key, const Range& range, std::optional<double> fallback) {
  const std::string expected = ExpectedNumber(Get(key), range);
  const double value = Read<double>(key, expected, fallback, range.Legal(),
                                    [&](const toml::node& node) { return NumberIn(node, range); });
  if (document->is_recorded) Record(key, ShortestFloat(value));
  return value;
}

std::vector<double> Section::Table::Numbers(std::string_view key, const std::string& where, const toml::array& list,
                                            const Range& range) {
  std::vector<double> values;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const auto value = NumberIn(list[i], range);
    if (!value) Expected(key, Indexed(where, i), list.get(i), ExpectedNumber(list.get(i), range));
    values.push_back(value.value_or(range.Legal()));
  }
  return values;
}

Eigen::Vector3d Section::Table::Vector3(std::string_view key, const std::string& where, const toml::node* node,
                                        const Range& range) {
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
  const toml::array* list = node->as_array();
  if (list != nullptr && list->size() <= kMaxItems) return list;
  Expected(key, PathOf(key), node, list == nullptr ? expected : "a list of at most " + std::to_string(kMaxItems));
  return nullptr;
}

std::vector<std::string> Section::Table::Texts(std::string_view key, std::optional<std::vector<std::string>> fallback) {
  std::vector<std::string> values, quoted;
  if (const toml::array* list = List(key, "a list of strings")) {
    for (std::size_t i = 0; i < list->size(); ++i) {
      const auto text = TextIn((*list)[i]);
      if (!text) Expected(key, Indexed(PathOf(key), i), list->get(i), "a string");
      values.push_back(text.value_or(""));
    }
  } else {
    if (!fallback) fallback = RowDefault<std::vector<std::string>>(key, TextsIn);
    values = fallback.value_or(values);
  }
  for (const std::string& value : values) quoted.push_back(QuotedToml(value));
  Record(key, ListText(quoted));
  return values;
}

Eigen::Vector3d Section::Table::Vector3(std::string_view key, const Range& range,
                                        const std::optional<Eigen::Vector3d>& fallback) {
  const toml::node* node = Find(key);
  const Eigen::Vector3d value = node == nullptr && fallback ? *fallback : Vector3(key, PathOf(key), node, range);
  if (document->is_recorded) Record(key, ListText(NumberTexts({value.data(), 3})));
  return value;
}

std::vector<double> Section::Table::Numbers(std::string_view key, const Range& range) {
  const toml::array* list = List(key, "a list of numbers");
  if (list == nullptr) return {};
  const std::vector<double> values = Numbers(key, PathOf(key), *list, range);
  if (document->is_recorded) Record(key, ListText(NumberTexts(values)));
  return values;
}

std::vector<std::vector<double>> Section::Table::Lists(std::string_view key, const Range& range) {
  const toml::array* list = List(key, "a list of lists of numbers");
  if (list == nullptr) return {};
  std::vector<std::vector<double>> lists(list->size());
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < list->size(); ++i) {
    const std::string where = Indexed(PathOf(key), i);
    const toml::array* numbers = (*list)[i].as_array();
    if (numbers == nullptr) {
      Expected(key, where, list->get(i), "a list of numbers");
      continue;
    }
    lists[i] = Numbers(key, where, *numbers, range);
    if (document->is_recorded) texts.push_back(ListText(AsWritten(*numbers, lists[i])));
  }
  if (document->is_recorded) Record(key, ListText(texts));
  return lists;
}

std::vector<Eigen::Vector3d> Section::Table::Points(std::string_view key, const std::string& where,
                                                    const toml::array& list, const Range& range,
                                                    std::vector<std::string>& texts) {
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < list.size(); ++i) {
    points.push_back(Vector3(key, Indexed(where, i), list.get(i), range));
    if (document->is_recorded) texts.push_back(ListText(NumberTexts({points.back().data(), 3})));
  }
  return points;
}

std::vector<Eigen::Vector3d> Section::Table::Points(std::string_view key, const Range& range) {
  const toml::array* list = List(key, "a list of points [x, y, z]");
  if (list == nullptr) return {};
  std::vector<std::string> texts;
  std::vector<Eigen::Vector3d> points = Points(key, PathOf(key), *list, range, texts);
  if (document->is_recorded) Record(key, ListText(texts));
  return points;
}

std::vector<std::vector<Eigen::Vector3d>> Section::Table::PointLists(std::string_view key, const Range& range) {
  const toml::array* list = List(key, "a list of lists of points [x, y, z]");
  if (list == nullptr) return {};
  std::vector<std::vector<Eigen::Vector3d>> lists(list->size());
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < list->size(); ++i) {
    const std::string where = Indexed(PathOf(key), i);
    const toml::array* points = (*list)[i].as_array();
    std::vector<std::string> inner;
    if (points != nullptr)
      lists[i] = Points(key, where, *points, range, inner);
    else
      Expected(key, where, list->get(i), "a list of points [x, y, z]");
    texts.push_back(ListText(inner));
  }
  if (document->is_recorded) Record(key, ListText(texts));
  return lists;
}

std::optional<std::string> Section::Table::ResolvedInline() const {
  constexpr std::size_t kLongestInline = 100;
  std::vector<std::string> items;
  for (const Entry& entry : entries) {
    if (entry.is_list && entry.tables.empty()) continue;
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

}  // namespace mascot

#include <cctype>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <variant>

#include "experiment/toml/section_internal.h"

namespace mascot {
namespace {

/// What is known of a value that is not TOML, in brackets; empty: nothing.
std::string HintAt(const std::string& value) {
  char* end = nullptr;
  const double number = std::strtod(value.c_str(), &end);
  if (end != value.c_str() && *end == '\0') {
    if (std::abs(number) >= 0x1p63) return " (the number is too large)";
    return " (a number has no zeros in front, and digits on both sides of its point)";
  }
  const bool is_closed = value.empty() || value.find('\n') != std::string::npos;
  return is_closed || std::string_view("[{\"'").find(value[0]) != std::string_view::npos
             ? ""
             : " (text that does not begin with a letter needs quotes)";
}

/// The value of an override, in a table of its own under the key "value". A word that is no TOML value (`--set
/// graph.topology=ring`) is taken as a string: a shell would remove its quotes.
toml::table ParseValue(const Override& override, const std::string& name) {
  const bool word = !override.value.empty() && std::isalpha(static_cast<unsigned char>(override.value[0])) &&
                    override.value.find('\n') == std::string::npos;
  try {
    toml::table table = ParseToml("value = " + override.value, name);
    if (table.size() == 1) return table;
    throw ConfigError({name + ": expected one TOML value"});
  } catch (const ConfigError&) {
    if (word) return ParseToml("value = " + QuotedToml(override.value), name);
    throw ConfigError({name + ": " + override.key + ": expected a TOML value" + HintAt(override.value) + ", got '" +
                       Printable(override.value) + "'"});
  }
}

}  // namespace

std::vector<Step> Steps(std::string_view key) {
  std::vector<Step> steps;
  for (std::size_t i = 0; i < key.size();) {
    if (key[i] == '[') {
      std::size_t index = 0;
      const auto [end, error] = std::from_chars(key.data() + i + 1, key.data() + key.size(), index);
      const bool padded = key.substr(i).starts_with("[0") && !key.substr(i).starts_with("[0]");
      if (steps.empty() || padded || error != std::errc() || end == key.data() + key.size() || *end != ']') return {};
      steps.emplace_back(index);
      i = static_cast<std::size_t>(end - key.data()) + 1;
      if (i < key.size() && key[i] != '.' && key[i] != '[') return {};
    } else {
      if (!steps.empty() && key[i++] != '.') return {};
      const std::size_t begin = i;
      while (i < key.size() && IsBare(key[i])) ++i;
      if (i == begin) return {};
      steps.emplace_back(std::string(key.substr(begin, i - begin)));
    }
  }
  return steps.size() <= kDeepestKey ? steps : std::vector<Step>{};
}

std::string ExpectedKey(std::string_view key) {
  return "expected a dotted key such as law.p_gain or agents.override[0].start_s, got '" + Printable(key) + "'";
}

namespace {

std::string PathOf(std::span<const Step> steps) {
  std::string path;
  for (const Step& step : steps) {
    if (const auto* index = std::get_if<std::size_t>(&step))
      path = Indexed(path, *index);
    else
      path += (path.empty() ? "" : ".") + std::get<std::string>(step);
  }
  return path;
}

/// The place to which one step of a dotted key leads, inside the node to which the steps before it lead.
class Place {
 public:
  Place(toml::node& inside, std::span<const Step> steps, std::size_t step)
      : inside_(inside), path_(PathOf(steps.first(step))), step_(steps[step]) {}

  /// The node there; null if a table has no such key. Throws std::invalid_argument if the step does not fit.
  toml::node* Find() const {
    if (const auto* key = std::get_if<std::string>(&step_)) return Table(*key).get(*key);
    return &List()[std::get<std::size_t>(step_)];
  }
  /// Puts a value there. `source`: the place of the key, for messages. Throws std::invalid_argument if the step does
  /// not fit.
  void Put(toml::node&& value, const toml::source_region& source) const {
    if (const auto* key = std::get_if<std::string>(&step_)) {
      toml::table& table = Table(*key);
      table.erase(*key);  // also the key, whose place is in the file
      table.insert(toml::key(*key, source), std::move(value));
    } else {
      toml::array& list = List();
      list.replace(list.begin() + static_cast<std::ptrdiff_t>(std::get<std::size_t>(step_)), std::move(value));
    }
  }

 private:
  toml::table& Table(const std::string& key) const {
    if (toml::table* table = inside_.as_table()) return *table;
    throw std::invalid_argument(path_ + ": expected a table to set " + key + " in, got " + Got(inside_));
  }
  toml::array& List() const {
    const std::size_t index = std::get<std::size_t>(step_);
    toml::array* list = inside_.as_array();
    if (list == nullptr)
      throw std::invalid_argument(path_ + ": expected a list to set " + Indexed("", index) + " in, got " +
                                  Got(inside_));
    if (index < list->size()) return *list;
    throw std::invalid_argument(path_ + ": expected a place in a list of " + std::to_string(list->size()) + ", got " +
                                Indexed("", index));
  }

  toml::node& inside_;
  std::string path_;
  const Step& step_;
};

/// An empty table or list, `toml`, that stands where the value of `source` does: what is wrong with it, or missing in
/// it, is the mistake of the override that made it.
template <class Node>
Node Empty(std::string_view toml, const toml::source_region& source) {
  toml::table table = ParseToml("value = " + std::string(toml), source.path ? *source.path : "");
  return std::move(*table.get_as<Node>("value"));
}

/// If `step` of `inside` is the index one beyond the end of its list: adds a table there.
void Extend(toml::node& inside, const Step& step, const toml::source_region& source) {
  const auto* index = std::get_if<std::size_t>(&step);
  toml::array* list = inside.as_array();
  if (index != nullptr && list != nullptr && *index == list->size()) list->push_back(Empty<toml::table>("{}", source));
}

}  // namespace

toml::node* Find(toml::table& root, std::span<const Step> steps) {
  toml::node* node = &root;
  for (const Step& step : steps) {
    const auto* key = std::get_if<std::string>(&step);
    toml::table* table = key != nullptr ? node->as_table() : nullptr;
    toml::array* list = key == nullptr ? node->as_array() : nullptr;
    node = table != nullptr ? table->get(*key) : list != nullptr ? list->get(std::get<std::size_t>(step)) : nullptr;
    if (node == nullptr) return nullptr;
  }
  return node;
}

void Put(toml::table& root, std::span<const Step> steps, toml::node&& value, bool extends) {
  toml::node* node = &root;
  for (std::size_t i = 0; i + 1 < steps.size(); ++i) {
    if (extends) Extend(*node, steps[i], value.source());
    const Place place(*node, steps, i);
    if (place.Find() == nullptr) {
      const bool is_list = std::holds_alternative<std::size_t>(steps[i + 1]);
      if (is_list && !extends)
        throw std::invalid_argument(PathOf(steps.first(i + 1)) + ": expected a list to set " +
                                    PathOf(steps.subspan(i + 1, 1)) + " in, got nothing");
      if (is_list)
        place.Put(Empty<toml::array>("[]", value.source()), value.source());
      else
        place.Put(Empty<toml::table>("{}", value.source()), value.source());
    }
    node = place.Find();
  }
  const toml::source_region source = value.source();
  Place(*node, steps, steps.size() - 1).Put(std::move(value), source);
}

void Remove(toml::table& root, std::span<const Step> steps) {
  toml::node* around = Find(root, steps.first(steps.size() - 1));
  if (around == nullptr) return;
  const auto* key = std::get_if<std::string>(&steps.back());
  toml::table* table = around->as_table();
  toml::array* list = around->as_array();
  if (key != nullptr && table != nullptr) table->erase(*key);
  if (key == nullptr && list != nullptr && list->size() == std::get<std::size_t>(steps.back()) + 1) list->pop_back();
}

std::string OriginOf(const Override& override) {
  return override.origin.empty() ? "--set " + Printable(override.key + "=" + override.value) : override.origin;
}

void Apply(const Override& override, toml::table& root) {
  const std::string name = OriginOf(override);
  const std::vector<Step> steps = Steps(override.key);
  if (steps.empty()) throw ConfigError({name + ": " + ExpectedKey(override.key)});
  if (override.removes) return Remove(root, steps);
  toml::table parsed = ParseValue(override, name);
  try {
    Put(root, steps, std::move(*parsed.get("value")), /*extends=*/false);
  } catch (const std::invalid_argument& why) {
    throw ConfigError({name + ": " + why.what()});
  }
}

}  // namespace mascot

#include "agent/octave/octave_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <regex>
#include <sstream>
#include <vector>

namespace mascot {
namespace {

bool IsNumber(const Value& value) {
  return std::holds_alternative<std::int64_t>(value.data) || std::holds_alternative<double>(value.data);
}

bool IsBoolean(const Value& value) { return std::holds_alternative<bool>(value.data); }

std::string Joined(const Value::List& list, const char* separator) {
  std::string text;
  for (const Value& value : list) text += (text.empty() ? "" : separator) + ToOctave(value);
  return text;
}

std::string ListToOctave(const Value::List& list) {
  if (list.empty()) return "zeros(1, 0)";
  if (std::ranges::all_of(list, IsNumber) || std::ranges::all_of(list, IsBoolean))
    return "[" + Joined(list, ", ") + "]";
  const auto* first = std::get_if<Value::List>(&list.front().data);
  const bool is_matrix = first != nullptr && !first->empty() && std::ranges::all_of(list, [&](const Value& value) {
                           const auto* row = std::get_if<Value::List>(&value.data);
                           return row != nullptr && row->size() == first->size() && std::ranges::all_of(*row, IsNumber);
                         });
  return is_matrix ? "[" + Joined(list, "; ") + "]" : "{" + Joined(list, ", ") + "}";
}

}  // namespace

std::string QuotedForOctave(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c >= ' ' && c < 127 && c != '"' && c != '\\')
      quoted += c;
    else
      quoted += fmt::format("\\{:03o}", static_cast<unsigned char>(c));
  }
  return quoted + "\"";
}

std::string ToOctave(const Value& value) {
  if (const auto* yes = std::get_if<bool>(&value.data)) return *yes ? "true" : "false";
  if (IsNumber(value)) return std::isnan(value.Number()) ? "NaN" : fmt::format("{:.17g}", value.Number());
  if (const auto* text = std::get_if<std::string>(&value.data)) return QuotedForOctave(*text);
  if (const auto* list = std::get_if<Value::List>(&value.data)) return ListToOctave(*list);
  std::string fields;
  for (const auto& [name, field] : std::get<Value::Table>(value.data))
    fields += (fields.empty() ? "" : ", ") + QuotedForOctave(name) + ", {" + ToOctave(field) + "}";
  return "struct(" + fields + ")";
}

std::map<std::string, std::string> FunctionFiles(const std::string& text, const std::string& folder,
                                                 const std::string& own) {
  std::map<std::string, std::string> files;
  std::vector<std::string> unread = {text};
  static const std::regex kWord("[A-Za-z_][A-Za-z_0-9]*");
  while (!unread.empty()) {
    const std::string now = std::move(unread.back());
    unread.pop_back();
    for (auto word = std::sregex_iterator(now.begin(), now.end(), kWord); word != std::sregex_iterator(); ++word) {
      const std::string name = word->str() + ".m";
      if (name == own || files.contains(name)) continue;
      std::ifstream file((folder.empty() ? "." : folder) + "/" + name, std::ios::binary);
      if (!file) continue;
      std::ostringstream contents;
      contents << file.rdbuf();
      files[name] = contents.str();
      unread.push_back(contents.str());
    }
  }
  return files;
}

}  // namespace mascot

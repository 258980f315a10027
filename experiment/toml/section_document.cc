#include "experiment/toml/input.h"
#include "experiment/toml/section_internal.h"

namespace mascot {
namespace {

constexpr std::size_t kMostMistakes = 100;

/// Throws ConfigError for a key of more than kDeepestKey parts: toml++ makes and frees one table per part recursively,
/// and a key of a million parts would overflow the stack. Skips strings and comments as TOML does.
void RefuseDeepKeys(std::string_view text, const std::string& name) {
  unsigned line = 1;
  std::size_t parts = 1;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == '#') {
      i = std::min(text.find('\n', i), text.size()) - 1;
    } else if (c == '"' || c == '\'') {
      const std::string triple(3, c);
      const bool multiline = text.substr(i, 3) == triple;
      const std::string_view closing = multiline ? std::string_view(triple) : std::string_view(triple).substr(0, 1);
      for (i += closing.size(); i < text.size() && text.substr(i, closing.size()) != closing; ++i) {
        if (text[i] == '\n' && !multiline) return;  // no TOML: the parser will stop here, and say why
        if (text[i] == '\\' && c == '"') ++i;
        if (i < text.size() && text[i] == '\n') ++line;
      }
      i += closing.size() - 1;
      for (int extra = 0; multiline && extra < 2 && i + 1 < text.size() && text[i + 1] == c; ++extra) ++i;
    } else if (c == '.') {
      if (++parts > kDeepestKey)
        throw ConfigError({name + ":" + std::to_string(line) + ":1: expected a key of at most " +
                           std::to_string(kDeepestKey) + " parts, got more"});
    } else if (c == '\n' || c == '=' || c == ',' || c == '[' || c == '{') {
      parts = 1;
      if (c == '\n') ++line;
    }
  }
}

/// `place` in the document `name`, as messages say it.
std::string PlaceIn(const toml::source_region& place, const std::string& name) {
  if (place.path && *place.path != name) return *place.path;  // a value given on the command line
  return name + ":" + std::to_string(std::max(place.begin.line, 1u)) + ":" +
         std::to_string(std::max(place.begin.column, 1u));
}

/// The text of an error of toml++, in our words or with a hint where it does not help.
std::string Why(std::string_view description) {
  constexpr std::string_view kPrefix = "Error ";
  std::string why(description.starts_with(kPrefix) ? description.substr(kPrefix.size()) : description);
  if (why.find("invalid utf-8") != std::string::npos) return "expected UTF-8 text, got other bytes";
  if (why.ends_with("could not determine value type")) why += " (a string needs quotes)";
  if (why.find("unescaped control characters") != std::string::npos) why += " (does the string end on its line?)";
  return why;
}

}  // namespace

toml::table ParseToml(std::string_view text, const std::string& name) {
  RefuseDeepKeys(text, name);
  try {
    return toml::parse(text, std::string_view(name));
  } catch (const toml::parse_error& error) {
    throw ConfigError({PlaceIn(error.source(), name) + ": " + OneLine(Why(error.description()))});
  }
}

ConfigError::ConfigError(std::vector<std::string> mistakes)
    : std::runtime_error([&] {
        std::string text;
        for (const std::string& mistake : mistakes) text += (text.empty() ? "" : "\n") + mistake;
        return text;
      }()),
      mistakes_(std::move(mistakes)) {}

Section::Document::Document(std::string_view text, const std::string& document_name,
                            std::span<const Override> overrides)
    : name(OneLine(document_name)), root(ParseToml(text, name)) {
  for (const Override& override : overrides) Apply(override, root);
}

std::string Section::Document::PlaceText(const toml::source_region& place) const { return PlaceIn(place, name); }

void Section::Document::Note(const toml::source_region& place, const std::string& path, const std::string& message) {
  NoteText(place, PlaceText(place) + ": " + (path.empty() ? "" : path + ": ") + message);
}

void Section::Document::NoteText(const toml::source_region& place, const std::string& text) {
  const bool overridden = place.path && *place.path != name;
  Mistake mistake{overridden, overridden ? 0 : place.begin.line, overridden ? 0 : place.begin.column, text};
  if (mistakes_.size() < kMostMistakes) {
    mistakes_.insert(std::move(mistake));
  } else if (!mistakes_.contains(mistake)) {
    left_out_ = true;
  }
}

void Section::Document::ThrowIfWrong() const {
  if (mistakes_.empty()) return;
  std::vector<std::string> texts;
  for (const Mistake& mistake : mistakes_) texts.push_back(mistake.text);
  if (left_out_) texts.push_back(name + ": too many mistakes: these are the first found");
  throw ConfigError(std::move(texts));
}

Section Section::FromFile(const std::string& path, std::span<const Override> overrides) {
  return FromText(ReadInput(path), NameOfInput(path), overrides);
}

Section Section::FromText(const std::string& text, const std::string& name, std::span<const Override> overrides) {
  return Of(std::make_shared<Document>(text, name, overrides));
}

Section Section::FromWords(const std::string& text, const std::string& origin, std::span<const Override> overrides) {
  auto document = std::make_shared<Document>("", "", std::span<const Override>());
  document->root = ParseToml(text, origin);  // with the origin as the path of each node
  for (const Override& override : overrides) Apply(override, document->root);
  return Of(document);
}

Section Section::Of(const std::shared_ptr<Document>& document) {
  document->top = std::make_shared<Table>();
  document->top->toml = &document->root;
  document->top->place = document->root.source();
  document->top->document = document.get();
  return {document, document->top};
}

}  // namespace mascot

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include "experiment/toml/input.h"
#include "experiment/toml/section_internal.h"

namespace mascot {
namespace {

constexpr std::size_t kMaxMistakes = 100;

/// Throws ConfigError for a key of more than kDeepestKey parts, and for a value of more than kDeepestValue levels:
/// toml++ and we make, walk and free one table per part or level recursively, and a million of them would overflow the
/// stack. Skips strings and comments as TOML does.
class DepthCheck {
 public:
  DepthCheck(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  void Run() {
    for (; at_ < text_.size(); ++at_) {
      const char c = text_[at_];
      if (c == '#') {
        at_ = std::min(text_.find('\n', at_), text_.size()) - 1;
      } else if (c == '"' || c == '\'') {
        if (!SkipString(c)) return;  // no TOML: the parser will stop here, and say why
      } else {
        Take(c);
      }
    }
  }

 private:
  /// What is open: the document itself, a header, a list or an inline table, with the key that is read in it.
  struct Level {
    std::size_t parts = 1;
    bool in_value = false;
  };

  [[noreturn]] void Refuse(const std::string& expected) const {
    throw ConfigError({name_ + ":" + std::to_string(line_) + ":1: expected " + expected + ", got more"});
  }

  void Take(char c) {
    Level& level = levels_.back();
    if (c == '\n') ++line_;
    if (c == '=') {
      level.in_value = true;
    } else if (c == '.' && !level.in_value) {
      if (++level.parts > kDeepestKey) Refuse("a key of at most " + std::to_string(kDeepestKey) + " parts");
    } else if (c == '[' || c == '{') {
      outside_ += level.parts;
      levels_.emplace_back();
      if (outside_ > kDeepestValue)
        Refuse("at most " + std::to_string(kDeepestValue) + " lists and tables in each other");
    } else if ((c == ']' || c == '}') && levels_.size() > 1) {
      levels_.pop_back();
      outside_ -= levels_.back().parts;
    } else if (c == ',' || (c == '\n' && levels_.size() == 1)) {
      level = {};
    }
  }

  /// Goes to the last character of a string that `quote` begins. False if it does not end where it must.
  bool SkipString(char quote) {
    const std::string triple(3, quote);
    const bool multiline = text_.substr(at_, 3) == triple;
    const std::string_view closing = multiline ? std::string_view(triple) : std::string_view(triple).substr(0, 1);
    for (at_ += closing.size(); at_ < text_.size() && text_.substr(at_, closing.size()) != closing; ++at_) {
      if (text_[at_] == '\n' && !multiline) return false;
      if (text_[at_] == '\\' && quote == '"') ++at_;
      if (at_ < text_.size() && text_[at_] == '\n') ++line_;
    }
    at_ += closing.size() - 1;
    for (int extra = 0; multiline && extra < 2 && at_ + 1 < text_.size() && text_[at_ + 1] == quote; ++extra) ++at_;
    return true;
  }

  std::string_view text_;
  const std::string& name_;
  std::size_t at_ = 0;
  unsigned line_ = 1;
  std::vector<Level> levels_ = std::vector<Level>(1);
  std::size_t outside_ = 0;  // parts of the keys of all levels but the last
};

/// `place` in the document `name`, as messages say it.
std::string PlaceIn(const toml::source_region& place, const std::string& name) {
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
  DepthCheck(text, name).Run();
  try {
    return toml::parse(text, std::string_view(name));
  } catch (const toml::parse_error& error) {
    throw ConfigError({PlaceIn(error.source(), name) + ": " + PlainLine(Why(error.description()))});
  }
}

/// The longest text of one mistake, in bytes. A message quotes what a file has, which may be long; a traceback of
/// Python is shorter than this.
constexpr std::size_t kLongestMistake = 30'000;

ConfigError::ConfigError(std::vector<std::string> mistakes)
    : std::runtime_error([&] {
        std::string text;
        for (std::string& mistake : mistakes) mistake = Shortened(Plain(mistake), kLongestMistake);
        for (const std::string& mistake : mistakes) text += (text.empty() ? "" : "\n") + mistake;
        return text;
      }()),
      mistakes_(std::move(mistakes)) {}

Section::Document::Document(std::string_view text, const std::string& document_name,
                            std::span<const Override> overrides)
    : name(PlainLine(document_name)), root(ParseToml(text, name)) {
  for (const Override& override : overrides) Apply(override, root);
}

Section::Document::Document(std::string of_all) : origin(std::move(of_all)) {}

std::optional<std::string> Section::Document::OriginOf(const toml::source_region& place) const {
  if (!origin.empty()) return origin;
  const bool is_overridden = place.path && *place.path != name;  // a value given on the command line
  return is_overridden ? std::optional(*place.path) : std::nullopt;
}

std::string Section::Document::PlaceText(const toml::source_region& place) const {
  return OriginOf(place).value_or(PlaceIn(place, name));
}

void Section::Document::Note(const toml::source_region& place, const std::string& path, const std::string& message) {
  NoteText(place, PlaceText(place) + ": " + (path.empty() ? "" : path + ": ") + message);
}

void Section::Document::NoteText(const toml::source_region& place, const std::string& text) {
  Add(place, {.text = text});
}

void Section::Document::NoteUnknown(const toml::source_region& place, const std::string& path, const std::string& key) {
  const bool is_in_list = path.find('[') != path.npos;
  Add(place, {.text = PlaceText(place) + ": " + path + ": unknown key", .unknown = is_in_list ? "" : key});
}

void Section::Document::Add(const toml::source_region& place, Mistake mistake) {
  mistake.overridden = OriginOf(place).has_value();
  mistake.line = mistake.overridden ? 0 : place.begin.line;
  mistake.column = mistake.overridden ? 0 : place.begin.column;
  if (mistakes_.size() < kMaxMistakes) {
    mistakes_.insert(std::move(mistake));
  } else if (!left_out_ && !mistakes_.contains(mistake)) {
    left_out_ = PlaceText(place);
  }
}

void Section::Document::ThrowIfWrong() const {
  if (mistakes_.empty()) return;
  std::vector<std::string> texts;
  for (const Mistake& mistake : mistakes_) {
    std::string elsewhere;
    if (!mistake.unknown.empty())
      for (const std::string& path : top->PathsWith(mistake.unknown))
        elsewhere += (elsewhere.empty() ? "\"" : "\" or \"") + path;
    texts.push_back(mistake.text + (elsewhere.empty() ? "" : " (did you mean " + elsewhere + "\"?)"));
  }
  if (left_out_) texts.push_back(*left_out_ + ": too many mistakes: this one and others are left out");
  throw ConfigError(std::move(texts));
}

Section Section::FromFile(const std::string& path, std::span<const Override> overrides) {
  return FromText(ReadInput(path), NameOfInput(path), overrides);
}

Section Section::FromText(const std::string& text, const std::string& name, std::span<const Override> overrides) {
  return Of(std::make_shared<Document>(text, name, overrides));
}

Section Section::FromInlineTable(const std::string& text, const std::string& origin) {
  auto document = std::make_shared<Document>(origin);
  document->root = ParseToml(text, origin);
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

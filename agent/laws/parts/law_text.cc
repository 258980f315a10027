#include "agent/laws/parts/law_text.h"

#include "agent/laws/parts/row_parts.h"

namespace mascot {
namespace {

/// Reads the modules of the law: those of the key, else those that `find` finds in `folder`.
void ReadModules(const std::string& folder, const FindModules& find, Section& law, LawText& text) {
  Value modules;
  if (!law.Has("modules")) {
    auto& found = std::get<Value::Table>(modules.data);
    for (const auto& [path, module] : find(text, folder)) found[path].data = module;
    if (found.empty()) return;  // the resolved file is shorter
  }
  modules = law.Free("modules", modules);
  const auto* texts = std::get_if<Value::Table>(&modules.data);
  if (texts == nullptr) return law.Fail("modules", "expected a table, got a " + law.Kind("modules"));
  for (const auto& [path, module] : *texts) {
    if (const auto* words = std::get_if<std::string>(&module.data))
      text.modules[path] = *words;
    else
      law.FailInside("modules", path, "expected text");
  }
}

}  // namespace

std::string TextKey(const Section& law, const std::string& key) { return law.Has("file") ? "file" : key; }

LawText ReadLawText(Section& law, const std::string& key, const FindModules& find) {
  const std::string file_key = key + "_file", line_key = key + "_line";
  law.Supersede("file", {key, file_key, line_key, "modules"});
  law.Supersede(key, {"file", file_key, line_key, "modules"});
  if (!HasOneOf(law, key, "file", "file")) return {};
  Section::FileText read;
  int line = 1;
  if (law.Has("file")) {
    read = law.TextOfFile("file", key);
  } else {
    const Section::Place place = law.PlaceOfText(key);
    read = {law.Text(key), place.file, place.folder};
    line = place.line;
  }
  LawText text{.text = read.text,
               .file = law.Text(file_key, read.name),
               .line = static_cast<int>(law.Integer(line_key, 1, 1'000'000, line)),
               .modules = {}};
  if (text.text.find('\0') != std::string::npos) law.Fail(TextKey(law, key), "expected text, got a NUL byte");
  if (!law.Wrong("") && (law.Has("modules") || find != nullptr)) ReadModules(read.folder, find, law, text);
  return text;
}

}  // namespace mascot

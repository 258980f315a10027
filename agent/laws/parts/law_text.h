#pragma once

#include <functional>
#include <map>
#include <string>

#include "experiment/toml/section.h"

namespace mascot {

/// The text of a law that a user has written, and texts of files beside it that the law needs.
struct LawText {
  using Modules = std::map<std::string, std::string>;  ///< texts by their paths from the folder of the law

  std::string text;
  std::string file;  ///< the file's name in messages
  int line = 1;      ///< line of `file` at which `text` begins
  Modules modules;
};

/// The key of `law` that holds the text, which is `key`, or names its file, which is "file".
std::string TextKey(const Section& law, const std::string& key);

/// Finds the modules that a text needs in the folder of its law ("": the current one).
using FindModules = std::function<LawText::Modules(const LawText& text, const std::string& folder)>;

/// Reads the text of a law, and what messages call it: the keys `key` or "file", `key`_file, `key`_line, and modules.
/// `find` finds the modules if there is no such key; null: then the law has none. Resolved() has all of them.
LawText ReadLawText(Section& law, const std::string& key, const FindModules& find);

}  // namespace mascot

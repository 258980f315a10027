// `orchestrator keys [PREFIX]`: prints the keys of an experiment file. `orchestrator new LAW`: writes a first one.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iostream>
#include <iterator>
#include <memory>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "agent/laws/laws.h"
#include "orchestrator/formats/whole_file.h"
#include "orchestrator/reference/key_list.h"
#include "orchestrator/reference/reference.h"
#include "orchestrator/report/json.h"
#include "orchestrator/verbs/one_of.h"
#include "orchestrator/verbs/print_wrapped.h"
#include "orchestrator/verbs/verb.h"
#include "system/script.h"

namespace mascot {
namespace {

struct KeysArgs {
  std::string prefix;
  bool names = false, json = false;
};

/// The key, or the table of keys, whose name is nearest to `word`.
std::optional<std::string> Nearest(const std::string& word, const std::vector<ListedKey>& keys) {
  std::set<std::string_view> names;
  for (const ListedKey& key : keys)
    for (std::size_t dot = 0; dot != std::string::npos;) {
      dot = key.name.find('.', dot + 1);
      names.insert(std::string_view(key.name).substr(0, dot));
    }
  return DidYouMean(word, std::vector(names.begin(), names.end()));
}

/// Throws ConfigError if there is none.
std::vector<ListedKey> KeysFrom(const std::string& prefix) {
  const std::vector<ListedKey> all = AllKeys();
  std::vector<ListedKey> keys;
  std::ranges::copy_if(all, std::back_inserter(keys),
                       [&](const ListedKey& key) { return key.name.starts_with(prefix); });
  if (!keys.empty()) return keys;
  const auto nearest = Nearest(prefix, all);
  throw ConfigError({"keys: expected the beginning of a key, got '" + prefix + "'" +
                     (nearest ? " (did you mean \"" + *nearest + "\"?)" : "")});
}

/// What the key is without a value.
std::string DefaultText(const Key& row) {
  if (row.required) return "required";
  if (!row.fallback.empty()) return "default " + std::string(row.fallback);
  return row.otherwise.empty() ? "may be left out" : "default: " + std::string(row.otherwise);
}

void Print(const ListedKey& key) {
  PrintWrapped(key.name,
               fmt::format("{}; {}{}", ValueText(key.row), DefaultText(key.row), key.row.live ? "; live" : ""), 32);
  PrintWrapped(
      "", std::string(key.row.meaning) + (key.laws.empty() ? "" : fmt::format("; of {}", fmt::join(key.laws, ", "))),
      4);
}

Json ToJson(const ListedKey& key) {
  return {{"name", key.name},
          {"value", ValueText(key.row)},
          {"required", key.row.required},
          {"default", DefaultJson(key.row)},
          {"otherwise", key.row.otherwise},
          {"live", key.row.live},
          {"meaning", key.row.meaning},
          {"laws", key.laws}};
}

int ShowKeys(const KeysArgs& args) {
  const std::vector<ListedKey> keys = KeysFrom(args.prefix);
  if (args.names) {
    std::set<std::string> shown;  // laws have keys of the same name
    for (const ListedKey& key : keys)
      if (shown.insert(key.name).second) std::cout << key.name << "\n";
    return 0;
  }
  Json table = Json::array();
  for (const ListedKey& key : keys)
    if (args.json)
      table.push_back(ToJson(key));
    else
      Print(key);
  if (args.json) std::cout << JsonText(table);
  return 0;
}

struct NewArgs {
  std::string law, file;
  bool force = false;
};

/// The file that the law of an experiment reads, from the experiment's folder; nullopt: none.
std::optional<std::string> FileOfLaw(const std::string& experiment) {
  const Value::Table law = Section::FromFile(experiment).Child("law").InTheFile();
  const auto file = law.find("file");
  if (file == law.end()) return std::nullopt;
  return std::get<std::string>(file->second.data);
}

int WriteNew(const NewArgs& args) {
  RequireOneOf("new", "a law", args.law, LawNames());
  namespace fs = std::filesystem;
  const fs::path example = ExampleOf(args.law, FindShared("configs", ".")),
                 path = args.file.empty() ? args.law + ".toml" : args.file;
  std::vector<std::pair<fs::path, std::string>> files = {
      {path, NewExperiment(args.law, ReadRegularFile(example.string()))}};
  if (const auto file = FileOfLaw(example.string()))
    files.emplace_back(path.parent_path() / *file, ReadRegularFile((example.parent_path() / *file).string()));
  for (const auto& [name, text] : files)
    if (fs::exists(name) && !args.force)
      throw ConfigError({name.string() + ": expected a new file, got one that exists (--force replaces it)"});
  for (const auto& [name, text] : files) WriteWhole(name.string(), text);
  std::cout << fmt::format("{0}: an experiment with {1}; next: orchestrator up {0}\n", path.string(), args.law);
  return 0;
}

}  // namespace

std::function<int()> SetUpKeys(CLI::App& command) {
  auto args = std::make_shared<KeysArgs>();
  command.add_option("prefix", args->prefix, "how the keys begin: law.b, agents.random (default: all)")
      ->type_name("PREFIX");
  command.add_flag("--names", args->names, "print names alone");
  command.add_flag("--json", args->json, "print JSON and nothing else")->excludes("--names");
  return [args] { return ShowKeys(*args); };
}

std::function<int()> SetUpNew(CLI::App& command) {
  auto args = std::make_shared<NewArgs>();
  command.add_option("law", args->law, "the law")->required()->type_name("LAW");
  command.add_option("file", args->file, "the file to write (default: LAW.toml)")->type_name("FILE");
  command.add_flag("--force", args->force, "replace a file that exists");
  return [args] { return WriteNew(*args); };
}

}  // namespace mascot

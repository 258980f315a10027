#include "system/usage.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <system_error>
#include <vector>

#include "experiment/toml/section.h"

namespace mascot {

std::string UsageText(const CLI::App& app, const CLI::ParseError& error) {
  const auto verbs = app.get_subcommands();
  const CLI::App& command = verbs.empty() ? app : *verbs.front();
  const std::vector<std::string> unknown = command.remaining();
  const bool is_extra = dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr;
  const bool lacks = dynamic_cast<const CLI::RequiredError*>(&error) != nullptr;  // perhaps what was misspelt
  const auto is_option = [](const std::string& word) { return word.starts_with('-'); };
  const auto option = std::ranges::find_if(unknown, is_option);
  if ((!is_extra && !lacks) || unknown.empty() || (lacks && option == unknown.end())) return error.what();
  if (option == unknown.end()) return "unexpected argument '" + unknown.front() + "'";
  if (std::error_code none; std::filesystem::exists(*option, none))
    return "unknown option '" + *option + "' (a path that begins with a dash stands behind --)";
  std::vector<std::string> names;
  for (const CLI::Option* known : command.get_options())
    if (!known->get_positional()) names.push_back(known->get_name());
  const auto near = DidYouMean(*option, std::vector<std::string_view>(names.begin(), names.end()));
  return "unknown option '" + *option + "'" + (near ? " (did you mean \"" + *near + "\"?)" : "");
}

}  // namespace mascot

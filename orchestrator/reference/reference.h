#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace mascot {

/// Text of docs/configuration.md: every table and key of an experiment file, from the key tables that the reader uses.
std::string ConfigurationReference();  // reference.cc
/// Text of docs/mascot.schema.json: the same as a JSON Schema (draft 7), for editors.
std::string ConfigurationSchema();  // schema.cc
/// Text of docs/laws.md: `page` with the sections of the laws made anew, from the table of laws and the experiments in
/// the folder `configs`. Throws std::runtime_error if the page lacks the comments between which they stand.
std::string LawPage(const std::string& page, const std::filesystem::path& configs);  // law_page.cc

/// The experiment in the folder `configs` that shows a law: the one of its name, or else the first. Throws
/// std::runtime_error if there is none.
std::filesystem::path ExampleOf(std::string_view law, const std::filesystem::path& configs);  // law_page.cc

}  // namespace mascot

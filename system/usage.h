#pragma once

#include <string>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace mascot {

/// One line that says what is wrong with the command line: CLI11's text, or, for an unknown argument, its name, and for
/// an unknown option also the nearest known one, or how to write a path that begins with a dash.
std::string UsageText(const CLI::App& app, const CLI::ParseError& error);

}  // namespace mascot

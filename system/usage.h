#pragma once

#include <string>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace mascot {

/// One line that says what is wrong with the command line: CLI11's text, but for an unknown argument its name, and for
/// an unknown option also the nearest known one, or how to say that it is a path.
std::string UsageText(const CLI::App& app, const CLI::ParseError& error);

}  // namespace mascot

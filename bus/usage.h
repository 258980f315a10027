#pragma once

#include <string>

namespace CLI {
class App;
class ParseError;
}  // namespace CLI

namespace mascot {

/// What is wrong with the command line, on one line: the words of CLI11, but for what it does not know, where people
/// want to know what they mistyped.
std::string UsageText(const CLI::App& app, const CLI::ParseError& error);

}  // namespace mascot

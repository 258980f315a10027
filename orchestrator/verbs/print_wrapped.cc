#include "orchestrator/verbs/print_wrapped.h"

#include <fmt/format.h>

#include <algorithm>
#include <iostream>
#include <string>

namespace mascot {
namespace {

void PrintLineOf(std::string_view text) { std::cout << text.substr(0, text.find_last_not_of(' ') + 1) << "\n"; }

}  // namespace

void PrintWrapped(std::string_view label, std::string_view text, std::size_t indent) {
  std::string line = fmt::format("{:<{}}", label, indent);
  if (label.size() > indent) {
    PrintLineOf(label);
    line = std::string(indent, ' ');
  }
  for (std::size_t start = 0; start < text.size();) {
    const std::size_t end = std::min(text.find(' ', start), text.size());
    const std::string_view word = text.substr(start, end - start);
    if (line.size() + word.size() > kTerminalWidth && line.size() > indent) {
      PrintLineOf(line);
      line = std::string(indent, ' ');
    }
    line.append(word).append(" ");
    start = end + 1;
  }
  PrintLineOf(line);
}

}  // namespace mascot

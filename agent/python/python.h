#pragma once

#include <map>
#include <stdexcept>
#include <string>
#include <string_view>

#include "agent/user_code/law_at_work.h"

namespace mascot {

/// The modules beside a law that it imports: their texts by their paths from the folder of the law ("shapes.py").
using PythonModules = std::map<std::string, std::string>;

/// Files that Python code reads: their absolute paths by the names by which it asks for them.
using PythonFiles = std::map<std::string, std::string>;

/// The modules in `folder` that `text` imports, itself or through each other. Throws PythonError if one cannot be read.
PythonModules ModulesBeside(const std::string& text, const std::string& folder);

/// Whether code in Python has run in this process.
bool PythonHasStarted();

/// A mistake in the user's Python code.
class PythonError : public std::runtime_error {
 public:
  /// `traceback` is as Python prints it, `summary` is its last line; `line` and `column` are places in the user's file
  /// (0: not known).
  PythonError(const std::string& traceback, std::string summary, int line, int column)
      : std::runtime_error(traceback), summary_(std::move(summary)), line_(line), column_(column) {}
  const std::string& summary() const { return summary_; }
  int line() const { return line_; }
  int column() const { return column_; }

 private:
  std::string summary_;
  int line_;
  int column_;
};

}  // namespace mascot

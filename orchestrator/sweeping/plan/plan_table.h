#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace mascot {

/// The runs of a sweep as rows of a table, which may be written by hand or by another program.
struct PlanTable {
  struct Row {
    std::size_t line = 0;             ///< in the file, from 1
    std::vector<std::string> values;  ///< of the keys, each as PlainValue() (values.h) has it
  };
  std::string name;                    ///< of the file, as messages say it
  std::vector<std::string> keys = {};  ///< dotted: the column names
  std::vector<Row> rows = {};
  /// For each key the option that gave its values, as typed, which messages about a value name. Empty: the values stand
  /// in the file.
  std::vector<std::string> options = {};
};

/// Reads a table as comma-separated values: column names, then at least one row. Blank lines are skipped, and spaces
/// around a cell. Throws ConfigError with the mistakes, each as `name:line:column: ...`, the columns counted in cells.
/// (Whether the experiment has such keys, and takes their values, is not looked at.)
PlanTable ReadPlanTable(std::string_view text, const std::string& name);

}  // namespace mascot

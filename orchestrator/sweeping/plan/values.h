#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "experiment/toml/section.h"

namespace mascot {

// Values of keys as plain text: equal values have equal text, however they were typed. Where a key holds numbers, an
// integer equals the floating-point number of the same value: 1, 1.0, 1e0 and 0x1 are all "1". Elsewhere the two
// differ, as in parameters that the user chooses.

/// The value of a dotted key as TOML: "0.5", "[1, 2]", "\"ring\"".
std::string PlainToml(std::string_view key, const Value& value);
/// A value that was typed after --set, as tables have it and as it can be set again: a number in its shortest form, a
/// string without quotes if it is still a string without them. Text that is no value stays as typed: the reader of the
/// experiment says what is wrong with it.
std::string PlainValue(std::string_view key, const std::string& typed);
/// The numbers of a key, each as PlainValue() has it.
std::vector<std::string> PlainNumbers(std::string_view key, const std::vector<double>& numbers);
/// The values of a document by dotted keys, each as PlainToml() has it.
std::map<std::string, std::string> PlainKeys(const Value::Table& document);

}  // namespace mascot

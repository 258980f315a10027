#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "experiment/toml/section.h"

namespace mascot {

// Values of keys as text of their own: however they are typed, equal values have the same. Where a key holds numbers,
// an integer is equal to the floating-point number of its value: 1, 1.0, 1e0 and 0x1 are all "1". Elsewhere the two
// differ, as in parameters that the user chooses.

/// The value of a dotted key as TOML: "0.5", "[1, 2]", "\"ring\"".
std::string PlainToml(std::string_view key, const Value& value);
/// A value as typed at --set, as it stands in a table and is set again: a number in its shortest form, a string without
/// quotes if that is a string, too. What is no value stays as typed: reading the experiment says what is wrong with it.
std::string PlainValue(std::string_view key, const std::string& typed);
/// Numbers of a key, likewise.
std::vector<std::string> PlainNumbers(std::string_view key, const std::vector<double>& numbers);
/// The values of a document by dotted keys, each as PlainToml() has it.
std::map<std::string, std::string> PlainKeys(const Value::Table& document);

}  // namespace mascot

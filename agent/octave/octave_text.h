#pragma once

#include <map>
#include <string>

#include "base/value.h"

namespace mascot {

/// A value as an expression of Octave: a table is a struct, a list of numbers a row, a list of equally long lists of
/// numbers a matrix, another list a cell array. Numbers keep all of their bits.
std::string ToOctave(const Value& value);

/// A text as a string of Octave, in double quotes.
std::string QuotedForOctave(const std::string& text);

/// The texts of the function files in `folder` ("": the current one), by their names, such as "saturate.m", whose
/// functions `text` names, itself or through each other; but not `own`, the file of `text`.
std::map<std::string, std::string> FunctionFiles(const std::string& text, const std::string& folder,
                                                 const std::string& own);

}  // namespace mascot

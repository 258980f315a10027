#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace mascot {

/// `bytes` as text that is fit for a terminal, a log and a summary: valid UTF-8 (each broken character becomes U+FFFD)
/// in which no character acts on others. Controls but line breaks and tabs, marks of direction, line and paragraph
/// separators stand as escapes that JSON and TOML read as these characters: "\u001b[31m" is no colour any more.
/// Everything from outside passes through here where it comes in: what child processes print, what other processes say
/// of themselves, what users' laws throw. Everything that our programs print passes once more (FitStandardStreams).
std::string Plain(std::string_view bytes);

/// As Plain(), in one line: line breaks and tabs are escapes, too.
std::string PlainLine(std::string_view bytes);

/// The number of bytes at the end of `text` that begin a character and do not end it; 0: there is none.
std::size_t UnfinishedUtf8(std::string_view text);

/// The first characters of `text` that fit into `longest` bytes (at least 4).
std::string_view CutUtf8(std::string_view text, std::size_t longest);
/// The text, or as much of it as fits into `longest` bytes, and "...".
std::string Shortened(std::string_view text, std::size_t longest);

}  // namespace mascot

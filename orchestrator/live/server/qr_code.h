#pragma once

#include <string>
#include <vector>

namespace mascot {

/// The QR code of a text in lines for a terminal, two modules high, as a telephone reads it from a dark one. Throws
/// std::runtime_error if the text is too long for one.
std::vector<std::string> QrCode(const std::string& text);

}  // namespace mascot

#include "orchestrator/live/server/qr_code.h"

#include <qrencode.h>

#include <cerrno>
#include <memory>
#include <stdexcept>
#include <system_error>

namespace mascot {
namespace {

constexpr int kMargin = 2;  // modules; of light, as what is printed of the code is

}  // namespace

std::vector<std::string> QrCode(const std::string& text) {
  const std::unique_ptr<QRcode, decltype(&QRcode_free)> code(
      QRcode_encodeString(text.c_str(), /*version=*/0, QR_ECLEVEL_L, QR_MODE_8, /*casesensitive=*/1), &QRcode_free);
  if (!code) throw std::runtime_error("no QR code: " + std::generic_category().message(errno));
  const auto is_light = [&](int row, int column) {
    if (row < 0 || column < 0 || row >= code->width || column >= code->width) return true;
    return (code->data[row * code->width + column] & 1) == 0;
  };
  std::vector<std::string> lines;
  for (int row = -kMargin; row < code->width + kMargin; row += 2) {
    std::string& line = lines.emplace_back();
    for (int column = -kMargin; column < code->width + kMargin; ++column) {
      const bool above = is_light(row, column), below = is_light(row + 1, column);
      line += above && below ? "█" : above ? "▀" : below ? "▄" : " ";
    }
  }
  return lines;
}

}  // namespace mascot

// Who may steer; and the QR code of an address.
#include "orchestrator/live/server/steering.h"

#include <gmock/gmock.h>

#include <cctype>
#include <stdexcept>

#include "orchestrator/live/server/qr_code.h"

namespace mascot {
namespace {

TEST(Steering, IsForAllUnlessItTakesAToken) {
  const Steering all;
  EXPECT_EQ(all.token(), "");
  EXPECT_TRUE(all.IsGranted("/"));
}

TEST(Steering, TakesTheTokenAndNothingElse) {
  const Steering some(Steering::By::kToken), others(Steering::By::kToken);
  const std::string& token = some.token();
  EXPECT_THAT(token, testing::MatchesRegex("[0-9a-f]{32}"));
  EXPECT_NE(token, others.token());
  for (const std::string& target : {"/?steer=" + token, "/?a=b&steer=" + token, "/?steer=" + token + "&a=b",
                                    "/?steer=x&steer=" + token, "/?&&steer=" + token})
    EXPECT_TRUE(some.IsGranted(target)) << target;
  for (const std::string& target :
       {std::string("/"), std::string("/?steer="), "/steer=" + token, "/?steer=" + token + "0",
        "/?steer=" + token.substr(1), "/?nosteer=" + token, "/?steer=" + others.token(), "/#steer=" + token})
    EXPECT_FALSE(some.IsGranted(target)) << target;
}

/// Whether a module is light, of a code that is printed two modules high.
bool IsLight(const std::vector<std::string>& lines, std::size_t row, std::size_t column) {
  std::vector<std::string> cells;
  const std::string& line = lines.at(row / 2);
  for (std::size_t i = 0; i < line.size(); i += cells.back().size())
    cells.push_back(line.substr(i, line[i] == ' ' ? 1 : 3));
  const std::string& cell = cells.at(column);
  return cell == "█" || cell == (row % 2 == 0 ? "▀" : "▄");
}

TEST(QrCode, HasItsMarginAndItsThreeCorners) {
  const std::vector<std::string> lines = QrCode("http://192.168.100.200:8765");
  constexpr std::size_t kSize = 25;  // modules of version 2, which 27 bytes take
  for (std::size_t k = 0; k < kSize + 4; ++k) {
    EXPECT_TRUE(IsLight(lines, 0, k) && IsLight(lines, 1, k) && IsLight(lines, k, 0) && IsLight(lines, k, 1)) << k;
    EXPECT_TRUE(IsLight(lines, kSize + 2, k) && IsLight(lines, k, kSize + 2)) << k;
  }
  for (const auto& [top, left] : {std::pair<std::size_t, std::size_t>(2, 2), {2, kSize - 5}, {kSize - 5, 2}})
    for (std::size_t i = 0; i < 7; ++i)
      for (std::size_t j = 0; j < 7; ++j) {
        const std::size_t ring = std::min({i, j, 6 - i, 6 - j});  // dark, light, dark
        EXPECT_EQ(IsLight(lines, top + i, left + j), ring == 1) << i << " " << j;
      }
}

TEST(QrCode, OfTooLongATextIsAnError) { EXPECT_THROW(QrCode(std::string(5000, 'x')), std::runtime_error); }

}  // namespace
}  // namespace mascot

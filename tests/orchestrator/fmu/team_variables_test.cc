#include "orchestrator/fmu/team_variables.h"

#include <gmock/gmock.h>

#include <numbers>

#include "experiment/toml/key.h"
#include "orchestrator/fmu/units.h"

namespace mascot {
namespace {

using testing::ElementsAre;

TEST(FmuNames, AreThoseOfKeys) {
  EXPECT_EQ(FmuNameOf("law.p_gain", {}), "law.p_gain");
  EXPECT_EQ(FmuNameOf("law.offsets_m[2,1]", {"law.p_gain"}), "law.offsets_m[2,1]");
  EXPECT_EQ(FmuNameOf("law.my-gain x", {}), "law.my_gain_x");
}

TEST(FmuNames, StayUniqueWhereCharactersAreReplaced) {
  EXPECT_EQ(FmuNameOf("law.my-gain", {"law.my_gain"}), "law.my_gain_2");
  EXPECT_EQ(FmuNameOf("law.my-gain", {"law.my_gain", "law.my_gain_2"}), "law.my_gain_3");
  EXPECT_EQ(FmuNameOf("law.my-list[1]", {"law.my_list[1]"}), "law.my_list_2[1]");
}

TEST(FmuNames, AreCutAndStayUnique) {
  std::vector<std::string> taken;
  const std::string same(60, 'x');
  for (int n = 1; n <= 120; ++n) {
    taken.push_back(FmuNameOf("law." + same + "[" + std::to_string(n % 12 + 1) + ",3]", taken));
    EXPECT_LE(taken.back().size(), kLongestFmuName);
    EXPECT_TRUE(taken.back().starts_with("law.xxx") && taken.back().ends_with(",3]")) << taken.back();
  }
  std::ranges::sort(taken);
  EXPECT_EQ(std::ranges::adjacent_find(taken), taken.end());
}

TEST(Units, AreReadFromTheNamesOfKeys) {
  EXPECT_EQ(UnitOf(key::Number("speed_m_per_s", {0, 1}, "")), "m/s");
  EXPECT_EQ(UnitOf(key::Number("max_acceleration_m_per_s2", {0, 1}, "")), "m/s^2");
  EXPECT_EQ(UnitOf(key::Number("p_gain", {0, 1}, "").Unit("1/s^2")), "1/s^2");
  EXPECT_EQ(UnitOf(key::Number("loss", {0, 1}, "")), "");
}

TEST(Units, HaveTheBaseUnitsOfFmi) {
  const auto exponents = [](std::string_view unit) { return BaseUnitOf(unit)->exponents; };
  EXPECT_THAT(exponents("m/s^2"), ElementsAre(0, 1, -2, 0));
  EXPECT_THAT(exponents("1/m^2"), ElementsAre(0, -2, 0, 0));
  EXPECT_THAT(exponents("N*s/rad"), ElementsAre(1, 1, -1, -1));
  EXPECT_THAT(exponents("1"), ElementsAre(0, 0, 0, 0));
  EXPECT_DOUBLE_EQ(BaseUnitOf("deg/s")->factor, std::numbers::pi / 180);
  EXPECT_EQ(BaseUnitOf("bananas"), std::nullopt);
  EXPECT_EQ(BaseUnitOf("m^x"), std::nullopt);
}

}  // namespace
}  // namespace mascot

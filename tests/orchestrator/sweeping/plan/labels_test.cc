#include "orchestrator/sweeping/plan/labels.h"

#include <gtest/gtest.h>

namespace mascot {
namespace {

TEST(LabelOfColumn, IsWordsAndAUnit) {
  EXPECT_EQ(LabelOfColumn("consensus.settling_time_s"), "settling time (s)");
  EXPECT_EQ(LabelOfColumn("consensus.final_disagreement_m"), "final disagreement (m)");
  EXPECT_EQ(LabelOfColumn("consensus.final_speed_m_per_s"), "final speed (m/s)");
  EXPECT_EQ(LabelOfColumn("consensus.predicted.rate_per_s"), "predicted rate (1/s)");
  EXPECT_EQ(LabelOfColumn("consensus.value_m.y"), "value y (m)");
  EXPECT_EQ(LabelOfColumn("control.effort"), "control effort (m²/s³)");
  EXPECT_EQ(LabelOfColumn("safety.collisions"), "safety collisions");
  EXPECT_EQ(LabelOfColumn("laws.finite_time.agreement_time_s"), "finite_time: agreement time (s)");
}

TEST(LabelOfMetric, HasTheUnitThatItsFileSays) {
  EXPECT_EQ(LabelOfMetric({"rise_time_s", ""}), "rise time (s)");
  EXPECT_EQ(LabelOfMetric({"rise_time_s", "s"}), "rise time (s)");
  EXPECT_EQ(LabelOfMetric({"peak_command", "m/s^2"}), "peak command (m/s²)");
  EXPECT_EQ(LabelOfMetric({"turns", ""}), "turns");
}

TEST(LabelOfKey, HasTheUnitOfItsRowOrOfItsName) {
  EXPECT_EQ(LabelOfKey("law.p_gain", {"consensus"}), "law.p_gain (1/s²)");
  EXPECT_EQ(LabelOfKey("law.p_gain", {"velocity_consensus"}), "law.p_gain (1/s)");
  EXPECT_EQ(LabelOfKey("law.p_gain", {"consensus", "waypoint", "velocity_consensus"}), "law.p_gain (1/s² or 1/s)");
  EXPECT_EQ(LabelOfKey("law.p_gain", {}), "law.p_gain");
  EXPECT_EQ(LabelOfKey("link.delay_s", {}), "link.delay (s)");
  EXPECT_EQ(LabelOfKey("agents.count", {}), "agents.count");
  EXPECT_EQ(LabelOfKey("agents.override[0].start_s", {}), "agents.override[0].start (s)");
  EXPECT_EQ(LabelOfKey("agents.override[0].law.p_gain", {"consensus"}), "agents.override[0].law.p_gain (1/s²)");
  EXPECT_EQ(LabelOfKey("physics.wind.gust_std_m_per_s", {}), "physics.wind.gust_std (m/s)");
}

}  // namespace
}  // namespace mascot

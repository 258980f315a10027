// Claims about the figures of a run: how they are written, and when they hold.
#include "orchestrator/report/assertion.h"

#include <gmock/gmock.h>

#include "experiment/toml/section.h"

namespace mascot {
namespace {

using Relation = Assertion::Relation;
using testing::HasSubstr;
using testing::ThrowsMessage;

Figures Some() {
  Figures figures;
  figures.Add("consensus.settling_time_s", 9.5);
  figures.Add("consensus.rate_per_s", FigureValue());
  figures.Add("safety.collisions", std::int64_t{2});
  figures.Add("wire.matches_graph", true);
  figures.Add("laws.waypoint.arrival_time_s", FigureValues{1.0, 2.0, std::nullopt});
  figures.Add("laws.event_triggered.messages", FigureValues{4.0, 6.0});
  figures.AddVector("consensus.mean_m", Eigen::Vector3d(1, 2, 3));
  figures.AddWords("failure", "it broke");
  figures.Add("links.edges", [] { return Json(); });
  return figures;
}

std::string WhyNot(const std::string& text) { return WhyItFails(ReadAssertion(text), Some()); }

TEST(Assertion, IsANameARelationAndANumber) {
  for (const auto& [sign, relation] : {std::pair("<", Relation::kLess),
                                       {"<=", Relation::kAtMost},
                                       {">", Relation::kGreater},
                                       {">=", Relation::kAtLeast},
                                       {"==", Relation::kEqual},
                                       {"!=", Relation::kNotEqual}})
    for (const std::string space : {"", " ", "  "}) {
      const Assertion claim = ReadAssertion(space + "a.b_s" + space + sign + space + "-1.5e3" + space);
      EXPECT_EQ(claim.name, "a.b_s");
      EXPECT_EQ(claim.relation, relation);
      EXPECT_EQ(claim.number, -1500);
    }
  EXPECT_EQ(ReadAssertion("wire.matches_graph == true").number, 1);
  for (const std::string text : {"", "a", "a <", "< 3", "a = 3", "a < b", "a < 3 s", "a << 3", "a ! 3", "a < 1e999"})
    EXPECT_THAT(
        [&] { ReadAssertion(text); },
        ThrowsMessage<ConfigError>("--assert: expected a figure of summary.json, a relation and a number, as in "
                                   "\"consensus.settling_time_s < 10\", got \"" +
                                   text + "\""));
}

TEST(Assertion, HoldsOrSaysWhatTheFigureIs) {
  for (const char* text :
       {"consensus.settling_time_s < 10", "consensus.settling_time_s <= 9.5", "consensus.settling_time_s > 9",
        "consensus.settling_time_s >= 9.5", "consensus.settling_time_s == 9.5", "consensus.settling_time_s != 9",
        "safety.collisions == 2", "wire.matches_graph == true", "consensus.mean_m.z > 2.5",
        "laws.event_triggered.messages < 7"})
    EXPECT_EQ(WhyNot(text), "") << text;
  for (const char* text :
       {"consensus.settling_time_s < 9.5", "consensus.settling_time_s <= 9", "consensus.settling_time_s > 9.5",
        "consensus.settling_time_s >= 10", "consensus.settling_time_s == 9", "consensus.settling_time_s != 9.5"})
    EXPECT_EQ(WhyNot(text), "it is 9.5") << text;
  EXPECT_EQ(WhyNot("safety.collisions == 0"), "it is 2");
  EXPECT_EQ(WhyNot("wire.matches_graph == false"), "it is true");
  EXPECT_EQ(WhyNot("consensus.rate_per_s > 0"),
            "the run has no value of it: it has not happened by the end, or not for good");
  EXPECT_EQ(WhyNot("laws.event_triggered.messages < 5"), "value 2 of 2: it is 6");
  EXPECT_EQ(WhyNot("laws.waypoint.arrival_time_s < 5"),
            "value 3 of 3: the run has no value of it: it has not happened by the end, or not for good");
  EXPECT_EQ(WhyNot("failure == 0"), "the run has no number of it: it broke");
  EXPECT_EQ(WhyNot("links.edges == 0"), "it is a table");
  EXPECT_EQ(WhyNot("links.sent == 0"), "the run has no such figure");
}

TEST(Assertion, OfAFigureThatNoRunHasIsRefusedBefore) {
  for (const char* text : {"consensus.settling_time_s < 1", "consensus.mean_m.x < 1", "consensus.mean_m < 1"})
    EXPECT_NO_THROW(ExpectFigure(ReadAssertion(text), Some())) << text;
  EXPECT_THAT([] { ExpectFigure(ReadAssertion("consensus.setling_time_s < 1"), Some()); },
              ThrowsMessage<ConfigError>("--assert: expected a figure of this experiment's summary.json, got "
                                         "consensus.setling_time_s (did you mean \"consensus.settling_time_s\"?)"));
  EXPECT_THAT([] { ExpectFigure(ReadAssertion("consensus.settling_time < 1"), Some()); },
              ThrowsMessage<ConfigError>(HasSubstr("got consensus.settling_time")))
      << "a part of a name is none";
}

}  // namespace
}  // namespace mascot

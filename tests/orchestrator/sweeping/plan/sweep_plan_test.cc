#include <gmock/gmock.h>

#include <cmath>
#include <set>

#include "orchestrator/sweeping/plan/plan.h"
#include "tests/orchestrator/sweeping/plan/runs.h"

namespace mascot {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;
using Words = SweepPlan::Words;

Words Sets(std::vector<std::string> sets) { return {.sets = std::move(sets), .randoms = {}, .seeds = ""}; }

TEST(SweepPlan, IsOneRunWithoutOptions) {
  const SweepPlan plan(Words{});
  EXPECT_THAT(Runs(plan), ElementsAre(""));
  EXPECT_THAT(plan.keys(), IsEmpty());
}

TEST(SweepPlan, CountsFromAByStepToB) {
  EXPECT_THAT(Runs(SweepPlan(Sets({"law.beta=1:0.5:2"}))), ElementsAre("1", "1.5", "2"));
  EXPECT_THAT(Runs(SweepPlan(Sets({"agents.count=4:2:9"}))), ElementsAre("4", "6", "8"));
  EXPECT_THAT(Runs(SweepPlan(Sets({"law.beta=2:-1:0.5"}))), ElementsAre("2", "1"));
  EXPECT_THAT(Runs(SweepPlan(Sets({"law.beta=3:1:3"}))), ElementsAre("3"));
  EXPECT_THAT(Runs(SweepPlan(Sets({"run.seed=9007199254740993:1:9007199254740995"}))),
              ElementsAre("9007199254740993", "9007199254740994", "9007199254740995"));
  EXPECT_THAT(Runs(SweepPlan(Sets({"a=9223372036854775806:1:9223372036854775807"}))),
              ElementsAre("9223372036854775806", "9223372036854775807"));
}

TEST(SweepPlan, DoesNotAccumulateRoundingErrors) {
  const SweepPlan plan(Sets({"law.p_gain=0:0.1:1"}));  // the sum of ten times 0.1 is not 1
  ASSERT_EQ(plan.size(), 11u);
  EXPECT_EQ(plan[10].overrides[0].value, "1");
  const SweepPlan decimals(Sets({"law.beta=0.3:0.1:1"}));  // in doubles, 0.3 + 6 x 0.1 is not 0.9
  EXPECT_THAT(Runs(decimals), ElementsAre("0.3", "0.4", "0.5", "0.6", "0.7", "0.8", "0.9", "1"));
  EXPECT_THAT(Runs(SweepPlan(Sets({"law.beta=1e-1:1e-1:3e-1"}))), ElementsAre("0.1", "0.2", "0.3"));
}

TEST(SweepPlan, TakesListsAndSingleValues) {
  const SweepPlan plan(
      Sets({"graph.topology=ring,path", "law.leader_waypoints_m=[[1, 2, 3], [4, 5, 6]]", "law.leader=1"}));
  EXPECT_THAT(Runs(plan), ElementsAre("ring [[1, 2, 3], [4, 5, 6]] 1", "path [[1, 2, 3], [4, 5, 6]] 1"));
  EXPECT_THAT(plan.varied(), ElementsAre("graph.topology"));
  EXPECT_THAT(Runs(SweepPlan(Sets({"run.name='a,b','c:d:e'"}))), ElementsAre("a,b", "c:d:e"));
  EXPECT_THAT(Runs(SweepPlan(Sets({R"(a="x\",y",'z\',"")"}))), ElementsAre(R"(x",y)", R"(z\)", R"("")"));
  EXPECT_THAT(Runs(SweepPlan(Sets({"a=\"\"\"x\",y\"\"\",1"}))), ElementsAre("x\",y", "1"));
}

TEST(SweepPlan, CombinesEveryKeyWithEveryOtherAndSeedsFastest) {
  Words words = Sets({"a=1,2", "b=x,y"});
  words.seeds = "7..8";
  const SweepPlan plan(words);
  EXPECT_THAT(plan.keys(), ElementsAre("a", "b", "run.seed"));
  EXPECT_THAT(plan.varied(), ElementsAre("a", "b"));
  EXPECT_THAT(Runs(plan), ElementsAre("1 x 7", "1 x 8", "1 y 7", "1 y 8", "2 x 7", "2 x 8", "2 y 7", "2 y 8"));
  words.seeds = "3,9,1";
  EXPECT_EQ(SweepPlan(words).size(), 12u);
}

TEST(SweepPlan, TriesEachValueOfAListAndTheLastOfARange) {
  Words words = Sets({"a=1,2", "b=0:1:9", "c=5"});
  words.seeds = "7..8";
  std::vector<std::string> trials;
  const SweepPlan plan(words);
  for (std::size_t k = 0; k < plan.TrialCount(); ++k) {
    trials.emplace_back();
    for (const Override& override : plan.Trial(k).overrides) trials.back() += override.value + " ";
  }
  EXPECT_THAT(trials, ElementsAre("2 0 5 7 ", "1 9 5 7 "));
}

/// The trials of a plan, each as "value value ...".
std::vector<std::string> Trials(const SweepPlan& plan) {
  std::vector<std::string> trials;
  for (std::size_t k = 0; k < plan.TrialCount(); ++k) {
    std::string trial;
    for (const Override& override : plan.Trial(k).overrides) trial += (trial.empty() ? "" : " ") + override.value;
    trials.push_back(trial);
  }
  return trials;
}

/// --zip with these --set options.
Words Zip(std::vector<std::string> sets, const std::string& seeds = "") {
  return {.sets = std::move(sets), .randoms = {}, .samples = 1, .seeds = seeds, .zip = true};
}

TEST(SweepPlan, TakesTheValuesOfKeysTogetherWithZip) {
  const SweepPlan plan(Zip({"a=1,2,3", "b=x", "c=0.1:0.1:0.3"}, "7..8"));
  EXPECT_THAT(Runs(plan), ElementsAre("1 x 0.1 7", "1 x 0.1 8", "2 x 0.2 7", "2 x 0.2 8", "3 x 0.3 7", "3 x 0.3 8"));
  EXPECT_THAT(plan.keys(), ElementsAre("a", "b", "c", "run.seed"));
  EXPECT_THAT(plan.varied(), ElementsAre("a", "c"));
  EXPECT_EQ(plan.Text(), "a=1,2,3\nb=x\nc=0.1,0.2,0.3\nrun.seed=7,8\nrow by row\n");
  EXPECT_THAT(Trials(plan), ElementsAre("2 x 0.2 7", "3 x 0.3 7"));
  EXPECT_THAT(Trials(SweepPlan(Zip({"a=1:1:3", "b=x", "c=0.1:0.1:0.3"}))), ElementsAre("3 x 0.3"));
  EXPECT_THAT(plan.WithFirstSeed(), ElementsAre(0, 2, 4));
}

TEST(SweepPlan, FliesEachRowWithEachSample) {
  const SweepPlan plan({.sets = {"a=1,2", "b=x,y"}, .randoms = {"c=0:1"}, .samples = 2, .seeds = "5,6", .zip = true});
  ASSERT_EQ(plan.size(), 8u);
  const auto values = [&](std::size_t run) {
    const SweepPoint point = plan[run];
    return std::vector{point.overrides[0].value, point.overrides[1].value, point.overrides[3].value};
  };
  EXPECT_THAT(values(3), ElementsAre("1", "x", "6"));
  EXPECT_THAT(values(4), ElementsAre("2", "y", "5"));
  EXPECT_EQ(plan[0].overrides[2].value, plan[1].overrides[2].value);
  EXPECT_NE(plan[1].overrides[2].value, plan[2].overrides[2].value);
  EXPECT_EQ(plan[2].overrides[2].value, plan[6].overrides[2].value) << "each row sees the same samples";
  EXPECT_THAT(Trials(plan), ElementsAre(testing::StartsWith("2 y ")));
}

TEST(SweepPlan, FliesEqualRowsOnceAndRowsOfWhichOneValueIsEqualEach) {
  const SweepPlan plan(Zip({"law.p_gain=0.1,0.10,0.2,1e-1", "law.beta=1,2,2,1"}));
  EXPECT_THAT(Runs(plan), ElementsAre("0.1 1", "0.1 2", "0.2 2"));
  EXPECT_THAT(plan.notes(), ElementsAre("--zip: 1 of the 4 rows are equal to others: each is flown once"));
  const SweepPlan one(Zip({"a=1,1", "b=2,2"}));
  EXPECT_THAT(Runs(one), ElementsAre("1 2"));
  EXPECT_THAT(one.varied(), IsEmpty());
  const SweepPlan seeds(Zip({"a=1,1,2", "run.seed=5,6,5"}));
  EXPECT_THAT(Runs(seeds), ElementsAre("1 5", "1 6", "2 5"));
  EXPECT_THAT(seeds.WithFirstSeed(), ElementsAre(0, 2)) << "the second run differs from the first in its seed alone";
  EXPECT_THAT(SweepPlan(Zip({"a=1,2,3", "run.seed=5,6,5"})).WithFirstSeed(), IsEmpty());
}

TEST(SweepPlan, KnowsWhichRowsAreAlike) {
  const auto representatives = [](const SweepPlan& plan, SweepPlan::Alike alike) {
    std::vector<std::size_t> all;
    for (std::size_t run = 0; run < plan.size(); ++run) all.push_back(plan.RepresentativesOf(alike)[run]);
    return all;
  };
  const SweepPlan plan(Zip({"a=x,y,x", "b=1,2,3"}, "1..2"));
  EXPECT_THAT(representatives(plan, SweepPlan::Alike::kInValues), ElementsAre(0, 0, 2, 2, 4, 4));
  EXPECT_THAT(representatives(plan, SweepPlan::Alike::kInWords), ElementsAre(0, 0, 2, 2, 0, 0));
}

TEST(SweepPlan, SaysWhatZipExpected) {
  const auto of = [](const Words& words) { return [words] { SweepPlan plan(words); }; };
  EXPECT_THAT(
      of(Zip({"law.p_gain=0.1,0.2,0.3", "a=1", "law.beta=1,2"})),
      ThrowsMessage<ConfigError>("--zip: expected as many values of each key, got 3 of law.p_gain, 2 of law.beta"));
  EXPECT_THAT(of(Zip({"a=1:1:4", "b=x,y", "c=1,2,3,4"})),
              ThrowsMessage<ConfigError>("--zip: expected as many values of each key, got 4 of a, 2 of b, 4 of c"));
  EXPECT_THAT(of(Zip({"law.p_gain=0.1,0.2", "a=1"})),
              ThrowsMessage<ConfigError>("--zip: expected at least 2 keys with --set KEY=VALUES of several values, "
                                         "got 1, law.p_gain"));
  EXPECT_THAT(of(Zip({})), ThrowsMessage<ConfigError>("--zip: expected at least 2 keys with --set KEY=VALUES of "
                                                      "several values, got none"));
  EXPECT_THAT(of(Zip({"a=1,2", "a=3,4"})), ThrowsMessage<ConfigError>("sweep: expected each key once, got a again"));
}

TEST(SweepPlan, KnowsWhichRunsHaveTheFirstSeed) {
  Words words = Sets({"a=1,2"});
  EXPECT_THAT(SweepPlan(words).WithFirstSeed(), IsEmpty());
  words.seeds = "3";
  EXPECT_THAT(SweepPlan(words).WithFirstSeed(), IsEmpty());
  words.seeds = "3..5";
  EXPECT_THAT(SweepPlan(words).WithFirstSeed(), ElementsAre(0, 3));
  EXPECT_THAT(SweepPlan(Sets({"run.seed=4,9", "a=1,2"})).WithFirstSeed(), ElementsAre(0, 1));
}

TEST(SweepPlan, GivesAnyOfMillionsOfRunsWithoutListingThem) {
  const SweepPlan plan({.sets = {"a=0:1:999", "b=x,y"}, .randoms = {"c=0:1"}, .samples = 50, .seeds = "1..100"});
  ASSERT_EQ(plan.size(), 10'000'000u);
  const auto values = [&](std::size_t run) {
    const SweepPoint point = plan[run];
    return std::vector{point.overrides[0].value, point.overrides[1].value, point.overrides[3].value};
  };
  EXPECT_THAT(values(0), ElementsAre("0", "x", "1"));
  EXPECT_THAT(values(99), ElementsAre("0", "x", "100"));
  EXPECT_EQ(plan[99].overrides[2].value, plan[0].overrides[2].value) << "seeds change fastest";
  EXPECT_NE(plan[100].overrides[2].value, plan[0].overrides[2].value);
  EXPECT_EQ(plan[5'000].overrides[2].value, plan[0].overrides[2].value) << "b and a see the same samples";
  EXPECT_THAT(values(5'000), ElementsAre("0", "y", "1"));
  EXPECT_THAT(values(9'999'999), ElementsAre("999", "y", "100"));
}

TEST(SweepPlan, IsToldFromOthersByItsText) {
  const Words words{.sets = {"a=1:1:3", "b=x"}, .randoms = {"c=1:2:log"}, .samples = 9, .seeds = "4..5"};
  EXPECT_EQ(SweepPlan(words).Text(), "a=1,2,3\nb=x\nc=1:2:log, 9 samples\nrun.seed=4,5\n");
}

TEST(SweepPlan, DrawsTheSameSamplesEveryTime) {
  const Words words{
      .sets = {}, .randoms = {"law.p_gain=0.1:0.3", "law.beta=0.01:100:log"}, .samples = 200, .seeds = ""};
  const SweepPlan plan(words);
  EXPECT_EQ(Runs(plan), Runs(SweepPlan(words)));
  ASSERT_EQ(plan.size(), 200u);
  std::set<std::string> gains;
  int below_1 = 0;
  for (std::size_t i = 0; i < plan.size(); ++i) {
    const double gain = std::stod(plan[i].overrides[0].value), beta = std::stod(plan[i].overrides[1].value);
    EXPECT_GE(gain, 0.1);
    EXPECT_LE(gain, 0.3);
    EXPECT_GE(beta, 0.01);
    EXPECT_LE(beta, 100);
    gains.insert(plan[i].overrides[0].value);
    below_1 += beta < 1;
  }
  EXPECT_EQ(gains.size(), 200u);
  EXPECT_NEAR(below_1, 100, 30) << "half of the decades";
}

TEST(SweepPlan, KnowsWhichRunsAreAlikeButForTheirSeeds) {
  const auto representatives = [](const SweepPlan& plan, SweepPlan::Alike alike) {
    std::vector<std::size_t> all;
    for (std::size_t run = 0; run < plan.size(); ++run) all.push_back(plan.RepresentativesOf(alike)[run]);
    return all;
  };
  const SweepPlan plan({.sets = {"a=x,y", "b=1,2"}, .randoms = {}, .seeds = "1..2"});
  EXPECT_THAT(representatives(plan, SweepPlan::Alike::kInValues), ElementsAre(0, 0, 2, 2, 4, 4, 6, 6));
  EXPECT_THAT(representatives(plan, SweepPlan::Alike::kInWords), ElementsAre(0, 0, 0, 0, 4, 4, 4, 4));
  const SweepPlan drawn({.sets = {"a=x,y"}, .randoms = {"b=0:1", "c=1:1"}, .samples = 2, .seeds = ""});
  EXPECT_THAT(representatives(drawn, SweepPlan::Alike::kInValues), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(representatives(drawn, SweepPlan::Alike::kInWords), ElementsAre(0, 0, 2, 2));
}

TEST(SweepPlan, FliesEqualValuesOnceHoweverTheyAreTyped) {
  const SweepPlan gains(Sets({"law.p_gain=0.1,0.1,0.10,1e-1,0x1,1.0"}));
  EXPECT_THAT(Runs(gains), ElementsAre("0.1", "1"));
  EXPECT_THAT(gains.notes(), ElementsAre("law.p_gain: 4 of the 6 values are equal to others: each is flown once"));
  EXPECT_THAT(gains.varied(), ElementsAre("law.p_gain"));
  EXPECT_THAT(Runs(SweepPlan(Sets({"law.name=consensus,'consensus',\"minmax\""}))), ElementsAre("consensus", "minmax"));
  EXPECT_THAT(Runs(SweepPlan(Sets({"law={name='consensus',p_gain=1},{p_gain=1.0, name=\"consensus\"}"}))),
              ElementsAre("{name = \"consensus\", p_gain = 1}"));
  EXPECT_THAT(SweepPlan(Sets({"law.p_gain=0.5,0.50"})).varied(), IsEmpty());
  const SweepPlan seeds({.sets = {}, .randoms = {}, .seeds = "3,1,03,1"});
  EXPECT_THAT(Runs(seeds), ElementsAre("3", "1"));
  EXPECT_THAT(seeds.notes(), ElementsAre("run.seed: 2 of the 4 values are equal to others: each is flown once"));
  const SweepPlan samples({.sets = {"a=1,2"}, .randoms = {"b=1:1"}, .samples = 9, .seeds = ""});
  EXPECT_EQ(samples.size(), 2u);
  EXPECT_THAT(samples.notes(), ElementsAre("--samples: the 9 are equal: one is flown"));
  EXPECT_EQ(SweepPlan({.sets = {}, .randoms = {"b=1:1", "c=0:1"}, .samples = 9, .seeds = ""}).size(), 9u);
  EXPECT_THAT(SweepPlan(Sets({"law.p_gain=0.1,0.2"})).notes(), IsEmpty());
}

TEST(SweepPlan, HasWordsThatGiveItAgain) {
  const std::vector<Words> typed = {Sets({"law.p_gain=0.10,1e0", "law.name='consensus',minmax"}),
                                    Sets({"a=0.1:0.1:0.3", "run.name='a,b','c:d:e','f\"g','h[i'"}),
                                    Sets({"law={name='consensus',p_gain=1.0},{name='minmax'}"}),
                                    {.sets = {"a=1"}, .randoms = {"b=1.0:1e1:log"}, .samples = 7, .seeds = "5,6,7"},
                                    {.sets = {"run.seed=1,2"}, .randoms = {}, .seeds = ""},
                                    Zip({"law.p_gain=0.10,1,1.0", "law.name='consensus',minmax,'minmax'", "b=1"}, "3"),
                                    Zip({"law.p_gain=0.10,1", "law.name=minmax,'minmax'"}),
                                    Zip({"a=1,1.0", "b='x',\"x\""}),
                                    Zip({"a=0:1e-16:2e-16", "b=1,2,3"})};
  for (const Words& words : typed) {
    const SweepPlan plan(words), again(plan.words());
    EXPECT_EQ(again.Text(), plan.Text());
    EXPECT_EQ(again.words(), plan.words());
    EXPECT_EQ(Runs(again), Runs(plan));
  }
  EXPECT_EQ(SweepPlan(typed[3]).words().seeds, "5..7");
  EXPECT_THAT(SweepPlan(typed[3]).words().randoms, ElementsAre("b=1:10:log"));
  EXPECT_THAT(SweepPlan(typed[1]).words().sets[0], "a=0.1:0.1:0.3");
}

TEST(SweepPlan, SaysWhichOptionGaveAValue) {
  const SweepPlan plan({.sets = {"a=1,2"}, .randoms = {"b=1.0:1e0:log"}, .samples = 1, .seeds = "7,9"});
  std::vector<std::string> origins;
  for (const Override& override : plan[3].overrides) origins.push_back(override.origin);
  EXPECT_THAT(origins, ElementsAre("", "--random b=1:1:log (1.0)", "--seeds 9"));
}

TEST(SweepPlan, SaysWhatItExpected) {
  const auto of = [](Words words) { return [words] { SweepPlan plan(words); }; };
  EXPECT_THAT(of(Sets({"law.beta"})), ThrowsMessage<ConfigError>("--set: expected key=values (such as "
                                                                 "law.p_gain=0.1:0.1:1), got 'law.beta'"));
  EXPECT_THAT(of(Sets({"law.beta=1:0:2"})),
              ThrowsMessage<ConfigError>(
                  "--set: expected a:step:b, three numbers with b on step's side of a, got 'law.beta=1:0:2'"));
  EXPECT_THAT(of(Sets({"law.beta=1:-1:2"})),
              ThrowsMessage<ConfigError>(
                  "--set: expected a:step:b, three numbers with b on step's side of a, got 'law.beta=1:-1:2'"));
  EXPECT_THAT(of(Sets({"law.beta=0:1e-9:2"})),
              ThrowsMessage<ConfigError>("--set: expected at most 10000000 values, got 'law.beta=0:1e-9:2'"));
  EXPECT_THAT(of(Sets({"a=1,,2"})), ThrowsMessage<ConfigError>("--set: expected values between commas, got 'a=1,,2'"));
  EXPECT_THAT(of(Sets({"a=1,2", "a=3"})), ThrowsMessage<ConfigError>("sweep: expected each key once, got a again"));
  EXPECT_THAT(of(Sets({"a=1:1:9999", "b=1:1:9999"})),
              ThrowsMessage<ConfigError>("sweep: expected at most 10000000 runs, got more"));
  EXPECT_THAT(of({.sets = {}, .randoms = {"a"}, .seeds = ""}),
              ThrowsMessage<ConfigError>("--random: expected key=min:max[:log], got 'a'"));
  EXPECT_THAT(
      of({.sets = {}, .randoms = {"a=0:1:log"}, .seeds = ""}),
      ThrowsMessage<ConfigError>(
          "--random: expected key=min:max with min <= max, or key=min:max:log with 0 < min <= max, got 'a=0:1:log'"));
  EXPECT_THAT(of({.sets = {}, .randoms = {}, .seeds = "0..10000000"}),
              ThrowsMessage<ConfigError>("--seeds: expected at most 10000000 seeds, got '0..10000000'"));
  for (const char* seeds : {"2..1", "a..b", "-1..3", "1,x"})
    EXPECT_THAT(of({.sets = {}, .randoms = {}, .seeds = seeds}),
                ThrowsMessage<ConfigError>("--seeds: expected a..b or a,b,... of integers from 0 on, got '" +
                                           std::string(seeds) + "'"));
}

}  // namespace
}  // namespace mascot

// How a sweep differs from the one whose table it would go on with.
#include <gmock/gmock.h>

#include "orchestrator/sweeping/table/sweep_identity.h"

namespace mascot {
namespace {

using ::testing::HasSubstr;

SweepIdentity IdentityOfWords(const SweepPlan::Words& typed) {
  return {.build = "1.2.3",
          .experiment = "run.duration_s = 2\nlaw = { name = 'consensus' }\n",
          .first_run = "run.duration_s = 2.0\nlaw = { name = 'consensus', p_gain = 0.1 }\n",
          .metric_file = "",
          .words = SweepPlan(typed).words(),
          .own = {},
          .law_names = {"consensus"},
          .laws = {}};
}

const SweepPlan::Words kBegun = {.sets = {"law.p_gain=0.1,0.5", "graph.topology=ring"}, .randoms = {}, .seeds = "1..3"};

/// How a sweep with these options differs from that of kBegun.
std::string DifferenceOf(const SweepPlan::Words& words) {
  return IdentityOfWords(words).DifferenceFrom(IdentityOfWords(kBegun).Text());
}

TEST(SweepDifference, IsNoneOfSpelling) {
  EXPECT_EQ(DifferenceOf(kBegun), "");
  EXPECT_EQ(
      DifferenceOf({.sets = {"law.p_gain=1e-1,0.50,0.1", "graph.topology='ring'"}, .randoms = {}, .seeds = "1,2,3"}),
      "");
  EXPECT_EQ(DifferenceOf({.sets = {"law.p_gain=0.1:0.4:0.5", "graph.topology=ring"}, .randoms = {}, .seeds = "1..3"}),
            "");
}

TEST(SweepDifference, NamesTheKeyThatIsSetOtherwise) {
  EXPECT_EQ(DifferenceOf({.sets = {"law.p_gain=0.1,0.7", "graph.topology=ring"}, .randoms = {}, .seeds = "1..3"}),
            "--set law.p_gain: 0.1, 0.5 there and 0.1, 0.7 here");
  EXPECT_EQ(DifferenceOf({.sets = {"law.p_gain=0.1,0.5", "graph.topology=ring"}, .randoms = {}, .seeds = "4..5"}),
            "--seeds: 1, 2, 3 there and 4, 5 here");
  EXPECT_EQ(DifferenceOf({.sets = {"law.p_gain=0.1,0.5"}, .randoms = {}, .seeds = "1..3"}),
            "--set graph.topology: ring there and nothing here");
  EXPECT_EQ(
      DifferenceOf(
          {.sets = {"law.p_gain=0.1,0.5", "graph.topology=ring", "link.loss=0.1"}, .randoms = {}, .seeds = "1..3"}),
      "--set link.loss: nothing there and 0.1 here");
  EXPECT_EQ(
      DifferenceOf({.sets = {"graph.topology=ring"}, .randoms = {"law.p_gain=0:1"}, .samples = 4, .seeds = "1..3"}),
      "--random law.p_gain: 0.1, 0.5 there and 0:1, 4 samples here");
  EXPECT_EQ(
      DifferenceOf({.sets = {"graph.topology=ring", "law.p_gain=0.1,0.5"}, .randoms = {}, .seeds = "1..3"}),
      "the order of what is set: law.p_gain, graph.topology, run.seed there and graph.topology, law.p_gain, run.seed "
      "here");
}

TEST(SweepDifference, ShowsLongListsFromWhereTheyDiffer) {
  const auto gains = [](int last, const std::string& more) {
    std::string word = "law.beta=0";
    for (int gain = 1; gain <= last; ++gain) word += "," + std::to_string(gain);
    return IdentityOfWords({.sets = {word + more}, .randoms = {}, .seeds = ""});
  };
  const std::string begun = gains(40, ",50,60").Text();
  EXPECT_EQ(gains(40, ",50,61").DifferenceFrom(begun), "--set law.beta: ..., 60 there and ..., 61 here");
  EXPECT_EQ(gains(40, ",55,60").DifferenceFrom(begun), "--set law.beta: ..., 50, 60 there and ..., 55, 60 here");
  EXPECT_EQ(gains(40, ",50,60,70").DifferenceFrom(begun), "--set law.beta: ..., 60 there and ..., 60, 70 here");
  EXPECT_EQ(gains(40, ",50").DifferenceFrom(begun), "--set law.beta: ..., 50, 60 there and ..., 50 here");
  EXPECT_EQ(
      gains(40, ",50,61,62,63,64,65,66,67,68,69,70,71,72,73,74,75,76,77,78,79,80").DifferenceFrom(begun),
      "--set law.beta: ..., 60 there and ..., 61, 62, 63, 64, 65, 66, 67, 68, 69, 70, 71, 72, 73, 74, 75, ... here");
}

TEST(SweepDifference, SaysThatValuesAreCombinedInAnotherWay) {
  SweepPlan::Words words{.sets = {"law.p_gain=0.1,0.5", "law.beta=1,2"}, .randoms = {}, .seeds = ""};
  const SweepIdentity product = IdentityOfWords(words);
  words.zip = true;
  const SweepIdentity zipped = IdentityOfWords(words);
  EXPECT_EQ(zipped.DifferenceFrom(zipped.Text()), "");
  EXPECT_EQ(zipped.DifferenceFrom(product.Text()), "how values are combined: each with each there and row by row here");
  EXPECT_EQ(product.DifferenceFrom(zipped.Text()), "how values are combined: row by row there and each with each here");
}

TEST(SweepDifference, NamesTheKeyOfTheFileAndTheBuild) {
  const std::string begun = IdentityOfWords(kBegun).Text();
  SweepIdentity now = IdentityOfWords(kBegun);
  now.build = "1.2.4";
  EXPECT_EQ(now.DifferenceFrom(begun), "the build: 1.2.3 there and 1.2.4 here");
  now = IdentityOfWords(kBegun);
  now.experiment = "run.duration_s = 3\nlaw = { name = 'consensus' }\n";
  EXPECT_EQ(now.DifferenceFrom(begun), "run.duration_s of the experiment file: 2 there and 3 here");
  now.experiment = "run.duration_s = 2.0  # as before\nlaw = { name = 'consensus' }\n";
  EXPECT_EQ(now.DifferenceFrom(begun), "the text of the experiment file, though in no value");
  now.experiment = "a = 1\nb = 1\nc = 1\nd = 1\n";
  EXPECT_THAT(now.DifferenceFrom(begun), HasSubstr("a of the experiment file: nothing there and 1 here; "));
  EXPECT_THAT(now.DifferenceFrom(begun), HasSubstr("; 3 more keys of the experiment file"));
  now = IdentityOfWords(kBegun);
  now.first_run = "run.duration_s = 2.0\nlaw = { name = 'consensus', p_gain = 0.2 }\n";
  EXPECT_EQ(now.DifferenceFrom(begun), "law.p_gain of the first run: 0.1 there and 0.2 here")
      << "a default has changed";
  now = IdentityOfWords(kBegun);
  now.metric_file = "def a(run): return 1\n";
  EXPECT_EQ(now.DifferenceFrom(begun), "the file of --metric");
  now = IdentityOfWords(kBegun);
  now.law_names = {"consensus", "minmax"};
  EXPECT_EQ(now.DifferenceFrom(begun), "the laws and metrics of its runs");
  EXPECT_EQ(now.DifferenceFrom("a plan of long ago"), "the form of its .plan, which this build does not read");
}

}  // namespace
}  // namespace mascot

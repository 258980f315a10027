// Parameters that a law in Python never looks up are told: their names may be misspelt.
#include <gmock/gmock.h>

#include "tests/agent/laws/custom_law.h"

namespace mascot {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

const std::string kControl = "def control(t, me, neighbours):\n  return 0, 0\n";

/// What is told after the law of agent 1 has been called once.
std::vector<std::string> Told(const std::string& python, const std::string& params = "{ gian = 1.0, mass = 2 }",
                              const std::string& lines = "") {
  const Experiment experiment = Custom(python, "params = " + params + "\n" + lines);
  EXPECT_THAT(UnreadParams(experiment), IsEmpty()) << "before it is called";
  MakeLaw(experiment, 1)->Want_W(0, Motion{}, {});
  return UnreadParams(experiment);
}

TEST(LookedUp, AParameterThatIsNotIsNamedWithWhatTheLawAskedFor) {
  EXPECT_THAT(
      Told("def start(me, params):\n  me.m = params['mass']\n  me.g = params.get('gain', 3)\n" + kControl),
      ElementsAre("law.params.gian: the law has not looked it up, but \"gain\", which law.params does not have"));
  EXPECT_THAT(Told("def start(me, params):\n  me.m = params['mass']\n" + kControl),
              ElementsAre("law.params.gian: the law has not looked it up"));
}

TEST(LookedUp, WhatIsLookedUpLaterCounts) {
  EXPECT_THAT(Told("def start(me, params):\n  me.params = params\ndef control(t, me, neighbours):\n  return "
                   "me.params['gian'], me.params.setdefault('mass', 3)\n"),
              IsEmpty());
}

TEST(LookedUp, GoingThroughAllOrCopyingLooksUpAll) {
  for (const char* all : {"dict(params)", "{**params}", "list(params)", "params.items()", "params.values()",
                          "params.copy()", "params | {}", "{} | params", "f(**params)", "copy.deepcopy(params)",
                          "copy.copy(params)", "json.dumps(params)", "pickle.loads(pickle.dumps(params))['mass']",
                          "vars(me).update(params)", "me.__dict__.update(params)", "params == {}", "params.popitem()"})
    EXPECT_THAT(Told(std::string("import copy, json, pickle\ndef f(**everything): pass\ndef start(me, params):\n  ") +
                     all + "\n" + kControl),
                IsEmpty())
        << all;
}

TEST(LookedUp, WhatIsInATableIsNotToldOf) {
  EXPECT_THAT(Told("def start(me, params):\n  params['a']\n" + kControl, "{ a = { b = 1 } }"), IsEmpty());
}

TEST(LookedUp, ALawThatGetsNoneIsToldSo) {
  EXPECT_THAT(Told(kControl, "{ gain = 1 }"),
              ElementsAre("law.params.gain: the law has not looked it up: it has neither start(me, params) nor set(me, "
                          "params)"));
  EXPECT_THAT(Told("def control_user(px, vx, ax, py, vy, ay, i, n, leader):\n  return 0, 0\n", "{ gain = 1 }",
                   "style = 'mascot'\n"),
              ElementsAre("law.params.gain: the law has not looked it up: it has neither start(me, params) nor set(me, "
                          "params)"));
}

TEST(LookedUp, DeclaredParametersAreTheLawsOwn) {
  EXPECT_THAT(Told("PARAMETERS = {'gian': 1.0, 'mass': 3}\ndef start(me, params):\n  pass\n" + kControl), IsEmpty());
}

TEST(LookedUp, ParametersAreADictAsBefore) {
  EXPECT_THAT(Told("def start(me, params):\n  assert isinstance(params, dict) and len(params) == 2\n"
                   "  assert params == {'gian': 1.0, 'mass': 2} and repr(params) == \"{'gian': 1.0, 'mass': 2}\"\n"
                   "  assert 'mass' in params and 'x' not in params and params.get('x') is None\n"
                   "  assert params.pop('x', 5) == 5 and params.pop('mass') == 2 and params['gian'] == 1.0\n"
                   "  assert type(params.copy()) is dict\n" +
                   kControl),
              IsEmpty());
  EXPECT_THAT(Failure("def start(me, params):\n  params['gain']\n" + kControl),
              ::testing::EndsWith("KeyError: 'gain'"));
}

}  // namespace
}  // namespace mascot

// Laws written in Python: where their text is, the parameters that it declares, and the modules beside it.
#include <gmock/gmock.h>

#include <filesystem>

#include "agent/agent.h"
#include "agent/laws/laws.h"
#include "tests/agent/laws/custom_law.h"
#include "tests/support/scratch.h"
#include "tests/support/three_agents.h"

namespace mascot {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// --- where its source is ----------------------------------------------------------------------------

TEST(CustomLaw, InAFileIsInlinedAndGoesByTheFilesName) {
  ScratchFolder folder;
  WriteFile(folder.File("law.py"), "gain = 2\ndef control(t, me, neighbours):\n  return gain / me.id, undefined\n");
  WriteFile(folder.File("run.toml"), Three("name = 'custom'\nfile = 'law.py'\n"));
  Section document = Section::FromFile(folder.File("run.toml"));
  LoadExperiment(document, "run");
  const std::string resolved = document.Resolved();
  EXPECT_THAT(resolved,
              AllOf(HasSubstr("python = '''\ngain = 2\n"), HasSubstr("python_file = \"law.py\"\npython_line = 1"),
                    HasSubstr("messages = false"), ::testing::Not(HasSubstr("\nfile = \"law.py\""))));
  Experiment again = LoadExperiment(Section::FromText(resolved, "elsewhere.toml"), "run", /*checked=*/true);
  const Others others = Standing();
  EXPECT_THAT([&] { Agent(again, 1).Want(0, Motion{}, others.samples()); },
              ThrowsMessage<std::runtime_error>(AllOf(HasSubstr("File \"law.py\", line 3, in control"),
                                                      HasSubstr("NameError: name 'undefined' is not defined"))));
}

TEST(CustomLaw, InAFileMayBeginWithAByteOrderMark) {
  ScratchFolder folder;
  WriteFile(folder.File("law.py"),
            "\xEF\xBB\xBF"
            "def control(t, me, neighbours):\r\n  return 0, 0\r\n");
  WriteFile(folder.File("run.toml"), Three("name = 'custom'\nfile = 'law.py'\n"));
  EXPECT_NO_THROW(LoadExperiment(Section::FromFile(folder.File("run.toml")), "run"));
}

// --- parameters that the text declares ----------------------------------------------------------------

const std::string kDeclared =
    "PARAMETERS = {'gain': 0.5, 'name': 'a', 'on': True, 'list': [1, 2]}\n"
    "def start(me, params):\n  me.params = params\n"
    "def set(me, params):\n  me.params = params\n"
    "def control(t, me, neighbours):\n  p = me.params\n  return p['gain'], len(p['list']) if p['on'] else 0\n";

TEST(CustomLaw, HasTheDefaultsOfItsParameters) {
  EXPECT_EQ(Wants(kDeclared), Eigen::Vector3d(0.5, 2, 0));
  EXPECT_EQ(Wants(kDeclared, "params = { gain = 2, list = [1] }\n"), Eigen::Vector3d(2, 1, 0));
  EXPECT_EQ(Wants(kDeclared, "params = { on = false }\n"), Eigen::Vector3d(0.5, 0, 0));
}

TEST(CustomLaw, RefusesParametersThatItDoesNotDeclare) {
  const auto refusal = [](const std::string& params, const std::string& text = kDeclared) {
    return LawRefusal("name = 'custom'\nparams = { " + params + " }\npython = '''\n" + text + "'''\n");
  };
  const std::string at = "folder/test.toml:11:";
  EXPECT_EQ(refusal("gian = 1"), at + "19: law.params.gian: unknown key (did you mean \"gain\"?)");
  EXPECT_EQ(refusal("gain = 'fast'"), at + "19: law.params.gain: expected a number as in PARAMETERS, got \"fast\"");
  EXPECT_EQ(refusal("gain = true"), at + "19: law.params.gain: expected a number as in PARAMETERS, got true");
  EXPECT_EQ(refusal("on = 1"), at + "17: law.params.on: expected true or false as in PARAMETERS, got 1");
  EXPECT_EQ(refusal("name = 1"), at + "19: law.params.name: expected a string as in PARAMETERS, got 1");
  EXPECT_EQ(refusal("list = 1"), at + "19: law.params.list: expected a list as in PARAMETERS, got 1");
  EXPECT_THAT(refusal("", "PARAMETERS = 3\n" + kDeclared.substr(kDeclared.find("def start"))),
              HasSubstr("expected PARAMETERS to be a dict, got 3"));
  EXPECT_EQ(refusal("anything = 1", kDeclared.substr(kDeclared.find("def start"))), "") << "it declares nothing";
}

TEST(CustomLaw, HasTheDefaultsOfItsParametersAfterAnEventToo) {
  const std::string before = "name = 'custom'\npython = '''\n" + kDeclared + "'''\nparams = ";
  Experiment experiment = Load(Three(before + "{ gain = 2, on = false }\n"));
  Experiment changed = Load(Three(before + "{ gain = 3 }\n"));
  const auto law = MakeLaw(experiment, 1);
  EXPECT_EQ(law->Want_W(0, Motion{}, {}), Eigen::Vector3d(2, 0, 0));
  law->Adopt(changed.agent(1));
  EXPECT_EQ(law->Want_W(0, Motion{}, {}), Eigen::Vector3d(3, 2, 0));
}

// --- modules beside the law ----------------------------------------------------------------------------

/// A folder with a law in law.py, modules beside it and run.toml, which flies it.
struct LawWithModules {
  explicit LawWithModules(const std::string& law) {
    WriteFile(folder.File("law.py"), law);
    WriteFile(folder.File("run.toml"), Three("name = 'custom'\nfile = 'law.py'\n"));
    std::filesystem::create_directories(folder.File("kit/deep"));
    WriteFile(folder.File("gains.py"),
              "from math import sqrt\nimport kit.two\ncalls = 0\nK = sqrt(kit.two.TWO * 2)\n"
              "def next():\n  global calls\n  calls += 1\n  return calls\n");
    WriteFile(folder.File("kit/__init__.py"), "from . import two\nfrom .deep.three import THREE\n");
    WriteFile(folder.File("kit/two.py"), "TWO = 2\n");
    WriteFile(folder.File("kit/deep/__init__.py"), "");
    WriteFile(folder.File("kit/deep/three.py"), "THREE = 3\n");
    WriteFile(folder.File("unused.py"), "1 / 0\n");
  }
  /// The resolved experiment.
  std::string Resolved() const {
    Section document = Section::FromFile(folder.File("run.toml"));
    LoadExperiment(document, "run");
    return document.Resolved();
  }
  /// What the law of agent 1 wants when the folder is gone.
  Eigen::Vector3d Wants() {
    const std::string resolved = Resolved();
    std::filesystem::remove_all(folder.path());
    Experiment again = LoadExperiment(Section::FromText(resolved, "elsewhere.toml"), "run", /*checked=*/true);
    return MakeLaw(again, 1)->Want_W(0, Motion{}, {});
  }
  ScratchFolder folder;
};

TEST(CustomLaw, ImportsModulesBesideItAlsoWhereTheirFolderIsNot) {
  const std::string control = "def control(t, me, neighbours):\n  ";
  EXPECT_EQ(LawWithModules("from gains import K\nimport kit\n" + control + "return K, kit.THREE\n").Wants(),
            Eigen::Vector3d(2, 3, 0));
  EXPECT_EQ(LawWithModules(control + "import kit.deep.three as d, gains as g\n  return d.THREE, g.next() + g.next()\n")
                .Wants(),
            Eigen::Vector3d(3, 3, 0))
      << "within a function, too";
  EXPECT_EQ(
      LawWithModules("from kit import two, deep\nfrom kit.two import *\n" + control + "return TWO, deep.three.THREE\n")
          .Wants(),
      Eigen::Vector3d(2, 3, 0));
}

TEST(CustomLaw, ModulesThatItDoesNotImportStayWhereTheyAre) {
  const std::string resolved =
      LawWithModules("import kit.two, math\ndef control(t, me, neighbours):\n  return 0, 0\n").Resolved();
  EXPECT_THAT(resolved, AllOf(HasSubstr("kit/two.py"), HasSubstr("kit/deep/three.py")));
  EXPECT_THAT(resolved, ::testing::Not(::testing::AnyOf(HasSubstr("unused.py"), HasSubstr("gains.py"))));
  Section again = Section::FromText(resolved, "elsewhere.toml");
  LoadExperiment(again, "run");
  EXPECT_EQ(again.Resolved(), resolved) << "it resolves to itself";
}

TEST(CustomLaw, SharesNoModulesWithOtherAgentsOfItsProcess) {
  const LawWithModules beside("import gains\ndef control(t, me, neighbours):\n  return gains.next(), 0\n");
  Experiment experiment = LoadExperiment(Section::FromFile(beside.folder.File("run.toml")), "run");
  const auto first = MakeLaw(experiment, 1), second = MakeLaw(experiment, 2);
  EXPECT_EQ(first->Want_W(0, Motion{}, {}).x(), 1);
  EXPECT_EQ(first->Want_W(0, Motion{}, {}).x(), 2);
  EXPECT_EQ(second->Want_W(0, Motion{}, {}).x(), 1);
}

TEST(CustomLaw, MistakesInModulesNameTheirPlaces) {
  LawWithModules beside("import gains\ndef control(t, me, neighbours):\n  return gains.K, 0\n");
  const auto refusal = [&]() -> std::string {
    try {
      beside.Resolved();
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  };
  WriteFile(beside.folder.File("gains.py"), "\n\nK = \n");
  EXPECT_THAT(refusal(), HasSubstr("law.py:1:1: law.file: expected Python, got SyntaxError: invalid syntax"));
  WriteFile(beside.folder.File("gains.py"), "import kit.four\n");
  EXPECT_THAT(refusal(), HasSubstr("law.py:1:1: law.file: expected Python, got ModuleNotFoundError: No module named "
                                   "'kit.four'"));
  WriteFile(beside.folder.File("gains.py"), "K = '\xff'\n");
  EXPECT_THAT(refusal(), HasSubstr("law.file: expected modules that can be read, got UnicodeDecodeError"));
  EXPECT_EQ(LawRefusal("name = 'custom'\nmodules = 3\npython = 'def control(t, me, n): pass'\n"),
            "folder/test.toml:11:11: law.modules: expected a table, got a number");
  EXPECT_EQ(LawRefusal("name = 'custom'\nmodules = { 'a.py' = 3 }\npython = 'def control(t, me, n): pass'\n"),
            "folder/test.toml:11:11: law.modules.a.py: expected text");
}

}  // namespace
}  // namespace mascot

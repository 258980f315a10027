// The orchestrator as a program, in surroundings that are not ours: variables, folders, pipes, names.
#include <gmock/gmock.h>

#include <string>

#include "tests/support/folders.h"
#include "tests/support/orchestrator.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

using namespace test;
using ::testing::HasSubstr;

const std::string kRing =
    "run.duration_s = 0.2\nagents = { count = 3, model = 'double_integrator' }\ngraph.topology = 'ring'\noutput = { "
    "save_plot = false, fidelity = false }\n";
const std::string kConsensus = kRing + "law.name = 'consensus'\n";
const std::string kPython =
    kRing +
    "[law]\nname = 'custom'\npython = '''\nimport numpy, pathlib\n\ndef control(t, me, neighbours):\n"
    "    return [float(len('\\u00fc')), 0, 0]\n'''\n";

class Surroundings : public testing::Test {
 protected:
  /// Runs a command line of a shell in the scratch folder; `$O` is the orchestrator.
  Ran In(const std::string& command) const {
    return Shell("cd '" + scratch_.path().string() + "' && O=" + test::BuildFolder() + "/orchestrator && " + command);
  }
  void ExpectDone(const std::string& command) const {
    const Ran ran = In(command);
    EXPECT_EQ(ran.exit_code, 0) << command << "\n" << ran.output;
  }
  void Write(const std::string& name, const std::string& text) const { WriteFile(scratch_.File(name), text); }

  const ScratchFolder scratch_;
};

TEST_F(Surroundings, ALawInPythonDoesNotDependOnTheVariablesOfAnotherPython) {
  for (const char* folder : {"laws", "other"}) std::filesystem::create_directories(scratch_.path() / folder);
  Write("laws/law.toml", kPython);
  for (const char* module : {"other/numpy.py", "other/pathlib.py", "numpy.py", "other/sitecustomize.py"})
    Write(module, "raise SystemExit('not the one that was meant')\n");
  Write("other/mine.py", "x = 1\n");
  ExpectDone("\"$O\" up laws/law.toml --engine inprocess --quiet --out usual");
  ExpectDone(
      "PYTHONHOME=/nowhere PYTHONPATH=$PWD/other PYTHONUTF8=0 PYTHONOPTIMIZE=2 PYTHONWARNINGS=error LC_ALL=C "
      "TMPDIR=/nowhere "
      "\"$O\" up laws/law.toml --engine inprocess --quiet --out other/run");
  EXPECT_EQ(ReadFile(scratch_.File("usual/run.mcap")), ReadFile(scratch_.File("other/run/run.mcap")));
  Write("laws/mine.toml",
        kRing +
            "[law]\nname = 'custom'\npython = '''\nimport mine\n\ndef control(t, me, neighbours):\n    "
            "return [mine.x, 0, 0]\n'''\n");
  ExpectDone("PYTHONPATH=$PWD/other \"$O\" check laws/mine.toml");
}

/// A virtual environment with a module `mine`, and one that Python and NumPy have themselves.
class InEnvironment : public Surroundings {
 protected:
  InEnvironment() {
    std::filesystem::create_directories(scratch_.path() / packages_ / "numpy");
    Write("env/pyvenv.cfg", "home = /usr/bin\nversion = " + Version() + ".7\n");
    Write(packages_ + "/mine.py", "x = 1\n");
    Write(packages_ + "/there.pth", scratch_.File("edited") + "\n");
    for (const char* module : {"/numpy/__init__.py", "/pathlib.py"})
      Write(packages_ + module, "raise SystemExit('not the one that was meant')\n");
    std::filesystem::create_directory(scratch_.path() / "edited");
    Write("edited/installed_to_be_edited.py", "y = 2\n");
    Write("law.toml", kRing +
                          "[law]\nname = 'custom'\npython = '''\nimport numpy, pathlib, mine, "
                          "installed_to_be_edited\n\ndef control(t, me, neighbours):\n    return [mine.x, "
                          "installed_to_be_edited.y, 0]\n'''\n");
    Write("plain.toml", kPython);
    Write("metric.py", "import mine\ndef one(run):\n    return mine.x\n");
  }
  static std::string Version() {
    std::string version =
        Shell("/usr/bin/python3 -c 'import sys; print(\"%d.%d\" % sys.version_info[:2], end=\"\")'").output;
    return version;
  }
  std::string Note() const {
    return "packages of the virtual environment " + scratch_.File("env") + " (Python " + Version() +
           "), but the system's NumPy\n";
  }

  const std::string packages_ = "env/lib/python" + Version() + "/site-packages";
  const std::string activated_ = "VIRTUAL_ENV=$PWD/env \"$O\" ";
};

TEST_F(InEnvironment, ThatIsActivatedALawFindsItsPackages) {
  EXPECT_THAT(In("\"$O\" check law.toml").output, HasSubstr("ModuleNotFoundError: No module named 'mine'"));
  const Ran checked = In(activated_ + "check law.toml");
  EXPECT_EQ(checked.exit_code, 0) << checked.output;
  EXPECT_THAT(checked.output, HasSubstr("\n  python         " + Note()));
  const Ran up = In(activated_ + "up law.toml --engine inprocess --out one");
  EXPECT_EQ(up.exit_code, 0) << up.output;
  EXPECT_THAT(up.output, HasSubstr("\nPython: " + Note()));
  const Ran swept = In(activated_ + "sweep law.toml --seeds 1,2 --force --no-plot --metric metric.py");
  EXPECT_EQ(swept.exit_code, 0) << swept.output;
  EXPECT_THAT(swept.output, HasSubstr("sweep: Python: " + Note()));
}

TEST_F(InEnvironment, ThatIsActivatedAgentsOverDdsFindItsPackages) {
  ExpectDone(activated_ + "up law.toml --engine inprocess --quiet --out one");
  ExpectDone(activated_ + "up law.toml --quiet --out dds");
  EXPECT_EQ(ReadFile(scratch_.File("one/run.mcap")), ReadFile(scratch_.File("dds/run.mcap")));
}

TEST_F(InEnvironment, NobodyIsToldOfWhatNobodyUses) {
  Write("ours.toml", kConsensus);
  EXPECT_THAT(In(activated_ + "check ours.toml").output, testing::Not(HasSubstr("virtual environment")));
  EXPECT_THAT(In("VIRTUAL_ENV= \"$O\" check plain.toml").output, testing::Not(HasSubstr("virtual environment")));
}

TEST_F(InEnvironment, OfAnotherPythonItIsNotUsedAndThatIsTold) {
  Write("env/pyvenv.cfg", "version_info = 3.4.5.final.0\n");
  const std::string warning = "warning: VIRTUAL_ENV: its packages are not used: " + scratch_.File("env");
  for (const char* verb : {"check plain.toml", "up plain.toml --engine inprocess --out run"}) {
    const Ran ran = In(activated_ + verb);
    EXPECT_EQ(ran.exit_code, 0);
    EXPECT_THAT(ran.output, HasSubstr(warning + " is of Python 3.4, but code of users runs in Python " + Version() +
                                      ": `/usr/bin/python3 -m venv` makes one of that\n"));
  }
  Write("env/pyvenv.cfg", "version = " + Version() + "\n");
  std::filesystem::remove_all(scratch_.path() / packages_);
  EXPECT_THAT(In(activated_ + "check plain.toml").output,
              HasSubstr(warning + " has no lib/python" + Version() +
                        "/site-packages, for the Python in which code of users runs\n"));
  std::filesystem::remove_all(scratch_.path() / "env");
  EXPECT_THAT(In(activated_ + "check plain.toml").output,
              HasSubstr(warning + " has no pyvenv.cfg, and is no virtual environment\n"));
}

TEST_F(Surroundings, AnExperimentOutOfAPipeIsFlownAsOneOutOfAFile) {
  Write("experiment.toml", kConsensus);
  ExpectDone("\"$O\" up experiment.toml --engine inprocess --quiet --out file");
  ExpectDone("cat experiment.toml | \"$O\" up - --engine inprocess --quiet --out pipe");
  EXPECT_EQ(ReadFile(scratch_.File("file/run.mcap")), ReadFile(scratch_.File("pipe/run.mcap")));
  const Ran checked = In("bash -c '\"$0\" check <(cat experiment.toml)' \"$O\"");
  EXPECT_EQ(checked.exit_code, 0) << checked.output;
  EXPECT_THAT(checked.output, HasSubstr(": valid\n  experiment     experiment\n"));
  const Ran wrong = In("echo 'run.duration_s = -1' | \"$O\" graph -");
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.output, HasSubstr("error: <stdin>:1:18: run.duration_s: expected a number in (0, 1e+06], got -1"));
}

TEST_F(Surroundings, ALawBesideAPipeIsInTheCurrentFolder) {
  Write("law.py", "def control(t, me, neighbours):\n    return [0, 0, 0]\n");
  Write("experiment.toml", kRing + "law = { name = 'custom', file = 'law.py' }\n");
  ExpectDone("\"$O\" check - < experiment.toml");
  ExpectDone("bash -c '\"$0\" check <(cat experiment.toml)' \"$O\"");
}

TEST_F(Surroundings, ASweepOfAPipeGoesOnWithTheSameText) {
  Write("experiment.toml", kConsensus);
  const std::string sweep = "cat experiment.toml | \"$O\" sweep - --set law.p_gain=0.1,0.2 --no-plot --out s.csv ";
  ExpectDone(sweep);
  EXPECT_THAT(In(sweep).output, HasSubstr("2 runs, none flown now: s.csv"));
  EXPECT_THAT(In(sweep + "--slurm").output,
              HasSubstr("--slurm: expected a file, which each task of the job array reads, got <stdin>"));
}

TEST_F(Surroundings, APathIsAPathWhateverItBeginsWith) {
  for (const char* name : {"-x.toml", "--set", "~x.toml", "$x.toml", "a b.toml"}) {
    SCOPED_TRACE(name);
    Write(name, kConsensus);
    ExpectDone(std::string("\"$O\" check -- '") + name + "'");
  }
  const Ran wrong = In("\"$O\" check -x.toml");
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.output,
              HasSubstr("error: unknown option '-x.toml' (a path that begins with a dash stands behind --)"));
  ExpectDone("\"$O\" up --engine inprocess --quiet --set output.save_plot=true --out=-run -- -x.toml");
  ExpectDone("\"$O\" plot --only paths --format svg -- -run && test -s ./-run/paths.svg");
  ExpectDone("\"$O\" sweep --set law.p_gain=0.1,0.2 --out=-s.csv --quiet -- -x.toml && test -s ./-s.png");
}

TEST_F(Surroundings, SomeoneWithoutAHomeGetsPictures) {
  Write("experiment.toml",
        kRing.substr(0, kRing.find("output")) + "output = { velocity_plot = false }\nlaw.name = 'consensus'\n");
  ExpectDone(
      "chmod 777 . && env -i PATH=/usr/bin:/bin HOME=/nowhere TMPDIR=/nowhere \"$O\" up experiment.toml --engine "
      "inprocess --quiet --out o && test -s o/paths.png");
}

}  // namespace
}  // namespace mascot

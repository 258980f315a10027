// docs/configuration.md, docs/mascot.schema.json and the sections of docs/laws.md, which are generated from the tables
// of keys and laws, compared with the reader of experiment files (LoadExperiment) and with taplo, which editors use.
#include "orchestrator/reference/reference.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <toml++/toml.h>

#include <algorithm>
#include <filesystem>
#include <regex>
#include <set>
#include <sstream>

#include "agent/laws/laws.h"
#include "tests/support/folders.h"
#include "tests/support/scratch.h"

namespace mascot {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const fs::path kSource = test::SourceFolder();

std::vector<fs::path> TomlFiles(const fs::path& folder, const std::vector<std::string>& prefixes = {""}) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename();
    const auto begins = [&](const std::string& prefix) { return name.starts_with(prefix); };
    if (entry.path().extension() == ".toml" && std::ranges::any_of(prefixes, begins)) files.push_back(entry.path());
  }
  std::ranges::sort(files);
  return files;
}

/// Files that together contain every key. Those for a law in C++ and for FMUs are in the build folder, next to these.
std::vector<fs::path> GoodConfigs() {
  std::vector<fs::path> files = TomlFiles(kSource / "tests/good_configs");
  for (const char* const built : {"plugins/plugin.toml", "fmus/fmu.toml", "fmus/law_fmi3.toml"})
    files.push_back(fs::path(test::BuildFolder() + "/tests") / built);
  return files;
}

// --- current ----------------------------------------------------------------------------------------

constexpr const char* kHowTo = "run: cmake --build build/release --target reference";

TEST(Reference, IsCurrent) {
  EXPECT_EQ(ReadFile(kSource / "docs/configuration.md"), ConfigurationReference()) << kHowTo;
}

TEST(Reference, SchemaIsCurrent) {
  EXPECT_EQ(ReadFile(kSource / "docs/mascot.schema.json"), ConfigurationSchema()) << kHowTo;
}

TEST(Reference, SaysRangeDefaultAndMeaning) {
  const std::string text = ConfigurationReference();
  EXPECT_THAT(text, HasSubstr("| `loss` | [0, 1] | `0.0` | live | probability that a sample is lost"));
  EXPECT_THAT(text, HasSubstr("| `duration_s` | (0, 1e+06] | *required* | | "));
  EXPECT_THAT(text, HasSubstr("| `mode` | lockstep \\| realtime | `\"lockstep\"` | | "));
  EXPECT_THAT(text, HasSubstr("\n### [[link.override]]\n"));
  EXPECT_THAT(text, HasSubstr("\nKeys as in `[control]`, but for `rate_hz`, `python_memory_mb`.\n"));
  for (const LawEntry& law : Laws()) EXPECT_THAT(text, HasSubstr("law.name = \"" + std::string(law.name) + "\""));
}

// --- the page of the laws ---------------------------------------------------------------------------

const fs::path kPictures = kSource / "docs/pictures/laws";

TEST(LawPage, IsCurrent) {
  const std::string page = ReadFile(kSource / "docs/laws.md");
  EXPECT_EQ(page, LawPage(page, kSource / "configs")) << kHowTo;
}

TEST(LawPage, HasASectionOfEachLawAndItsPicture) {
  const std::string page = ReadFile(kSource / "docs/laws.md");
  std::vector<std::string_view> not_shown;
  for (const LawEntry& law : Laws()) {
    const std::string name(law.name);
    const std::size_t begin = page.find("\n### " + name + "\n");
    ASSERT_NE(begin, std::string::npos) << name;
    const std::string section = page.substr(begin, page.find("\n### ", begin + 1) - begin);
    for (const std::string& formula : FormulasOf(law)) EXPECT_THAT(section, HasSubstr(formula));
    EXPECT_THAT(section, HasSubstr("* Graph: " + std::string(law.graph)));
    EXPECT_THAT(section, HasSubstr(law.theory));
    EXPECT_THAT(section, HasSubstr(law.source));
    for (const Key& key : law.parameters) EXPECT_THAT(section, HasSubstr("| `" + std::string(key.name) + "` |"));
    for (const LawFigure& figure : law.figures)
      EXPECT_THAT(section, HasSubstr("| `" + std::string(figure.name) + "` |")) << name;
    if (section.find("](pictures/laws/" + name + ".png)") == std::string::npos) {
      not_shown.push_back(law.name);
      continue;
    }
    ASSERT_TRUE(fs::exists(kPictures / (name + ".png"))) << "run: scripts/law_pictures " << name;
    EXPECT_THAT(ReadFile(kPictures / (name + ".png")), testing::StartsWith("\x89PNG")) << name;
    EXPECT_LT(fs::file_size(kPictures / (name + ".png")), 60'000) << name;
  }
  EXPECT_THAT(not_shown, testing::ElementsAre("actions", "plugin", "fmu"))
      << "experiments with libraries, and for programs that step them, are not shipped";
}

TEST(LawPage, HasATableOfAllLawsWhoseCellsAreNotCutByTheirFormulas) {
  const std::string page = ReadFile(kSource / "docs/laws.md");
  const std::size_t begin = page.find("\n### All laws on one page\n");
  std::istringstream lines(page.substr(begin, page.find("\n### ", begin + 1) - begin));
  std::vector<std::string> rows;
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("| [")) rows.push_back(line);
  ASSERT_EQ(rows.size(), Laws().size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    EXPECT_THAT(rows[i], testing::StartsWith(fmt::format("| [{0}](#{0}) | $`", Laws()[i].name)));
    EXPECT_THAT(rows[i], HasSubstr(Laws()[i].source));
    EXPECT_EQ(std::ranges::count(rows[i], '|'), 5) << rows[i];
  }
}

/// Whether an equation in plain text names a key, with or without its unit.
bool Names(std::string_view equation, std::string_view key) {
  const std::string name(key), without_unit = std::regex_replace(name, std::regex("_(m_per_s|m|s|deg)$"), "");
  return std::regex_search(std::string(equation), std::regex("\\b(" + name + "|" + without_unit + ")\\b"));
}

TEST(LawPage, TypesetsEachEquationWithALetterForEachNumberThatThePlainOneNames) {
  for (const LawEntry& law : Laws()) {
    EXPECT_THAT(FormulasOf(law), Not(IsEmpty())) << law.name;
    EXPECT_THAT(law.graph, Not(IsEmpty())) << law.name;
    EXPECT_EQ(law.tex.find_first_of("|`$"), std::string_view::npos) << law.name << ": Markdown reads these itself";
    for (const KeySymbol& symbol : law.symbols) {
      EXPECT_THAT(law.tex, HasSubstr(symbol.tex)) << law.name;
      EXPECT_THAT(law.parameters, testing::Contains(testing::Field(&Key::name, symbol.key))) << law.name;
    }
    for (const Key& key : law.parameters) {
      if (key.kind != ValueKind::kNumber || !Names(law.equation, key.name)) continue;
      EXPECT_THAT(law.symbols, testing::Contains(testing::Field(&KeySymbol::key, key.name))) << law.name;
    }
  }
}

/// Blocks of TOML that are whole files: they have [run] and [agents], and need no other file.
TEST(Pages, HaveFilesThatAreLegal) {
  std::vector<fs::path> pages{kSource / "README.md"};
  for (const auto& entry : fs::directory_iterator(kSource / "docs"))
    if (entry.path().extension() == ".md") pages.push_back(entry.path());
  const std::string begin = "\n```toml", end = "\n```\n";
  int files = 0;
  for (const fs::path& page : pages) {
    const std::string text = ReadFile(page);
    for (std::size_t at = text.find(begin); at != text.npos; at = text.find(begin, at + 1)) {
      const std::size_t from = text.find('\n', at + begin.size()) + 1;
      const std::string block = text.substr(from, text.find(end, from) + 1 - from);
      const auto has = [&](const std::string& words) { return block.find(words) != block.npos; };
      if (!has("[run]") || !has("[agents]") || has("file = ")) continue;
      ++files;
      EXPECT_NO_THROW(LoadExperiment(Section::FromText(block, page.filename()), "page")) << block;
    }
  }
  EXPECT_GE(files, 6);
}

TEST(LawPage, BreaksTheEquationOfAFewFormulasIntoLines) {
  LawEntry two{};
  two.tex = "a = b \\\\\nc = d";
  EXPECT_THAT(FormulasOf(two), testing::ElementsAre("a = b", "c = d"));
  EXPECT_THAT(ReadFile(kSource / "docs/laws.md"), HasSubstr("\n```math\n\\begin{aligned}\n& "));
}

TEST(LawPage, HasNoPictureOfAnotherLaw) {
  for (const auto& entry : fs::directory_iterator(kPictures))
    EXPECT_THAT(LawNames(), testing::Contains(entry.path().stem().string())) << entry.path();
}

TEST(LawPage, ShowsALawByTheExperimentOfItsNameOrElseByTheFirst) {
  ScratchFolder folder;
  const auto write = [&](const std::string& name, const std::string& law) {
    WriteFile(folder.File(name + ".toml"),
              "#:schema x\n# Words of\n# " + name + ".\n#\n# Others.\n[law]\nname = '" + law + "'\n");
  };
  write("a", "finite_time");
  write("finite_time", "finite_time");
  write("z", "minmax");
  write("y", "minmax");
  const std::string page = LawPage(ReadFile(kSource / "docs/laws.md"), folder.path());
  EXPECT_THAT(page, HasSubstr("[configs/finite_time.toml](../configs/finite_time.toml). Words of finite_time.\n"));
  EXPECT_THAT(page, HasSubstr("[configs/y.toml](../configs/y.toml). Words of y.\n"));
  EXPECT_THAT(page, Not(HasSubstr("configs/a.toml")));
  EXPECT_THAT(page, Not(HasSubstr("configs/z.toml")));
}

TEST(LawPage, WithoutItsCommentsIsRefused) {
  EXPECT_THROW(LawPage("# Control laws\n", kSource / "configs"), std::runtime_error);
}

// --- complete and true ------------------------------------------------------------------------------

/// Calls `visit` with the path of every key in `table`, such as "link.override.loss".
template <class Visit>
void Walk(std::span<const Key> rows, const toml::table& table, const std::string& path, const Visit& visit) {
  for (const Key& key : rows) {
    const toml::node* node = table.get(key.name);
    if (node == nullptr) continue;
    const std::string inner = path + "." + std::string(key.name);
    visit(inner);
    if (const toml::table* child = node->as_table()) Walk(key.keys, *child, inner, visit);
    const toml::array* list = key.kind == ValueKind::kTables ? node->as_array() : nullptr;
    for (std::size_t i = 0; list != nullptr && i < list->size(); ++i)
      Walk(key.keys, *(*list)[i].as_table(), inner, visit);
  }
}

void AddAll(std::span<const Key> rows, const std::string& path, std::set<std::string>& all) {
  for (const Key& key : rows) {
    all.insert(path + "." + std::string(key.name));
    AddAll(key.keys, path + "." + std::string(key.name), all);
  }
}

TEST(GoodConfigs, ContainEveryKey) {
  std::set<std::string> missing;
  AddAll(ExperimentKeys(), "", missing);
  for (const LawEntry& law : Laws()) AddAll(law.parameters, std::string(law.name), missing);
  for (const fs::path& path : GoodConfigs()) {
    const toml::table file = toml::parse_file(path.string());
    const auto visit = [&](const std::string& key) { missing.erase(key); };
    Walk(ExperimentKeys(), file, "", visit);
    const std::string name = file["law"]["name"].value_or(std::string("consensus"));
    if (const toml::table* law = file["law"].as_table())
      for (const LawEntry& entry : Laws())
        if (entry.name == name) Walk(entry.parameters, *law, name, visit);
  }
  EXPECT_THAT(missing, IsEmpty()) << "tests/good_configs needs a file with each of these";
}

TEST(GoodConfigs, AreRead) {
  for (const fs::path& path : GoodConfigs())
    EXPECT_NO_THROW(LoadExperiment(Section::FromFile(path), path.stem())) << path;
}

// --- the schema -------------------------------------------------------------------------------------

struct Verdict {
  std::string output;
  /// Names of the files that the schema refuses.
  std::set<std::string> refused;
};

/// Checks files with taplo: all against our schema, or each against the schema that it names.
Verdict Taplo(const std::vector<fs::path>& files, bool by_our_schema) {
  const std::string program = test::SourceFolder() + "/tests/taplo/node_modules/.bin/taplo";
  if (!fs::exists(program))
    throw std::runtime_error("tests/taplo/node_modules is missing: run scripts/test, which installs it with `npm ci`");
  std::string command = "'" + program + "' check --colors never";
  if (by_our_schema) command += " --schema 'file://" + (kSource / "docs/mascot.schema.json").string() + "'";
  for (const fs::path& path : files) command += " '" + path.string() + "'";
  const Ran ran = Shell(command);
  Verdict verdict{ran.output, {}};
  EXPECT_THAT(ran.output, HasSubstr("found files total=" + std::to_string(files.size())));
  std::istringstream lines(ran.output);
  for (std::string line; std::getline(lines, line);) {
    if (line.find("schema validation failed") == std::string::npos) continue;
    const std::size_t begin = line.find("path=\"") + 6;
    verdict.refused.insert(fs::path(line.substr(begin, line.rfind('"') - begin)).filename());
  }
  EXPECT_EQ(ran.exit_code == 0, verdict.refused.empty()) << ran.output;
  return verdict;
}

TEST(Schema, IsNamedByTheShippedExperimentsAndAcceptsThem) {
  std::vector<fs::path> files = TomlFiles(kSource / "configs");
  for (const fs::path& path : files)
    EXPECT_THAT(ReadFile(path), testing::StartsWith("#:schema ../docs/mascot.schema.json\n"));
  for (const fs::path& path : TomlFiles(kSource / "configs/exercises")) {
    EXPECT_THAT(ReadFile(path), testing::StartsWith("#:schema ../../docs/mascot.schema.json\n"));
    files.push_back(path);
  }
  const Verdict verdict = Taplo(files, false);
  EXPECT_THAT(verdict.refused, IsEmpty()) << verdict.output;
}

TEST(Schema, IsFoundByTheLineInTheShippedExperiments) {
  ScratchFolder folder;
  fs::copy(kSource / "docs/mascot.schema.json", folder.path());
  WriteFile(folder.File("wrong.toml"), "#:schema ./mascot.schema.json\nrun.duration_s = 'long'\nagents.count = 1\n");
  const Verdict verdict = Taplo({folder.File("wrong.toml")}, false);
  EXPECT_EQ(verdict.refused.size(), 1u) << verdict.output;
}

TEST(Schema, AcceptsEveryKey) {
  const Verdict verdict = Taplo(GoodConfigs(), true);
  EXPECT_THAT(verdict.refused, IsEmpty()) << verdict.output;
}

TEST(Schema, AcceptsResolvedExperiments) {
  ScratchFolder folder;
  std::vector<fs::path> resolved;
  std::vector<fs::path> files = GoodConfigs();
  std::ranges::copy(TomlFiles(kSource / "configs"), std::back_inserter(files));
  for (const fs::path& path : files) {
    Section document = Section::FromFile(path);
    LoadExperiment(document, path.stem());
    resolved.push_back(folder.path() / (std::to_string(resolved.size()) + path.filename().string()));
    WriteFile(resolved.back(), document.Resolved());
  }
  const Verdict verdict = Taplo(resolved, true);
  EXPECT_THAT(verdict.refused, IsEmpty()) << verdict.output;
}

TEST(Schema, RefusesUnknownKeysNamesAndTypes) {
  std::vector<fs::path> files = TomlFiles(kSource / "tests/bad_configs", {"unknown_", "type_", "range_"});
  const std::set<std::string> beyond = {
      "type_count_float.toml",        // in JSON Schema, 4.0 is an integer
      "range_airframe_inertia.toml",  // a rule between three numbers
      "range_leader.toml",            // a rule between two keys
  };
  std::erase_if(files, [&](const fs::path& path) { return beyond.contains(path.filename()); });
  EXPECT_GE(files.size(), 40u);
  const Verdict verdict = Taplo(files, true);
  for (const fs::path& path : files)
    EXPECT_TRUE(verdict.refused.contains(path.filename())) << path << "\n" << verdict.output;
}

}  // namespace
}  // namespace mascot

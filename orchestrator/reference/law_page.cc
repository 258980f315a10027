// The sections of docs/laws.md: a law each, with the experiment that shows it and the picture of its run.
#include <fmt/format.h>

#include <algorithm>
#include <regex>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "agent/laws/laws.h"
#include "experiment/toml/section.h"
#include "orchestrator/reference/markdown.h"
#include "orchestrator/reference/reference.h"

namespace mascot {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kBegin =
    "<!-- From here on made from the table of laws by `cmake --build build/release --target reference`; a test keeps "
    "it "
    "current. -->\n";
constexpr std::string_view kEnd = "<!-- Until here. -->\n";

/// An experiment that shows a law.
struct ShownBy {
  std::string law, config, says;  ///< name of the law, of the file; the first paragraph of its comments
};

/// The first paragraph of the comments of an experiment.
std::string FirstWords(const std::string& toml) {
  std::istringstream lines(toml);
  std::string words;
  for (std::string line; std::getline(lines, line) && line != "#";)
    if (line.starts_with("# ")) words += (words.empty() ? "" : " ") + line.substr(2);
  return words;
}

std::vector<ShownBy> Shipped(const fs::path& configs) {
  std::vector<ShownBy> shipped;
  for (const auto& entry : fs::directory_iterator(configs)) {
    if (entry.path().extension() != ".toml") continue;
    Section law = Section::FromFile(entry.path()).Child("law");
    shipped.push_back({law.Text("name", std::string(LawNames().front())), entry.path().stem(),
                       FirstWords(ReadRegularFile(entry.path()))});
  }
  std::ranges::sort(shipped, {}, &ShownBy::config);
  return shipped;
}

/// The experiment that shows a law: the one of its name, or else the first; null: none.
const ShownBy* ShowOf(std::string_view law, const std::vector<ShownBy>& shipped) {
  const ShownBy* found = nullptr;
  for (const ShownBy& one : shipped)
    if (one.law == law && (found == nullptr || one.config == law)) found = &one;
  return found;
}

/// The typeset equation as a block, which GitHub and scripts/site show as mathematics.
std::string Displayed(const LawEntry& law) {
  const std::vector<std::string> formulas = FormulasOf(law);
  if (formulas.size() == 1) return fmt::format("```math\n{}\n```\n", formulas[0]);
  return fmt::format("```math\n\\begin{{aligned}}\n& {}\n\\end{{aligned}}\n```\n", fmt::join(formulas, " \\\\\n& "));
}

/// The typeset equation within a line, which may break where the formulas have a wide space.
std::string Inline(const LawEntry& law) {
  const std::regex wide(R"(, \\q?quad )");
  std::string text;
  for (const std::string& formula : FormulasOf(law))
    text += fmt::format("{}$`{}`$", text.empty() ? "" : " <br> ", std::regex_replace(formula, wide, "`$$, $$`"));
  return text;
}

/// Which letter of the equation is which key.
std::string Letters(const LawEntry& law) {
  std::string text;
  for (const KeySymbol& symbol : law.symbols)
    text += fmt::format("{}$`{}`$ is `{}`", text.empty() ? "" : ", ", symbol.tex, symbol.key);
  return text.empty() ? "" : fmt::format("\n{}.\n", text);
}

/// Text for a cell of a table: no sign means anything to Markdown.
std::string FormulaCell(std::string_view text) {
  std::string cell;
  for (const char c : text) {
    if (std::string_view("*|<&").find(c) != std::string_view::npos)
      cell += fmt::format("&#{};", static_cast<int>(c));
    else
      cell += c == '\n' ? std::string("<br>") : std::string(1, c);
  }
  return cell;
}

/// All laws on one page: what each does, why, and who found it.
std::string Overview() {
  std::string text =
      "\n### All laws on one page\n\n| law | equation | what theory says of it | source |\n|---|---|---|---|\n";
  for (const LawEntry& law : Laws())
    text += fmt::format("| [{0}](#{0}) | {1} | {2} | {3} |\n", law.name, Inline(law), FormulaCell(law.theory),
                        Cell(law.source));
  return text;
}

std::string TableOfFigures(std::span<const LawFigure> figures) {
  std::string text = "\n| figure | meaning |\n|---|---|\n";
  for (const LawFigure& figure : figures)
    text += fmt::format("| `{}` | {}{} |\n", figure.name, Cell(figure.meaning),
                        figure.each.empty() ? "" : fmt::format("; for each {}", figure.each));
  return text;
}

std::string SectionOf(const LawEntry& law, const ShownBy* show) {
  std::string text = fmt::format("\n### {}\n\n{} Default of `axes`: `\"{}\"`.\n\n{}{}\n", law.name,
                                 Sentence(law.summary), kAxes.Name(law.axes), Displayed(law), Letters(law));
  for (const std::string_view paragraph : DetailsOf(law)) text += fmt::format("{}\n\n", paragraph);
  text += fmt::format("* Graph: {}.\n* Theory: {}.\n* Source: {}.\n", law.graph, law.theory, law.source);
  if (show != nullptr)
    text += fmt::format(
        "* Experiment: [configs/{0}.toml](../configs/{0}.toml). {1}\n\n![Run of {0}.toml](pictures/laws/{2}.png)\n",
        show->config, show->says, law.name);
  if (!law.parameters.empty()) text += TableOfKeys(law.parameters);
  if (!law.figures.empty()) text += TableOfFigures(law.figures);
  return text;
}

}  // namespace

fs::path ExampleOf(std::string_view law, const fs::path& configs) {
  const std::vector<ShownBy> shipped = Shipped(configs);
  const ShownBy* show = ShowOf(law, shipped);
  if (show == nullptr) throw std::runtime_error("no experiment in " + configs.string() + " shows " + std::string(law));
  return configs / (show->config + ".toml");
}

std::string LawPage(const std::string& page, const fs::path& configs) {
  const std::size_t begin = page.find(kBegin), end = page.find(kEnd);
  if (begin == std::string::npos || end == std::string::npos || end < begin)
    throw std::runtime_error("docs/laws.md: the comments around the sections of the laws are missing");
  const std::vector<ShownBy> shipped = Shipped(configs);
  std::string text = page.substr(0, begin) + std::string(kBegin);
  text += Overview();
  for (const LawEntry& law : Laws()) text += SectionOf(law, ShowOf(law.name, shipped));
  return text + "\n" + page.substr(end);
}

}  // namespace mascot

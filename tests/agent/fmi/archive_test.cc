// Archives of FMUs: what is refused before anything is unpacked.
#include "agent/fmi/archive.h"

#include <gmock/gmock.h>

#include "agent/fmi/error.h"
#include "agent/fmi/model_description.h"
#include "tests/support/noise.h"

namespace mascot {
namespace {

using Files = std::map<std::string, std::string>;

std::string RefusalOfArchive(const std::string& bytes) {
  try {
    const FmuArchive archive(bytes);
    for (const auto& [name, size] : archive.sizes()) archive.Read(name);
  } catch (const FmuError& error) {
    return error.what();
  }
  return "nothing";
}

/// The bytes of an archive in which `from` stands as `to`, of the same length, wherever it is.
std::string Replaced(std::string bytes, const std::string& from, const std::string& to) {
  EXPECT_EQ(from.size(), to.size());
  for (std::size_t at = bytes.find(from); at != bytes.npos; at = bytes.find(from, at + to.size()))
    bytes.replace(at, from.size(), to);
  return bytes;
}

std::size_t CentralEntry(const std::string& bytes) { return bytes.find("PK\x01\x02"); }

std::string WithMode(std::string bytes, unsigned mode) {
  const std::size_t entry = CentralEntry(bytes);
  bytes[entry + 5] = 3;  // made on Unix
  bytes[entry + 40] = static_cast<char>(mode & 0xFF);
  bytes[entry + 41] = static_cast<char>(mode >> 8);
  return bytes;
}

TEST(FmuArchive, UnpacksWhatWasPacked) {
  const Files files = {{"a", "one"}, {"b/c", std::string(100'000, 'x')}, {"empty", ""}};
  const FmuArchive archive(PackFiles(files));
  ASSERT_EQ(archive.sizes().size(), 3U);
  for (const auto& [name, bytes] : files) EXPECT_EQ(archive.Read(name), bytes);
  EXPECT_EQ(PackFiles(files), PackFiles(files));
}

TEST(FmuArchive, RefusesWhatIsNoArchive) {
  EXPECT_THAT(RefusalOfArchive("a poem"), testing::StartsWith("no zip archive: "));
}

TEST(FmuArchive, RefusesNamesThatLeaveItsFolder) {
  const std::string good = PackFiles({{"resources/ab", "x"}});
  const auto named = [&](const std::string& name) { return RefusalOfArchive(Replaced(good, "resources/ab", name)); };
  EXPECT_EQ(named("resources/cd"), "nothing");
  EXPECT_EQ(named("../sources/a"), "entry '../sources/a' of the archive does not stay inside of the archive's folder");
  EXPECT_EQ(named("resource/../"), "entry 'resource/../' of the archive does not stay inside of the archive's folder");
  EXPECT_EQ(named("resource//ab"), "entry 'resource//ab' of the archive does not stay inside of the archive's folder");
  EXPECT_EQ(named("/etc/pass/wd"), "entry '/etc/pass/wd' of the archive has an absolute path");
  EXPECT_EQ(named("C:/ources/ab"), "entry 'C:/ources/ab' of the archive has a drive letter in its name");
  EXPECT_EQ(named("..\\ources/ab"), "entry '..\\ources/ab' of the archive has a backslash in its name");
  EXPECT_THAT(RefusalOfArchive(PackFiles({{std::string(1001, 'a'), "x"}})),
              testing::HasSubstr("has no name that a file may have"));
}

TEST(FmuArchive, RefusesLinksAndDevices) {
  const std::string good = PackFiles({{"resources/ab", "/etc"}});
  EXPECT_EQ(RefusalOfArchive(WithMode(good, 0100644)), "nothing");
  EXPECT_EQ(RefusalOfArchive(WithMode(good, 0120777)), "entry 'resources/ab' of the archive is a link");
  EXPECT_EQ(RefusalOfArchive(WithMode(good, 0020666)),
            "entry 'resources/ab' of the archive is neither a file nor a folder");
}

TEST(FmuArchive, RefusesNamesThatOccurTwice) {
  EXPECT_EQ(RefusalOfArchive(Replaced(PackFiles({{"a1", "x"}, {"a2", "y"}}), "a2", "a1")),
            "entry 'a1' of the archive occurs twice");
  EXPECT_EQ(RefusalOfArchive(PackFiles({{"a", "x"}, {"a/b", "y"}})), "entry 'a' of the archive is a file and a folder");
}

TEST(FmuArchive, RefusesWhatIsEncryptedOrOtherwiseCompressed) {
  std::string bytes = PackFiles({{"a", std::string(1000, 'x')}});
  bytes[CentralEntry(bytes) + 8] |= 1;
  EXPECT_EQ(RefusalOfArchive(bytes), "entry 'a' of the archive is encrypted");
  bytes = PackFiles({{"a", std::string(1000, 'x')}});
  bytes[CentralEntry(bytes) + 10] = 12;  // bzip2
  EXPECT_EQ(RefusalOfArchive(bytes), "entry 'a' of the archive is compressed by another method than deflate");
}

TEST(FmuArchive, RefusesBombs) {
  EXPECT_THAT(RefusalOfArchive(PackFiles({{"a", std::string(std::size_t{8} << 20, '\0')}})),
              testing::MatchesRegex("entry 'a' of the archive unpacks [0-9]+ bytes to 8388608, expected at most 200 "
                                    "times as many"));
  EXPECT_EQ(RefusalOfArchive(PackFiles({{"a", std::string((std::size_t{64} << 20) + 1, '\0')}})),
            "entry 'a' of the archive unpacks to 67108865 bytes, expected at most 67108864");
  Files many;
  for (int k = 0; k <= 10'000; ++k) many[std::to_string(k)] = "";
  EXPECT_EQ(RefusalOfArchive(PackFiles(many)), "an archive of 10001 entries, expected at most 10000");
}

TEST(FmuArchive, RefusesBombsOfManyFiles) {
  const std::string noise = test::Noise(400'000);
  std::string bytes = PackFiles({{"a", noise}, {"b", noise}, {"c", noise}, {"d", noise}, {"e", noise}});
  constexpr std::uint32_t kClaimed = 60 << 20;  // 157 times as much as it is packed
  for (std::size_t at = CentralEntry(bytes); at != bytes.npos; at = bytes.find("PK\x01\x02", at + 4))
    for (unsigned k = 0; k < 4; ++k) bytes[at + 24 + k] = static_cast<char>(kClaimed >> (8 * k) & 0xFF);
  EXPECT_EQ(RefusalOfArchive(bytes), "an archive that unpacks to more than 268435456 bytes");
}

TEST(FmuArchive, KnowsWhichFilesMayBeExecuted) {
  const Files files = {{"a", "x"}, {"tool", "y"}};
  const FmuArchive archive(PackFiles(files, {"tool"}));
  EXPECT_THAT(archive.executables(), testing::ElementsAre("tool"));
  EXPECT_EQ(archive.Read("tool"), "y");
}

TEST(FmuArchive, TellsDamage) {
  std::string bytes = PackFiles({{"a", "some words that are stored"}});
  bytes[40] = static_cast<char>(bytes[40] ^ 1);
  EXPECT_THAT(RefusalOfArchive(bytes), testing::StartsWith("entry 'a' of the archive is damaged"));
}

// --- the description -------------------------------------------------------------------------------------

std::string RefusalOfXml(const std::string& text) {
  try {
    ModelDescription::FromXml(text);
  } catch (const FmuError& error) {
    return error.what();
  }
  return "nothing";
}

std::string Root(const std::string& inside, const std::string& version = "3.0") {
  return "<fmiModelDescription fmiVersion=\"" + version + "\">" + inside + "</fmiModelDescription>";
}
const std::string kCs = "<CoSimulation modelIdentifier=\"law\"/>";

TEST(ModelDescription, RefusesWhatCannotBeFlown) {
  EXPECT_THAT(RefusalOfXml("<a"), testing::StartsWith("modelDescription.xml:1: no XML: "));
  EXPECT_EQ(RefusalOfXml("<a/>"), "modelDescription.xml without the element fmiModelDescription");
  EXPECT_EQ(RefusalOfXml("<!DOCTYPE a [<!ENTITY b 'c'>]>" + Root(kCs)),
            "modelDescription.xml has a document type, which is not read");
  EXPECT_EQ(RefusalOfXml(Root(kCs, "1.0")), "an FMU of FMI '1.0', expected FMI 2 or 3");
  EXPECT_EQ(RefusalOfXml(Root("<ModelExchange/>")), "an FMU for ModelExchange alone, expected one for CoSimulation");
  EXPECT_EQ(RefusalOfXml(Root("<ScheduledExecution/>")),
            "an FMU for ScheduledExecution alone, expected one for CoSimulation");
  EXPECT_EQ(RefusalOfXml(Root("<CoSimulation modelIdentifier=\"../law\"/>")),
            "modelDescription.xml: expected a name in C as modelIdentifier, got '../law'");
  std::string deep;
  for (int k = 0; k < 200; ++k) deep += "<a>";
  EXPECT_THAT(RefusalOfXml(Root(deep)), testing::HasSubstr("no XML: XML_ELEMENT_DEPTH_EXCEEDED"));
}

TEST(ModelDescription, NamesTheCategoriesForErrors) {
  const auto with = [](const std::string& categories) {
    return ModelDescription::FromXml(Root(kCs + categories)).error_categories;
  };
  EXPECT_THAT(with(""), testing::IsEmpty());
  EXPECT_THAT(with("<LogCategories><Category name='logAll'/><Category name='logStatusError'/></LogCategories>"),
              testing::ElementsAre("logStatusError"));
}

TEST(ModelDescription, RefusesVariablesThatCannotBe) {
  const auto with = [](const std::string& variables) {
    return RefusalOfXml(Root(kCs + "<ModelVariables>" + variables + "</ModelVariables>"));
  };
  EXPECT_EQ(with("<Float64 name='a' valueReference='x'/>"),
            "modelDescription.xml:1: expected a number as valueReference of variable 'a', got 'x'");
  EXPECT_EQ(with("<Float64 valueReference='1'/>"), "modelDescription.xml:1: a variable without a name");
  EXPECT_EQ(with("<Float64 name='a' valueReference='1'/><Float64 name='a' valueReference='2'/>"),
            "modelDescription.xml has variable 'a' twice");
  EXPECT_EQ(with("<Float64 name='a' valueReference='1'><Dimension start='99999999'/></Float64>"),
            "modelDescription.xml:1: expected a dimension of at most 100000, got '99999999'");
  EXPECT_EQ(with("<Float64 name='a' valueReference='1'><Dimension start='1000'/><Dimension start='1000'/></Float64>"),
            "variable 'a' has more than 100000 values");
  EXPECT_EQ(with("<Float64 name='a' valueReference='1'><Dimension valueReference='7'/></Float64>"),
            "a dimension of variable 'a' is a structural parameter that has no start value");
}

}  // namespace
}  // namespace mascot

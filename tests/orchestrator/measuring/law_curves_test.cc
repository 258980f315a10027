// The curve of each law that has one: a value in each tick, which comes to what the law's figures say of the run.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <ostream>
#include <string>

#include "agent/laws/laws.h"
#include "orchestrator/engines/inprocess.h"
#include "orchestrator/measuring/law_curve.h"
#include "orchestrator/measuring/run_meter.h"
#include "tests/support/folders.h"
#include "tests/support/param_name.h"

namespace mascot {
namespace {

enum class Comes { kToItsLast, kToItsSmallest, kToItsLargestOfTheSecondHalf };

/// How the curve of a law comes to one of its figures. Of a list of values, to their sum.
struct CurveCase {
  std::string law, figure;
  Comes comes = Comes::kToItsLast;
};

void PrintTo(const CurveCase& curve, std::ostream* out) { *out << curve.law; }

const CurveCase kCurveCases[] = {
    {"affine_formation", "place_error_m"},
    {"average_tracking", "tracking_error_m", Comes::kToItsLargestOfTheSecondHalf},
    {"avoidance", "clearance_m", Comes::kToItsSmallest},
    {"bearing_formation", "bearing_error_deg"},
    {"containment", "lag_m"},
    {"coverage", "cost_end_m2"},
    {"cyclic_pursuit", "radius_m"},
    {"distance_formation", "distance_error_m"},
    {"event_triggered", "messages"},
    {"flocking", "velocity_off_m_per_s"},
    {"gradient_tracking", "error_m"},
    {"platoon", "least_gap_m", Comes::kToItsSmallest},
    {"pursuit_evasion", "closest_m", Comes::kToItsSmallest},
};

struct CurveOfRun final : RowSink {
  explicit CurveOfRun(const RunMeter& of) : meter(of) {}
  void Add(const FlownRow& /*row*/) override { values.push_back(meter.curve()); }
  const RunMeter& meter;
  std::vector<std::optional<double>> values;
};

Experiment ShippedFor(const std::string& law, const char* duration_s) {
  const std::string path = test::SourceFolder() + "/configs/" + law + ".toml";
  const Override shorter[] = {{.key = "run.duration_s", .value = duration_s}};
  return LoadExperiment(Section::FromFile(path, shorter), law);
}

/// The values of the curve of a shipped experiment, the first seconds of it.
std::vector<double> CurveIn(const Experiment& experiment, RunMeter& meter) {
  CurveOfRun curve(meter);
  EXPECT_EQ(RunInProcess(experiment, {&meter, &curve}, [] { return true; }).failure, "");
  std::vector<double> values;
  for (const std::optional<double>& value : curve.values)
    if (value) values.push_back(*value);
  return values;
}

class LawCurves : public testing::TestWithParam<CurveCase> {};

TEST_P(LawCurves, ComeToTheFigureOfTheRun) {
  const auto& [law, name, comes] = GetParam();
  const Experiment experiment = ShippedFor(law, "4.0");
  RunMeter meter(experiment);
  const std::vector<double> values = CurveIn(experiment, meter);
  ASSERT_GT(std::ssize(values), experiment.ticks() - 5) << "all but the ticks before the first messages";
  EXPECT_NE(*std::ranges::min_element(values), *std::ranges::max_element(values)) << "it moves";

  const LawMeasured measured = meter.LawsOf(0).front();
  const auto figure = std::ranges::find(measured.law->figures, name, &LawFigure::name);
  ASSERT_NE(figure, measured.law->figures.end());
  double expected = 0;
  for (const auto& value : measured.figures[static_cast<std::size_t>(figure - measured.law->figures.begin())])
    expected += value.value();
  const auto half = std::ssize(values) - 1 - (experiment.ticks() - experiment.ticks() / 2);
  const double come = comes == Comes::kToItsLast       ? values.back()
                      : comes == Comes::kToItsSmallest ? *std::ranges::min_element(values)
                                                       : *std::max_element(values.begin() + half, values.end());
  EXPECT_DOUBLE_EQ(come, expected);
}

INSTANTIATE_TEST_SUITE_P(Of, LawCurves, testing::ValuesIn(kCurveCases), test::NamedAsPrinted<CurveCase>);

TEST(LawCurve, OfFlightsToTargetsAreTheDistanceThatIsLeft) {
  const Experiment waypoint = ShippedFor("waypoint", "5.0");
  RunMeter meter(waypoint);
  const std::vector<double> values = CurveIn(waypoint, meter);
  ASSERT_EQ(std::ssize(values), waypoint.ticks() + 1);
  const Eigen::Vector3d to_W = WaypointsOf(waypoint.agents[0]).front() - waypoint.agents[0].p_W;
  EXPECT_DOUBLE_EQ(values.front(), Along(waypoint.law.axes, to_W).norm());
  EXPECT_LT(values[100], values.front());
  const Experiment trajectory = ShippedFor("trajectory", "5.0");
  RunMeter other(trajectory);
  EXPECT_EQ(std::ssize(CurveIn(trajectory, other)), trajectory.ticks() + 1);
}

TEST(LawCurveRecord, HasAValueOfEveryTickThatHasOne) {
  const Experiment experiment = ShippedFor("platoon", "0.03");
  RunMeter meter(experiment);
  LawCurveRecord record(experiment, meter);
  CurveOfRun curve(meter);
  EXPECT_FALSE(record.has_values());
  ASSERT_EQ(RunInProcess(experiment, {&meter, &record, &curve}, [] { return true; }).failure, "");
  ASSERT_EQ(curve.values.size(), 4);
  EXPECT_EQ(record.Csv(), fmt::format("t_s,value\n0,{}\n0.01,{}\n0.02,{}\n0.03,{}\n", *curve.values[0],
                                      *curve.values[1], *curve.values[2], *curve.values[3]));
}

TEST(LawCurveRecord, IsThinnedEvenlyInALongRun) {
  const Experiment experiment = ShippedFor("platoon", "100.0");  // 10001 rows
  RunMeter meter(experiment);
  LawCurveRecord record(experiment, meter);
  ASSERT_EQ(RunInProcess(experiment, {&meter, &record}, [] { return true; }).failure, "");
  const std::string csv = record.Csv();
  EXPECT_EQ(std::ranges::count(csv, '\n'), 1 + 2501) << "every fourth, with the last";
  EXPECT_THAT(csv, testing::HasSubstr("\n0.04,"));
  EXPECT_THAT(csv, testing::HasSubstr("\n100,"));
}

TEST(LawCurveRecord, IsEmptyOfALawWithoutACurve) {
  const Experiment experiment = ShippedFor("leaderless", "0.1");
  RunMeter meter(experiment);
  LawCurveRecord record(experiment, meter);
  ASSERT_EQ(RunInProcess(experiment, {&meter, &record}, [] { return true; }).failure, "");
  EXPECT_FALSE(record.has_values());
}

TEST(LawCurve, ArePartOfTheTableOrNot) {
  int with = 0;
  for (const LawEntry& law : Laws()) {
    if (!law.curve) continue;
    ++with;
    EXPECT_NE(law.meter, nullptr) << law.name;
    EXPECT_FALSE(law.curve->name.empty()) << law.name;
    if (!law.curve->figure.empty()) {
      EXPECT_NE(std::ranges::find(law.figures, law.curve->figure, &LawFigure::name), law.figures.end()) << law.name;
    }
    EXPECT_TRUE(law.curve->decays || !law.agrees || law.name == "event_triggered") << law.name;
  }
  EXPECT_EQ(with, std::ssize(kCurveCases) + 2) << "waypoint and trajectory have tests of their own";
}

}  // namespace
}  // namespace mascot

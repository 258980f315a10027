#include "agent/laws/trajectory/reference_path.h"

#include <cmath>
#include <numbers>

#include "agent/laws/parts/row_parts.h"
#include "agent/laws/trajectory/sampled_pd.h"

namespace mascot {

namespace {

/// The samples, from where they stand or from a file; nullopt after a mistake.
std::optional<PathSamples> ReadSamples(Section& law) {
  law.TakeOneOf({"file", "samples"});
  const bool in_file = law.Has("file");
  if (!HasOneOf(law, "samples", "file", "file", "path")) return std::nullopt;
  const Section::FileText text =
      in_file ? law.TextOfFile("file", "samples") : Section::FileText{law.Text("samples"), ""};
  if (law.Wrong(in_file ? "file" : "samples")) return std::nullopt;
  PathSamples samples;
  TextPlace at;
  const std::string mistake = samples.Read(text.text, at);
  if (mistake.empty()) return samples;
  if (in_file)
    law.FailInText("file", text.name + ":" + std::to_string(at.line) + ":" + std::to_string(at.column), mistake);
  else
    law.Fail("samples", "line " + std::to_string(at.line) + ", column " + std::to_string(at.column) + ": " + mistake);
  return std::nullopt;
}

}  // namespace

ReferencePath ReferencePath::Circle(const Eigen::Vector3d& centre_W, double radius_m, double period_s) {
  const double w = 2 * std::numbers::pi / period_s;
  return {.centre_W = centre_W, .period_s = period_s, .oscillations = {{w, {radius_m, Complex(0, -radius_m), 0}}}};
}

ReferencePath ReferencePath::FigureEight(const Eigen::Vector3d& centre_W, double radius_m, double period_s) {
  const double w = 2 * std::numbers::pi / period_s;  // sin wt cos wt = sin(2 wt) / 2
  return {.centre_W = centre_W,
          .period_s = period_s,
          .oscillations = {{w, {Complex(0, -radius_m), 0, 0}}, {2 * w, {0, Complex(0, -radius_m / 2), 0}}}};
}

PathPoint ReferencePath::At(double t_s) const {
  if (samples) return samples->At(t_s);
  PathPoint point{.p_W = centre_W};
  for (const Oscillation& one : oscillations) {
    const Eigen::Vector3cd now_W = Complex(std::cos(one.w * t_s), std::sin(one.w * t_s)) * one.size_W;
    point.p_W += now_W.real();
    point.v_W -= one.w * now_W.imag();
    point.a_W -= one.w * one.w * now_W.real();
  }
  return point;
}

ReferencePath ReadPath(Section& law) {
  law.Supersede("path", {"samples", "file"});
  const std::string path = law.OneOf("path");
  const Eigen::Vector3d centre_W = law.Vector3("centre_m");
  const double radius_m = law.Number("radius_m"), period_s = law.Number("period_s");
  if (path == "circle") return ReferencePath::Circle(centre_W, radius_m, period_s);
  if (path == "figure_eight") return ReferencePath::FigureEight(centre_W, radius_m, period_s);
  ReferencePath samples{.samples = ReadSamples(law)};
  if (samples.samples) samples.period_s = samples.samples->duration_s();
  return samples;
}

}  // namespace mascot

// What the images say of the rig's calibration.
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <array>
#include <cmath>

#include "core/file.h"
#include "report/drawing.h"
#include "report/html.h"
#include "report/part_content.h"
#include "scene/calibration.h"

namespace rigmap {
namespace {

const std::vector<std::string> kParameterNames{
    "right turned x", "right turned y", "right turned z", "focal lengths", "right focal",
    "fy / fx",        "right fy / fx",  "left cx",        "left cy",       "right cx",
    "right cy",       "left k1",        "left k2",        "left p1",       "left p2",
    "right k1",       "right k2",       "right p1",       "right p2"};

Json ReadCalibrationJson(const std::filesystem::path& root) {
  try {
    return Json::parse(ReadTextFile(root / "calibration.json"));
  } catch (const std::exception&) {
    return nullptr;
  }
}

// Summed over the stretches; nothing where the part tells nothing.
std::optional<CalibrationMatrix> Information(const Json& calibration) {
  CalibrationMatrix sum = CalibrationMatrix::Zero();
  for (const Json& stretch : At(calibration, "/stretches")) {
    const auto numbers = stretch.value("information", std::vector<double>());
    if (numbers.size() != static_cast<std::size_t>(sum.size())) return std::nullopt;
    sum += Eigen::Map<const CalibrationMatrix>(numbers.data());
  }
  if (!(sum.diagonal().array() > 0.0).any()) return std::nullopt;
  return sum;
}

// Of what the images alone leave unknown; parameters that they tell nothing of get none. In units
// of each parameter's own information, where a millionth stands for what no image tells.
CalibrationMatrix Correlations(const CalibrationMatrix& information) {
  const CalibrationVector scale =
      information.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  CalibrationMatrix normalised = scale.asDiagonal() * information * scale.asDiagonal();
  normalised.diagonal().array() += 1e-6;
  const CalibrationMatrix covariance = normalised.ldlt().solve(CalibrationMatrix::Identity());
  const CalibrationVector deviations = covariance.diagonal().cwiseMax(1e-300).cwiseSqrt();
  return deviations.cwiseInverse().asDiagonal() * covariance *
         deviations.cwiseInverse().asDiagonal();
}

std::string CorrelationDrawing(const Json& calibration) {
  const auto information = Information(calibration);
  if (!information) return "";
  const CalibrationMatrix correlations = Correlations(*information);
  const MatrixDrawing drawing{kCalibrationSize, kCalibrationSize, kParameterNames, 20.0};
  return "<figure>" +
         DrawMatrix(
             drawing,
             [&](int row, int column) {
               const double value = correlations(row, column);
               return MatrixCell{
                   std::abs(value), value < 0.0,
                   fmt::format("{} and {}: {:+.2f}", kParameterNames[static_cast<std::size_t>(row)],
                               kParameterNames[static_cast<std::size_t>(column)], value)};
             }) +
         "<figcaption>How the parameters' errors go together, as the images alone leave them: full "
         "colour is a correlation of \u00b11, the second colour a negative one. A pair in full "
         "colour cannot be told apart on this path. Columns are in the order of the "
         "rows.</figcaption></figure>\n";
}

std::string CorrectionTable(const FigureSource& summary) {
  if (!HasFigure(summary, "/rig/infinity_offset_sigma_px") &&
      !HasFigure(summary, "/rig/largest_shift_px")) {
    return "";
  }
  HtmlTable table({"Correction of the rig file", "Value", "Means"});
  const auto row = [&](const char* name, const std::string& value, const char* meaning) {
    table.Row({name, value, meaning});
  };
  for (int axis = 0; axis < 3; ++axis) {
    row(fmt::format("Right camera turned about its {}", "xyz"[axis]).c_str(),
        Figure(summary, fmt::format("/rig/right_eye_turned_deg/{}", axis), Quantity::kDegrees),
        axis == 1 ? "changes all depths, but for what a shift of the image centre takes back"
                  : "changes rows");
  }
  row("Focal length changed", Figure(summary, "/rig/focal_changed_pct", Quantity::kPercent),
      "of the left camera");
  row("fy / fx changed", Figure(summary, "/rig/aspect_changed_pct", Quantity::kPercent),
      "of the left camera");
  row("Largest shift", Figure(summary, "/rig/largest_shift_px", Quantity::kPixels),
      "of what is infinitely far, in the right image");
  row("Disparity at infinity",
      Figure(summary, "/rig/infinity_offset_px", Quantity::kPixels) + " " +
          PlusMinus(summary, "/rig/infinity_offset_sigma_px", Quantity::kPixels),
      "what the correction adds to every disparity; the sigma is of what is in use");
  row("Field of the lens", Figure(summary, "/rig/lens_field_rms_px", Quantity::kPixels),
      "displacements that mend what the lens model lacks, root mean square over the image");
  constexpr std::array kMoves{"up and down", "sideways, and depths with it,", "by rolling"};
  for (std::size_t axis = 0; axis < kMoves.size(); ++axis) {
    row(fmt::format("Flexure about {}", "xyz"[axis]).c_str(),
        Figure(summary, fmt::format("/rig/flexure_px/{}", axis), Quantity::kPixels),
        fmt::format("a rig that gives moves its right image {} about its mean (root mean square)",
                    kMoves[axis])
            .c_str());
  }
  return table.Text();
}

// Both cameras as the rig file has them and as they were used.
std::string CameraTable(const FigureSource& summary) {
  if (!HasFigure(summary, "/rig/given/baseline_m")) return "";
  const auto is_equal = [&](const std::string& key) {
    return At(summary.json, "/rig/given" + key) == At(summary.json, "/rig/used" + key);
  };
  HtmlTable table({"Calibration", "Rig file", "Used"});
  const auto row = [&](const std::string& name, const std::string& key) {
    table.Row(
        {name, Figure(summary, "/rig/given" + key, Quantity::kCalibration),
         is_equal(key) ? "the same" : Figure(summary, "/rig/used" + key, Quantity::kCalibration)});
  };
  for (const std::string eye : {"left", "right"}) {
    for (const std::string parameter : {"fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3"}) {
      const bool is_px = parameter[0] == 'f' || parameter[0] == 'c';
      row(fmt::format("{} {}{}", eye, parameter, is_px ? ", px" : ""),
          fmt::format("/{}/{}", eye, parameter));
    }
  }
  for (int axis = 0; axis < 3; ++axis) {
    row(fmt::format("right from left, turn about {}, degrees", "xyz"[axis]),
        fmt::format("/right_from_left_deg/{}", axis));
  }
  row("baseline, m", "/baseline_m");
  return "<details><summary>The rig's parameters</summary>" + table.Text() + "</details>\n";
}

std::string RingTable(const FigureSource& summary) {
  HtmlTable table(
      {"Distance from the image's middle", "Tracks", "Stereo less temporal depth", "in disparity"});
  const Json& rings = At(summary.json, "/depth_consistency/radius/rings");
  for (std::size_t i = 0; i < rings.size(); ++i) {
    const std::string at = fmt::format("/depth_consistency/radius/rings/{}", i);
    table.Row({Figure(summary, at + "/from_px", Quantity::kPixels) + " to " +
                   Figure(summary, at + "/to_px", Quantity::kPixels),
               Figure(summary, at + "/tracks", Quantity::kCount),
               Figure(summary, at + "/depth_pct", Quantity::kPercent) + " " +
                   PlusMinus(summary, at + "/depth_sigma_pct", Quantity::kPercent),
               Figure(summary, at + "/disparity_px", Quantity::kPixels) + " " +
                   PlusMinus(summary, at + "/disparity_sigma_px", Quantity::kPixels)});
  }
  if (table.empty()) return "";
  return fmt::format(
      "<h3>Stereo against temporal depth</h3><p>Depth by the two cameras and depth by the motion "
      "have to agree everywhere in the image. What differs by more than noise between regions: {} "
      "{} of the depth by distance from the middle, {} {} of disparity by "
      "position.</p>{}",
      Figure(summary, "/depth_consistency/radius/systematic_pct", Quantity::kPercent),
      PlusMinus(summary, "/depth_consistency/radius/systematic_sigma_pct", Quantity::kPercent),
      Figure(summary, "/depth_consistency/place/systematic_px", Quantity::kPixels),
      PlusMinus(summary, "/depth_consistency/place/systematic_sigma_px", Quantity::kPixels),
      table.Text());
}

std::string CellTable(const FigureSource& summary) {
  const Json& cells = At(summary.json, "/depth_consistency/place/cells");
  std::string grid;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::string at = fmt::format("/depth_consistency/place/cells/{}", i);
    const double value =
        cells[i]["disparity_px"].is_number() ? double(cells[i]["disparity_px"]) : 0;
    const double sigma =
        cells[i]["disparity_sigma_px"].is_number() ? double(cells[i]["disparity_sigma_px"]) : 1e9;
    const bool stands_out = std::abs(value) > 3.0 * sigma;
    grid +=
        fmt::format("<div{}>{}<br><small>{}</small></div>\n", stands_out ? " class=\"out\"" : "",
                    Figure(summary, at + "/disparity_px", Quantity::kPixels),
                    PlusMinus(summary, at + "/disparity_sigma_px", Quantity::kPixels));
  }
  if (grid.empty()) return "";
  return "<figure><div class=\"image-cells\">" + grid +
         "</div><figcaption>The same by position in the left image, px of disparity; framed: more "
         "than three sigmas.</figcaption></figure>\n";
}

std::string ResidualField(const PartContent& content) {
  if (!content.sparse || content.sparse->width == 0) return "";
  const SparseStatistics& statistics = *content.sparse;
  constexpr double kWidth_px = 480.0;
  const double height_px = kWidth_px * statistics.height / statistics.width;
  const Eigen::Vector2d cell_px(kWidth_px / kResidualColumns, height_px / kResidualRows);
  double largest_px = 0.0;
  for (const ResidualCell& cell : statistics.field) {
    if (cell.count >= 20) largest_px = std::max(largest_px, cell.mean_px.norm());
  }
  if (!(largest_px > 0.0)) return "";
  const double times = 0.9 * cell_px.minCoeff() / largest_px;
  std::string arrows = fmt::format(
      "<rect class=\"edge\" x=\"0.5\" y=\"0.5\" width=\"{:.0f}\" "
      "height=\"{:.0f}\"/>\n",
      kWidth_px - 1.0, height_px - 1.0);
  for (int i = 0; i < kResidualColumns * kResidualRows; ++i) {
    const ResidualCell& cell = statistics.field[static_cast<std::size_t>(i)];
    if (cell.count < 20) continue;
    const double x = cell_px.x() * (i % kResidualColumns + 0.5);
    const double y = cell_px.y() * (i / kResidualColumns + 0.5);
    const Eigen::Vector2d tip = times * cell.mean_px;
    arrows += fmt::format(
        "<g class=\"arrow\"><circle cx=\"{0:.1f}\" cy=\"{1:.1f}\" r=\"2\"/><path d=\"M{0:.1f} "
        "{1:.1f}l{2:.1f} {3:.1f}\"/><title>{4:+.3f}, {5:+.3f} px over {6}</title></g>\n",
        x, y, tip.x(), tip.y(), cell.mean_px.x(), cell.mean_px.y(), cell.count);
  }
  return fmt::format(
      "<figure>{}<figcaption>Residual field: mean of measured less projected positions over the "
      "left image, the longest arrow {:.3f} px. The camera model fits where "
      "neighbouring arrows have nothing in common.</figcaption></figure>\n",
      DrawingText(kWidth_px, height_px, "mean residuals over the image", arrows), largest_px);
}

}  // namespace

std::string CalibrationSection(const PartContent& content) {
  const FigureSource summary = content.folder.Summary();
  const Json calibration = ReadCalibrationJson(content.folder.root);
  const std::string table = CorrectionTable(summary);
  const bool refined = At(summary.json, "/rig/refined") == Json(true);
  const std::string drawings =
      CellTable(summary) + ResidualField(content) + CorrelationDrawing(calibration);
  const std::string body = table + CameraTable(summary) + RingTable(summary) +
                           (drawings.empty() ? "" : "<div class=\"pair\">" + drawings + "</div>\n");
  return HtmlSection(
      "calibration", "Calibration",
      refined ? "The images contradicted the rig file, and it was corrected: rig_refined.yaml."
              : "The images bear the rig file out; it was used as given.",
      body);
}

}  // namespace rigmap

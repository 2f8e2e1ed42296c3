// Keypoints, track lengths, and which frames show the same points.
#include <fmt/format.h>

#include <cmath>

#include "report/drawing.h"
#include "report/html.h"
#include "report/part_content.h"

namespace rigmap {
namespace {

std::string TrackLengths(const SparseStatistics& statistics) {
  std::map<std::string, std::size_t> groups;
  std::vector<std::pair<std::string, std::size_t>> bars;
  for (const auto& [frames, points] : statistics.tracks) {
    const std::string name = frames < 8    ? std::to_string(frames)
                             : frames < 16 ? "8 to 15"
                             : frames < 32 ? "16 to 31"
                             : frames < 64 ? "32 to 63"
                                           : "64 and more";
    if (bars.empty() || bars.back().first != name) bars.emplace_back(name, 0);
    bars.back().second += points;
  }
  std::size_t most = 1;
  for (const auto& bar : bars) most = std::max(most, bar.second);
  HtmlTable table({"Frames that show a point", "Points", ""});
  for (const auto& [name, points] : bars) {
    table.Row({name, std::to_string(points),
               fmt::format("<span class=\"bar-of\" style=\"width:{:.1f}%\"></span>",
                           100.0 * static_cast<double>(points) / static_cast<double>(most))});
  }
  return table.Text();
}

std::string SharedPoints(const SparseStatistics& statistics) {
  if (statistics.matrix_side < 2) return "";
  const int side = statistics.matrix_side;
  double most = 1.0;
  for (const std::size_t shared : statistics.matrix) {
    most = std::max(most, static_cast<double>(shared));
  }
  const MatrixDrawing drawing{side, side, {}, std::max(8.0, std::floor(400.0 / side))};
  const std::string frames =
      statistics.frames_per_group == 1
          ? "each square a pair of frames"
          : fmt::format("each square {} by {} frames", statistics.frames_per_group,
                        statistics.frames_per_group);
  return fmt::format(
      "<figure>{}<figcaption>Points that two frames have in common, {}, the first frame at the top "
      "left. Squares far from the diagonal are loop closures: places seen "
      "again.</figcaption></figure>\n",
      DrawMatrix(drawing,
                 [&](int row, int column) {
                   const std::size_t shared =
                       statistics.matrix[static_cast<std::size_t>(row * side + column)];
                   return MatrixCell{std::sqrt(static_cast<double>(shared) / most), false, ""};
                 }),
      frames);
}

}  // namespace

std::string TracksSection(const PartContent& content) {
  const FigureSource summary = content.folder.Summary();
  std::string body;
  if (HasFigure(summary, "/revisits/pairs")) {
    body += fmt::format(
        "<p>Loop closures, pairs of frames that show a place again: {}, of these {} found by "
        "appearance.</p>\n",
        Figure(summary, "/revisits/pairs", Quantity::kCount),
        Figure(summary, "/revisits/by_appearance", Quantity::kCount));
  }
  if (HasFigure(summary, "/matches/matches_median")) {
    body += fmt::format(
        "<p>A left image has {} keypoints. {} pairs of frames are matched, by {} matches each "
        "(medians).</p>\n",
        Figure(summary, "/matches/keypoints_median", Quantity::kCount),
        Figure(summary, "/matches/pairs", Quantity::kCount),
        Figure(summary, "/matches/matches_median", Quantity::kCount));
  }
  if (content.sparse) {
    const SparseStatistics& statistics = *content.sparse;
    body += fmt::format(
        "<p>{} points of the sparse model, seen {} times in all images; a left image shows {:.0f} "
        "of them (median).</p>\n",
        statistics.points, statistics.observations, MedianPointsOfImages(statistics));
    body += "<div data-chart=\"points-per-frame\"></div>\n";
    body += "<div class=\"pair\"><div>" + TrackLengths(statistics) + "</div>" +
            SharedPoints(statistics) + "</div>\n";
  }
  return HtmlSection("tracks", "Matches",
                     "What the poses rest on: points on the ground that were followed through the "
                     "images, and places that were recognised.",
                     body);
}

}  // namespace rigmap

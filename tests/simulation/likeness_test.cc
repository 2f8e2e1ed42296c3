// Whether a simulated beach is as rich in features as another renderer's, where RIGMAP_DATA says.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <opencv2/features2d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "core/stamp.h"
#include "dataset/rig_file.h"
#include "simulation/photograph.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

struct Richness {
  double keypoints = 0.0;  // in a frame
  double matches = 0.0;    // unambiguous ones with the next frame
  double spread_cells =
      0.0;  // of 48: over how many the matches spread (exponential of the entropy)
};

Richness RichnessOf(const cv::Mat& frame, const cv::Mat& next) {
  const auto sift = cv::SIFT::create();
  std::vector<cv::KeyPoint> here, there;
  cv::Mat descriptors_here, descriptors_there;
  sift->detectAndCompute(frame, {}, here, descriptors_here);
  sift->detectAndCompute(next, {}, there, descriptors_there);
  std::vector<std::vector<cv::DMatch>> pairs;
  cv::BFMatcher(cv::NORM_L2).knnMatch(descriptors_here, descriptors_there, pairs, 2);
  Richness richness{.keypoints = static_cast<double>(here.size())};
  std::vector<double> cells(48, 0.0);
  for (const auto& candidates : pairs) {
    if (candidates[0].distance > 0.8f * candidates[1].distance) continue;
    const cv::Point2f at = here[candidates[0].queryIdx].pt;
    const int column = static_cast<int>(8.0f * at.x / static_cast<float>(frame.cols)),
              row = static_cast<int>(6.0f * at.y / static_cast<float>(frame.rows));
    cells[std::clamp(row, 0, 5) * 8 + std::clamp(column, 0, 7)] += 1.0;
    richness.matches += 1.0;
  }
  double entropy = 0.0;
  for (const double count : cells) {
    if (count > 0.0) entropy -= count / richness.matches * std::log(count / richness.matches);
  }
  richness.spread_cells = std::exp(entropy);
  return richness;
}

Richness MeanOf(const Richness& a, const Richness& b) {
  return {0.5 * (a.keypoints + b.keypoints), 0.5 * (a.matches + b.matches),
          0.5 * (a.spread_cells + b.spread_cells)};
}

// Of the middle of the part: two frames and their successors.
Richness RichnessOfPart(const fs::path& loccam) {
  std::vector<std::pair<StampNs, fs::path>> left;
  for (const auto& entry : fs::directory_iterator(loccam)) {
    const std::string name = entry.path().stem().string();
    if (!name.ends_with("_0")) continue;
    left.emplace_back(ParseKatwijkStamp(name.substr(7, name.size() - 9)), entry.path());
  }
  std::ranges::sort(left);
  const auto read = [&](std::size_t i) {
    return cv::imread(left.at(i).second.string(), cv::IMREAD_GRAYSCALE);
  };
  return MeanOf(RichnessOf(read(8), read(9)), RichnessOf(read(24), read(25)));
}

Richness RichnessOfSimulation(const StereoRig& rig) {
  SimulationRequest request{.pairs = 12, .seed = 11, .rig = rig};
  const DrivePlan plan = PlanDrive(request);
  const World world(plan.scene, plan.path.Outline(0.25));
  const RoverMotion motion(plan.path,
                           [&](double x, double y) { return world.terrain().Height(x, y); });
  const auto frames = FramesOf(plan, motion, MountOf(rig));
  const Photographer photographer(world, rig, plan, motion);
  const auto take = [&](int i) {
    cv::Mat grey;
    cv::cvtColor(photographer.Take(frames.at(i), Eye::kLeft), grey, cv::COLOR_BGR2GRAY);
    return grey;
  };
  return MeanOf(RichnessOf(take(2), take(3)), RichnessOf(take(8), take(9)));
}

TEST(Likeness, BeachIsAsRichInFeaturesAsAnotherRenderersWithin30Percent) {
  const char* data = std::getenv("RIGMAP_DATA");
  if (data == nullptr) GTEST_SKIP() << "RIGMAP_DATA is not set";
  const fs::path beach = fs::path(data) / "beach-dev";
  const Richness theirs = RichnessOfPart(beach / "Traverse3/Part1/LocCam");
  const Richness ours = RichnessOfSimulation(ReadRigFile(beach / "rig.yaml"));
  EXPECT_NEAR(ours.keypoints / theirs.keypoints, 1.0, 0.3);
  EXPECT_NEAR(ours.matches / theirs.matches, 1.0, 0.3);
  EXPECT_NEAR(ours.spread_cells / theirs.spread_cells, 1.0, 0.3);
}

}  // namespace
}  // namespace rigmap

// Single pairs with dense truth, by `--depth-maps`; they lie beside the project, where RIGMAP_DATA
// says.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "core/file.h"
#include "core/statistics.h"
#include "tests/support/temporary_folder.h"
#include "tests/workflows/rigmap_program.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

// Rectified, without distortion.
struct DensePair {
  std::string left, right, disparities;  // 0 or infinite: unknown
  double focal_px, cx, cy, baseline_m;
};

struct Agreement {
  double known_pct = 0.0, off_by_two_px_pct = 0.0, median_px = 0.0;
};

class DensePairs : public testing::Test {
 protected:
  void SetUp() override {
    const char* data = std::getenv("RIGMAP_DATA");
    if (!data) GTEST_SKIP() << "RIGMAP_DATA is not set";
    data_ = fs::path(data) / "dense-pairs";
  }

  Agreement Measure(const DensePair& pair) const {
    const cv::Mat truth_px = cv::imread(data_ / pair.disparities, cv::IMREAD_UNCHANGED);
    const cv::Mat depth = DepthOf(pair, truth_px.size());
    EXPECT_EQ(depth.size(), truth_px.size());
    EXPECT_EQ(depth.type(), CV_32FC1);
    int known = 0, all = 0, off = 0;
    std::vector<double> errors_px;
    for (int row = 0; row < depth.rows; ++row) {
      for (int column = 0; column < depth.cols; ++column) {
        const float expected = truth_px.at<float>(row, column), z = depth.at<float>(row, column);
        if (!std::isfinite(expected) || expected <= 0.0F) continue;
        ++all;
        if (!std::isfinite(z)) continue;
        ++known;
        errors_px.push_back(std::abs(pair.focal_px * pair.baseline_m / z - expected));
        off += errors_px.back() > 2.0 ? 1 : 0;
      }
    }
    return {100.0 * known / all, 100.0 * off / known, Median(std::move(errors_px))};
  }

 private:
  cv::Mat DepthOf(const DensePair& pair, const cv::Size& size) const {
    const fs::path dataset = folder_.Path() / "pair", out = folder_.Path() / "out";
    for (const char* eye : {"left", "right"}) {
      fs::create_directories(dataset / eye);
      const cv::Mat image =
          cv::imread(data_ / (eye == std::string("left") ? pair.left : pair.right));
      cv::imwrite(dataset / eye / "0000.png", image);
    }
    const std::string camera = fmt::format(
        "{{model: PINHOLE, width: {}, height: {}, fx: {}, fy: {}, cx: {}, cy: {}, distortion: [0, "
        "0, "
        "0, 0]}}",
        size.width, size.height, pair.focal_px, pair.focal_px, pair.cx, pair.cy);
    std::ofstream(dataset / "calib.yaml")
        << fmt::format("left: {}\nright: {}\n", camera, camera)
        << fmt::format(
               "right_from_left: {{R: [1, 0, 0, 0, 1, 0, 0, 0, 1], t: [{}, 0, 0]}}\n"
               "baseline_m: {}\nrectified: true\n",
               -pair.baseline_m, pair.baseline_m);
    std::ofstream(dataset / "times.txt") << "0.0\n";
    const ProgramEnd end = RunRigmap({"part", "--dataset", dataset, "--out", out, "--depth-maps",
                                      "--until", "depth_maps", "--quiet"});
    EXPECT_EQ(end.exit_code, 0) << end.err;
    return cv::imread(out / "depth_maps" / "0.tif", cv::IMREAD_UNCHANGED);
  }

  fs::path data_;
  TemporaryFolder folder_;
};

// In the lower quarter of this pair both views, laid on each other by the truth, differ by a third
// of a pixel: its median cannot be small.
TEST_F(DensePairs, OfAPlaygroundIsDenseAndRight) {
  const Agreement found =
      Measure({"eth3d-playground/im0.png", "eth3d-playground/im1.png", "eth3d-playground/disp0.pfm",
               542.019, 541.836, 255.198, 0.0595549});
  EXPECT_GE(found.known_pct, 85.0);
  EXPECT_LE(found.off_by_two_px_pct, 0.5);
  EXPECT_LE(found.median_px, 0.2);
}

// Nothing is known of its cameras; the truth comes in quarters of a pixel.
TEST_F(DensePairs, OfConesIsDenseAndRight) {
  const Agreement found =
      Measure({"middlebury-cones/Cones_LEFT.tif", "middlebury-cones/Cones_RIGHT.tif",
               "middlebury-cones/gt_disp_left.tif", 935.0, 225.0, 187.0, 0.16});
  EXPECT_GE(found.known_pct, 80.0);
  EXPECT_LE(found.off_by_two_px_pct, 2.0);
  EXPECT_LE(found.median_px, 0.13);
}

}  // namespace
}  // namespace rigmap

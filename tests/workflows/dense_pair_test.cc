// Single pairs with dense truth, by `--depth-maps`; they lie beside the project, where RIGMAP_DATA
// says.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/file.h"
#include "core/statistics.h"
#include "export/ply_reader.h"
#include "export/tum.h"
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

  // Of what a run writes.
  Agreement Measure(const DensePair& pair) const {
    const cv::Mat truth_px = Truth(pair), depth = DepthOf(pair, truth_px.size());
    EXPECT_EQ(depth.size(), truth_px.size());
    EXPECT_EQ(depth.type(), CV_32FC1);
    return Compare(pair.focal_px * pair.baseline_m / depth, truth_px);
  }

  // Of OpenCV's matching over eight paths with rigmap's options, nothing refined.
  Agreement MeasureOpenCv(const DensePair& pair) const {
    constexpr int kBlock_px = 5, kSmallStep = 8, kLargeStep = 32, kGradientCap = 63;
    constexpr int kUniqueness_pct = 10, kSpeckleSize_px = 400;
    const cv::Mat truth_px = Truth(pair);
    double most = 0.0;
    cv::minMaxLoc(truth_px, nullptr, &most, nullptr, nullptr, truth_px < 1e4);
    const int disparities = 16 * static_cast<int>(std::ceil((most + 2.0) / 16.0));
    const auto matcher =
        cv::StereoSGBM::create(0, disparities, kBlock_px, kSmallStep * kBlock_px * kBlock_px,
                               kLargeStep * kBlock_px * kBlock_px, 1, kGradientCap, kUniqueness_pct,
                               kSpeckleSize_px, 1, cv::StereoSGBM::MODE_HH);
    cv::Mat sixteenths, disparity_px;
    matcher->compute(cv::imread(data_ / pair.left, cv::IMREAD_GRAYSCALE),
                     cv::imread(data_ / pair.right, cv::IMREAD_GRAYSCALE), sixteenths);
    sixteenths.convertTo(disparity_px, CV_32F, 1.0 / 16.0);
    disparity_px.setTo(std::numeric_limits<float>::quiet_NaN(), sixteenths < 0);
    return Compare(disparity_px, truth_px);
  }

  // Share of the truth's pixels with a point of dense.ply within two pixels.
  double ShownByPoints_pct(const DensePair& pair) const {
    const cv::Mat truth_px = Truth(pair);
    const Rigid3 left_from_world =
        ReadTum(folder_.Path() / "out" / "trajectory.tum").front().world_from_body.Inverse();
    cv::Mat shown = cv::Mat::zeros(truth_px.size(), CV_8U);
    PlyReader reader(folder_.Path() / "out" / "dense.ply");
    PointCloud block;
    while (reader.Read(block)) {
      for (const SurfacePoint& point : block) {
        const Eigen::Vector3d x = left_from_world * point.x_in_world.cast<double>();
        const cv::Point at(cvRound(pair.cx + pair.focal_px * x.x() / x.z()),
                           cvRound(pair.cy + pair.focal_px * x.y() / x.z()));
        if (cv::Rect({}, shown.size()).contains(at)) shown.at<std::uint8_t>(at) = 1;
      }
    }
    cv::dilate(shown, shown, cv::Mat::ones(5, 5, CV_8U));
    const cv::Mat known = (truth_px > 0.0F) & (truth_px < 1e4F);
    return 100.0 * cv::countNonZero(shown & known) / cv::countNonZero(known);
  }

 private:
  cv::Mat Truth(const DensePair& pair) const {
    return cv::imread(data_ / pair.disparities, cv::IMREAD_UNCHANGED);
  }

  static Agreement Compare(const cv::Mat& disparity_px, const cv::Mat& truth_px) {
    int known = 0, all = 0, off = 0;
    std::vector<double> errors_px;
    for (int row = 0; row < truth_px.rows; ++row) {
      for (int column = 0; column < truth_px.cols; ++column) {
        const float expected = truth_px.at<float>(row, column);
        const float found = disparity_px.at<float>(row, column);
        if (!std::isfinite(expected) || expected <= 0.0F) continue;
        ++all;
        if (!std::isfinite(found)) continue;
        ++known;
        errors_px.push_back(std::abs(found - expected));
        off += errors_px.back() > 2.0 ? 1 : 0;
      }
    }
    return {100.0 * known / all, 100.0 * off / known, Median(std::move(errors_px))};
  }

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
    const ProgramEnd end =
        RunRigmap({"part", "--dataset", dataset, "--out", out, "--depth-maps", "--quiet"});
    EXPECT_EQ(end.exit_code, 0) << end.err;
    return cv::imread(out / "depth_maps" / "0.tif", cv::IMREAD_UNCHANGED);
  }

  fs::path data_;
  TemporaryFolder folder_;
};

void Print(const char* who, const Agreement& found) {
  fmt::print("{}: {:.1f} % known, {:.2f} % of these off by more than 2 px, median {:.3f} px\n", who,
             found.known_pct, found.off_by_two_px_pct, found.median_px);
}

// In the lower quarter of this pair both views, laid on each other by the truth, differ by a third
// of a pixel: its median cannot be small.
TEST_F(DensePairs, OfAPlaygroundIsDenseAndRight) {
  const DensePair pair{"eth3d-playground/im0.png",
                       "eth3d-playground/im1.png",
                       "eth3d-playground/disp0.pfm",
                       542.019,
                       541.836,
                       255.198,
                       0.0595549};
  const Agreement found = Measure(pair), other = MeasureOpenCv(pair);
  Print("rigmap", found);
  Print("OpenCV", other);
  EXPECT_GE(found.known_pct, 85.0);
  EXPECT_LE(found.off_by_two_px_pct, 0.5);
  EXPECT_LE(found.median_px, 0.2);
  EXPECT_LE(found.off_by_two_px_pct, other.off_by_two_px_pct);
  EXPECT_LE(found.median_px, other.median_px);
  EXPECT_GE(ShownByPoints_pct(pair), 80.0);
}

// Nothing is known of its cameras; the truth comes in quarters of a pixel.
TEST_F(DensePairs, OfConesIsDenseAndRight) {
  const DensePair pair{"middlebury-cones/Cones_LEFT.tif",
                       "middlebury-cones/Cones_RIGHT.tif",
                       "middlebury-cones/gt_disp_left.tif",
                       935.0,
                       225.0,
                       187.0,
                       0.16};
  const Agreement found = Measure(pair), other = MeasureOpenCv(pair);
  Print("rigmap", found);
  Print("OpenCV", other);
  EXPECT_GE(found.known_pct, 80.0);
  EXPECT_LE(found.off_by_two_px_pct, 2.0);
  EXPECT_LE(found.median_px, 0.13);
  EXPECT_LE(found.off_by_two_px_pct, other.off_by_two_px_pct);
  EXPECT_LE(found.median_px, other.median_px + 0.005);
  EXPECT_GE(ShownByPoints_pct(pair), 80.0);
}

}  // namespace
}  // namespace rigmap

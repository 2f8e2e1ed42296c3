#include "fusion/view_consistency.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "fusion/disparity_normal.h"

namespace rigmap {
namespace {

struct Neighbour {
  const DepthMap* map;
  Rigid3 neighbour_from_reference;  // rectified axes of both
  Rigid3 reference_from_neighbour;
};

// Sums over the measurements that agree on one point.
struct Consensus {
  Eigen::Vector3d weighted_sum = Eigen::Vector3d::Zero();
  double weight = 0.0;
  int agreeing = 0, seeing_through = 0;
  double own_sigma_m = 0.0;   // of the reference's measurement
  double best_sigma_m = 0.0;  // of all that agree

  void Agree(const Eigen::Vector3d& x, double sigma_m) {
    weighted_sum += x / (sigma_m * sigma_m);
    weight += 1.0 / (sigma_m * sigma_m);
    best_sigma_m = std::min(best_sigma_m, sigma_m);
    ++agreeing;
  }
};

void Consult(const Neighbour& neighbour, const Eigen::Vector3d& x_in_reference,
             double agreement_sigmas, Consensus& consensus) {
  const DepthMap& map = *neighbour.map;
  const Eigen::Vector3d x = neighbour.neighbour_from_reference * x_in_reference;
  if (x.z() <= 0.0) return;
  const int column = static_cast<int>(std::lround(map.camera.fx * x.x() / x.z() + map.camera.cx));
  const int row = static_cast<int>(std::lround(map.camera.fy * x.y() / x.z() + map.camera.cy));
  if (column < 0 || row < 0 || column >= map.disparity.cols || row >= map.disparity.rows) return;
  const double found_px = map.disparity.at<float>(row, column);
  if (found_px <= 0.0) return;
  // Both depths are uncertain: compared where the sigma is known, in the neighbour's disparity.
  const double expected_px = map.camera.fx * map.baseline_m / x.z();
  const double sigma_px =
      std::hypot(map.disparity_sigma_px, expected_px / x.z() * consensus.own_sigma_m);
  const double difference_px = found_px - expected_px;
  if (std::abs(difference_px) <= agreement_sigmas * sigma_px) {
    consensus.Agree(
        neighbour.reference_from_neighbour * map.PointInRectified(column, row, found_px),
        map.DepthSigma(found_px));
  } else if (difference_px < 0.0) {
    ++consensus.seeing_through;
  }
}

std::optional<SurfaceSample> SampleAt(const DepthView& reference,
                                      std::span<const Neighbour> neighbours, cv::Point pixel,
                                      const FusionOptions& options) {
  const DepthMap& map = reference.map;
  const double disparity_px = map.disparity.at<float>(pixel);
  if (disparity_px <= 0.0) return std::nullopt;
  const double sigma_m = map.DepthSigma(disparity_px);
  const Eigen::Vector3d x = map.PointInRectified(pixel.x, pixel.y, disparity_px);
  Consensus consensus;
  consensus.own_sigma_m = consensus.best_sigma_m = sigma_m;
  consensus.Agree(x, sigma_m);
  for (const Neighbour& neighbour : neighbours) {
    Consult(neighbour, x, options.agreement_sigmas, consensus);
  }
  if (consensus.agreeing < options.min_views || consensus.seeing_through > consensus.agreeing ||
      consensus.best_sigma_m < options.better_view_share * sigma_m) {
    return std::nullopt;
  }
  SurfaceSample sample;
  sample.x_in_world = reference.world_from_rectified * (consensus.weighted_sum / consensus.weight);
  sample.normal =
      (reference.world_from_rectified.rotation * NormalInRectified(map, pixel.y, pixel.x))
          .cast<float>();
  const cv::Vec3b bgr = map.colour.at<cv::Vec3b>(pixel);
  sample.rgb = {bgr[2], bgr[1], bgr[0]};
  sample.sigma_m = static_cast<float>(1.0 / std::sqrt(consensus.weight));
  sample.observations = consensus.agreeing;
  return sample;
}

}  // namespace

std::vector<SurfaceSample> ConfirmedSamples(const DepthView& reference,
                                            std::span<const DepthView* const> neighbours,
                                            const FusionOptions& options) {
  std::vector<Neighbour> prepared;
  for (const DepthView* view : neighbours) {
    const Rigid3 neighbour_from_reference =
        view->world_from_rectified.Inverse() * reference.world_from_rectified;
    prepared.push_back({&view->map, neighbour_from_reference, neighbour_from_reference.Inverse()});
  }
  std::vector<std::vector<SurfaceSample>> rows(
      static_cast<std::size_t>(reference.map.disparity.rows));
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rows.size()), [&](const auto& range) {
    for (std::size_t row = range.begin(); row < range.end(); ++row) {
      for (int column = 0; column < reference.map.disparity.cols; ++column) {
        const auto sample = SampleAt(reference, prepared, {column, static_cast<int>(row)}, options);
        if (sample) rows[row].push_back(*sample);
      }
    }
  });
  std::vector<SurfaceSample> samples;
  for (const auto& row : rows) samples.insert(samples.end(), row.begin(), row.end());
  return samples;
}

}  // namespace rigmap

#include "fusion/internal/view_consistency.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/statistics.h"
#include "imaging/disparity_normal.h"

namespace rigmap {
namespace {

struct Neighbour {
  const DepthMap* map;
  Eigen::Isometry3d neighbour_from_reference;  // rectified axes of both
  Eigen::Isometry3d reference_from_neighbour;
};

// Every point is moved by it, which takes twice as long by a quaternion.
Eigen::Isometry3d MatrixOf(const Rigid3& motion) {
  return Eigen::Translation3d(motion.translation) * motion.rotation;
}

std::vector<Neighbour> Prepare(const DepthView& reference,
                               std::span<const DepthView* const> views) {
  std::vector<Neighbour> prepared;
  for (const DepthView* view : views) {
    const Rigid3 neighbour_from_reference =
        view->world_from_rectified.Inverse() * reference.world_from_rectified;
    prepared.push_back({&view->map, MatrixOf(neighbour_from_reference),
                        MatrixOf(neighbour_from_reference.Inverse())});
  }
  return prepared;
}

// A measurement of the reference, in its rectified axes.
struct Measurement {
  Eigen::Vector3d x;
  double sigma_m = 0.0;
};

// kKnowsNoDepth: where the point would be in its image.
enum class Verdict { kNone, kKnowsNoDepth, kAgrees, kSeesThrough, kSeesSomethingNearer };

struct Opinion {
  Verdict verdict = Verdict::kNone;
  bool is_better = false;  // sees the point from clearly nearer
  double nearness = 1.0;   // of what it sees there, over the point's
  Measurement own;         // of the neighbour, where it agrees
  cv::Point pixel;         // of the neighbour's view
};

// Whether the neighbour is clearly nearer to the point, z before it, than the reference: equal
// disparities have depth sigmas as the squares of the depths.
bool IsNearer(double z, const Measurement& point, const FusionOptions& options) {
  return z * z < options.better_view_share * point.x.z() * point.x.z();
}

Opinion Ask(const Neighbour& neighbour, const Measurement& point, const FusionOptions& options) {
  const DepthMap& map = *neighbour.map;
  const Eigen::Vector3d x = neighbour.neighbour_from_reference * point.x;
  const std::optional<cv::Point> pixel = map.PixelOf(x);
  if (!pixel) return {};
  const double found_px = map.disparity.at<float>(*pixel);
  if (found_px <= 0.0) return {.verdict = Verdict::kKnowsNoDepth};
  // Both depths are uncertain: compared where the sigma is known, in the neighbour's disparity.
  const double per_z = 1.0 / x.z();
  const double expected_px = map.camera.fx * map.baseline_m * per_z;
  const double found_sigma_px = map.disparity_sigma.at<float>(*pixel);
  const double expected_sigma_px = expected_px * per_z * point.sigma_m;
  const double variance_px2 =
      found_sigma_px * found_sigma_px + expected_sigma_px * expected_sigma_px;
  const double difference_px = found_px - expected_px;
  Opinion opinion{.is_better = IsNearer(x.z(), point, options), .nearness = found_px / expected_px};
  const double sigmas2 = options.agreement_sigmas * options.agreement_sigmas;
  if (difference_px * difference_px > sigmas2 * variance_px2) {
    opinion.verdict = difference_px < 0.0 ? Verdict::kSeesThrough : Verdict::kSeesSomethingNearer;
    return opinion;
  }
  opinion.verdict = Verdict::kAgrees;
  opinion.pixel = *pixel;
  opinion.own = {
      neighbour.reference_from_neighbour * map.PointInRectified(pixel->x, pixel->y, found_px),
      map.DepthSigma(found_px, found_sigma_px)};
  return opinion;
}

// Whether the point is another frame's to give, or to deny.
bool IsForABetterView(const Opinion& opinion) {
  return opinion.is_better &&
         (opinion.verdict == Verdict::kAgrees || opinion.verdict == Verdict::kSeesThrough);
}

bool IsForABetterView(const Neighbour& neighbour, const Measurement& point,
                      const FusionOptions& options) {
  // Most are no nearer, which their depth alone tells.
  const auto& motion = neighbour.neighbour_from_reference;
  const double z = motion.linear().row(2).dot(point.x) + motion.translation().z();
  return IsNearer(z, point, options) && IsForABetterView(Ask(neighbour, point, options));
}

// Sums over the measurements that agree on one point.
struct Consensus {
  Eigen::Vector3d weighted_sum = Eigen::Vector3d::Zero();
  double weight = 0.0;
  int agreeing = 0, seeing_through = 0, without_depth = 0;

  void Agree(const Measurement& measured) {
    const double weight_of_it = 1.0 / (measured.sigma_m * measured.sigma_m);
    weighted_sum += weight_of_it * measured.x;
    weight += weight_of_it;
    ++agreeing;
  }

  // Two agree by chance, or on what was there for a moment: who walked by stands against the sky,
  // of which others know no depth. Four of these count as one that sees through.
  bool Holds(int min_views) const {
    return agreeing >= min_views && 4 * seeing_through + without_depth < 2 * agreeing;
  }
};

struct Views {
  std::vector<Neighbour> near, ahead;
  double least_cosine = 0.0;  // of the incidence
};

// Nothing where the neighbours do not confirm the measurement, or have a better one.
std::optional<Consensus> Confirm(const Measurement& measured, const Views& views,
                                 const FusionOptions& options) {
  for (const Neighbour& view : views.ahead) {
    if (IsForABetterView(view, measured, options)) return std::nullopt;
  }
  Consensus consensus;
  consensus.Agree(measured);
  for (const Neighbour& view : views.near) {
    const Opinion opinion = Ask(view, measured, options);
    if (IsForABetterView(opinion)) return std::nullopt;
    if (opinion.verdict == Verdict::kAgrees) consensus.Agree(opinion.own);
    if (opinion.verdict == Verdict::kSeesThrough) ++consensus.seeing_through;
    if (opinion.verdict == Verdict::kKnowsNoDepth) ++consensus.without_depth;
  }
  return consensus.Holds(options.min_views) ? std::optional(consensus) : std::nullopt;
}

// Nothing where the disparity is unknown.
std::optional<Measurement> MeasurementAt(const DepthMap& map, cv::Point pixel) {
  const double disparity_px = map.disparity.at<float>(pixel);
  if (disparity_px <= 0.0) return std::nullopt;
  return Measurement{map.PointInRectified(pixel.x, pixel.y, disparity_px),
                     map.DepthSigma(disparity_px, map.disparity_sigma.at<float>(pixel))};
}

// By how much a mean over so many views is less sure than the smallest of sigmas would have it. Of
// what smoothing takes off a surface, views from other places, with other pixels, have half in
// common (docs/measured.md, "Sigmas of points").
double SharedFactor(const DepthMap& map, cv::Point pixel, int views) {
  constexpr double kShared = 0.5;
  if (map.smoothed_pct.empty()) return 1.0;
  const double smoothed = 0.01 * map.smoothed_pct.at<std::uint8_t>(pixel);
  return std::sqrt(1.0 + kShared * smoothed * (views - 1));
}

std::optional<SurfaceSample> SampleAt(const DepthView& reference, const Views& views,
                                      cv::Point pixel, const FusionOptions& options) {
  const DepthMap& map = reference.map;
  const auto measured = MeasurementAt(map, pixel);
  if (!measured) return std::nullopt;
  const auto consensus = Confirm(*measured, views, options);
  if (!consensus) return std::nullopt;
  const Eigen::Vector3d normal = NormalInRectified(map, pixel.y, pixel.x);
  const Eigen::Vector3d x = consensus->weighted_sum / consensus->weight;
  SurfaceSample sample;
  sample.sigma_m = static_cast<float>(1.0 / std::sqrt(consensus->weight));
  if (sample.sigma_m > 0.01 * options.max_sigma_pct * x.norm()) return std::nullopt;
  const double cosine = -normal.dot(x.normalized());
  if (cosine < views.least_cosine && !LiesOnPlane(map, pixel.y, pixel.x)) return std::nullopt;
  // A pixel covers more of a surface seen edge on, in one direction.
  sample.pixel_m = static_cast<float>(x.z() / map.camera.fx / std::sqrt(std::max(cosine, 0.01)));
  sample.cosine = static_cast<float>(std::max(cosine, 0.0));
  sample.shared = static_cast<float>(SharedFactor(map, pixel, consensus->agreeing));
  sample.x_in_world = reference.world_from_rectified * x;
  sample.normal = (reference.world_from_rectified.rotation * normal).cast<float>();
  const cv::Vec3b bgr = map.colour.at<cv::Vec3b>(pixel);
  sample.rgb = {bgr[2], bgr[1], bgr[0]};
  sample.observations = consensus->agreeing;
  return sample;
}

}  // namespace

std::vector<SurfaceSample> ConfirmedSamples(const DepthView& reference,
                                            const ComparedViews& compared,
                                            const FusionOptions& options, const cv::Range& rows) {
  const double least_cosine = std::cos(options.max_incidence_deg * std::numbers::pi / 180.0);
  const Views views{Prepare(reference, compared.near), Prepare(reference, compared.ahead),
                    least_cosine};
  const cv::Range all(0, reference.map.disparity.rows);
  const cv::Range asked = rows == cv::Range::all() ? all : rows & all;
  std::vector<std::vector<SurfaceSample>> by_row(static_cast<std::size_t>(asked.size()));
  tbb::parallel_for(tbb::blocked_range<int>(asked.start, asked.end), [&](const auto& range) {
    for (int row = range.begin(); row < range.end(); ++row) {
      for (int column = 0; column < reference.map.disparity.cols; ++column) {
        const auto sample = SampleAt(reference, views, {column, row}, options);
        if (sample) by_row[row - asked.start].push_back(*sample);
      }
    }
  });
  std::vector<SurfaceSample> samples;
  for (const auto& row : by_row) samples.insert(samples.end(), row.begin(), row.end());
  return samples;
}

std::optional<ViewAgreement> AgreementOf(const DepthView& first, const DepthView& second,
                                         const FusionOptions& options) {
  constexpr double kDark = 3.0 * 16.0;  // ratios of less are made of black levels
  const DepthView* const others[] = {&second};
  const Neighbour neighbour = Prepare(first, others).front();
  const auto grey = [](const DepthMap& map, cv::Point pixel) {
    const cv::Vec3b& bgr = map.colour.at<cv::Vec3b>(pixel);
    return static_cast<double>(bgr[0]) + bgr[1] + bgr[2];
  };
  int shared = 0;
  int agreeing = 0;
  std::vector<double> ratios;
  for (int row = 0; row < first.map.disparity.rows; row += kOpinionStride) {
    for (int column = 0; column < first.map.disparity.cols; column += kOpinionStride) {
      const auto measured = MeasurementAt(first.map, {column, row});
      if (!measured) continue;
      const Opinion opinion = Ask(neighbour, *measured, options);
      if (opinion.verdict == Verdict::kNone || opinion.verdict == Verdict::kKnowsNoDepth) continue;
      ++shared;
      if (opinion.verdict != Verdict::kAgrees) continue;
      ++agreeing;
      const double own = grey(first.map, {column, row}), other = grey(second.map, opinion.pixel);
      if (own > kDark && other > kDark) ratios.push_back(other / own);
    }
  }
  if (shared < kMinSharedPixels) return std::nullopt;
  const double share = static_cast<double>(agreeing) / shared;
  return ViewAgreement{share, ratios.empty() ? 1.0 : Median(std::move(ratios))};
}

cv::Mat OpinionsOn(const DepthView& first, const DepthView& second, const FusionOptions& options) {
  constexpr double kClearlyFurther = 6.0 / 7.0;  // nearness: depth is 1 / nearness
  const DepthView* const others[] = {&second};
  const Neighbour neighbour = Prepare(first, others).front();
  const cv::Size size = first.map.disparity.size();
  cv::Mat opinions((size.height + kOpinionStride - 1) / kOpinionStride,
                   (size.width + kOpinionStride - 1) / kOpinionStride, CV_8UC1, cv::Scalar(0));
  for (int row = 0; row < opinions.rows; ++row) {
    for (int column = 0; column < opinions.cols; ++column) {
      const auto measured =
          MeasurementAt(first.map, {column * kOpinionStride, row * kOpinionStride});
      if (!measured) continue;
      const Opinion opinion = Ask(neighbour, *measured, options);
      const bool is_through =
          opinion.verdict == Verdict::kSeesThrough && opinion.nearness < kClearlyFurther;
      if (opinion.verdict == Verdict::kAgrees) opinions.at<std::uint8_t>(row, column) = kSeenAsHere;
      if (is_through) opinions.at<std::uint8_t>(row, column) = kSeenClearlyThrough;
    }
  }
  return opinions;
}

}  // namespace rigmap

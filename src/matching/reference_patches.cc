#include "matching/reference_patches.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace rigmap {
namespace {

GreyView View(const Patch& patch) { return {patch.data(), kPatchSize, kPatchSize, kPatchSize}; }

Eigen::Vector2d OffsetInPatch(const Eigen::Vector2d& pixel) {
  return pixel - Eigen::Vector2d(std::round(pixel.x()), std::round(pixel.y()));
}

const Eigen::Vector2i kPatchCentre(kPatchRadius, kPatchRadius);

// A window no larger than what is sure to stay within the later view's patch as it grows and
// shifts; and narrower where depths change much from column to column, or lower where they do from
// row to row: there ground that is no plane draws it aside.
PatchAlignmentOptions WindowFor(const PatchWarp& start, const Eigen::Array2d& depth_change) {
  // From the middle to the edge. Ground that grows by a quarter bends by a quarter of that over
  // half a window; where the bend is left out, or is another, a window 3 px high is drawn by 0.01
  // px.
  constexpr double kMaxDepthChange = 0.05;
  constexpr double kLeast_px = 3.0;
  PatchAlignmentOptions options;
  options.max_shift_px = 2.0;
  const double growth = start.linear.cwiseAbs().rowwise().sum().maxCoeff();
  const double room_px = (kPatchRadius - options.max_shift_px) / growth;
  const auto limit = [&](double change, int& half_px) {
    const double flat_px = std::max(kLeast_px, kMaxDepthChange / std::max(change, 1e-9));
    half_px = static_cast<int>(std::min({static_cast<double>(half_px), room_px, flat_px}));
  };
  limit(depth_change.x(), options.half_width_px);
  limit(depth_change.y(), options.half_height_px);
  return options;
}

}  // namespace

FeatureRefinement StartRefinement(FrameFeatures features) {
  FeatureRefinement frame;
  frame.refined = features.features;
  frame.aligned.assign(features.features.size(), false);
  for (std::size_t i = 0; i < features.features.size(); ++i) {
    frame.references.push_back({features.patches[i], OffsetInPatch(features.features[i].left)});
  }
  frame.found = std::move(features);
  return frame;
}

void RestorePositions(const std::vector<Feature>& refined, const std::vector<char>& aligned,
                      FeatureRefinement& frame) {
  frame.refined = refined;
  frame.aligned = aligned;
  for (std::size_t i = frame.found.features.size(); i < refined.size(); ++i) {
    frame.found.features.push_back(refined[i]);
    frame.found.patches.emplace_back();
    frame.references.emplace_back();
  }
  for (std::size_t i = 0; i < refined.size(); ++i) {
    const Eigen::Vector2d& found = frame.found.features[i].left;
    frame.references[i].offset = refined[i].left - (found - OffsetInPatch(found));
  }
}

std::size_t TakeOver(const FeatureRefinement& from, int index, FeatureRefinement& to) {
  to.found.features.push_back(from.found.features[index]);
  to.found.patches.push_back(from.found.patches[index]);
  to.refined.push_back(from.refined[index]);
  to.references.push_back(from.references[index]);
  to.aligned.push_back(from.aligned[index]);
  return to.refined.size() - 1;
}

bool AlignWithReference(const FeatureRefinement& earlier, int a, FeatureRefinement& later, int b,
                        const ExpectedView& expected, const MatchingOptions& options) {
  const ReferencePatch& reference = earlier.references[a];
  const Eigen::Vector2d found = later.found.features[b].left;
  const Eigen::Vector2d patch_origin = found - OffsetInPatch(found) - kPatchCentre.cast<double>();
  PatchWarp start;
  start.linear = expected.later_from_earlier * reference.frame_from_patch;
  start.bend = expected.bend;
  start.position = found - patch_origin - start.linear * reference.offset;
  const auto result = AlignPatch(View(reference.patch), kPatchCentre, View(later.found.patches[b]),
                                 start, WindowFor(start, expected.depth_change));
  if (!result || result->correlation < options.min_correlation ||
      result->sigma_px > options.max_position_sigma_px) {
    return false;
  }
  const Eigen::Vector2d moved = patch_origin + result->warp * reference.offset;
  Feature& refined = later.refined[b];
  if (refined.right)
    *refined.right += refined.right_from_left.cast<double>() * (moved - refined.left);
  refined.left = moved;
  later.aligned[b] = true;
  const double growth = std::sqrt(std::abs(result->warp.linear.determinant()));
  constexpr double kMaxGrowth = 1.5;
  if (growth < kMaxGrowth && growth > 1.0 / kMaxGrowth) {
    later.references[b] = {reference.patch, reference.offset, result->warp.linear,
                           reference.ground};
  } else {
    // The patch of this view, around the refined position, serves those to come.
    later.references[b] = {later.found.patches[b],
                           moved - patch_origin - kPatchCentre.cast<double>()};
  }
  return true;
}

}  // namespace rigmap

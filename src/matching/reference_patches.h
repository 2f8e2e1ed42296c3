// Positions of features, refined so that all features of a track mean the same point.
#pragma once

#include <optional>
#include <vector>

#include "correspondence/ground_warp.h"
#include "correspondence/patch_alignment.h"
#include "matching/matching_options.h"
#include "scene/features.h"

namespace rigmap {

// The view of a ground point that its later views are aligned with: a grey patch, and the warp from
// it to the frame that holds it now.
struct ReferencePatch {
  Patch patch{};
  Eigen::Vector2d offset = Eigen::Vector2d::Zero();  // of the point from the patch's centre
  Eigen::Matrix2d frame_from_patch = Eigen::Matrix2d::Identity();
  std::optional<GroundPatch> ground;  // that the patch shows, where it has been asked for
};

// How a later frame is expected to see a reference patch.
struct ExpectedView {
  Eigen::Matrix2d later_from_earlier = Eigen::Matrix2d::Identity();  // turned, stretched, grown
  Eigen::Matrix<double, 2, 3> bend =
      Eigen::Matrix<double, 2, 3>::Zero();               // of its patch, PatchWarp
  Eigen::Array2d depth_change = Eigen::Array2d::Zero();  // DepthChange, of its ground
};

// Reference patches and current positions of one frame's features.
struct FeatureRefinement {
  FrameFeatures found;                     // as extracted
  std::vector<Feature> refined;            // the same features where they were moved to
  std::vector<ReferencePatch> references;  // one per feature; at first its own patch
  // True once a feature took an earlier view's reference patch. Bytes, so that tasks can set their
  // own.
  std::vector<char> aligned;
};

FeatureRefinement StartRefinement(FrameFeatures features);

// Puts features back to where they had been moved; each one's own patch, around its refined
// position, becomes its reference patch. Features that had been carried here come back without a
// patch: nothing is aligned with them any more.
void RestorePositions(const std::vector<Feature>& refined, const std::vector<char>& aligned,
                      FeatureRefinement& frame);

// Makes feature `index` of one refinement a feature of another of the same frame, without a
// descriptor; its index there.
std::size_t TakeOver(const FeatureRefinement& from, int index, FeatureRefinement& to);

// Aligns feature b of `later` with the reference patch of feature a of `earlier` and moves it
// there, its stereo match along with it; the reference patch is handed on, or made anew where the
// view has changed by more than half in size. False, with nothing changed, where the patches do not
// agree.
bool AlignWithReference(const FeatureRefinement& earlier, int a, FeatureRefinement& later, int b,
                        const ExpectedView& expected, const MatchingOptions& options);

}  // namespace rigmap

// Where another patch shows the point of a patch, as long as that is known to some pixels.
#pragma once

#include <optional>

#include "scene/features.h"

namespace rigmap {

// How a patch shows its point, and how it will look from where it is searched.
struct SearchedPatch {
  const Patch& patch;
  Eigen::Vector2d offset = Eigen::Vector2d::Zero();  // px, of the point from the patch's centre
  Eigen::Matrix2d searched_from_patch = Eigen::Matrix2d::Identity();  // turned, stretched, grown
};

// How far from its centre a patch is searched, px.
inline constexpr int kPatchReach = 8;

// The point's offset from the centre of `in`, px: where a window of 13 x 13 px correlates best.
// Nothing where it does so nowhere, or elsewhere about as well: with a correlation of a half and
// another of 0.05 less a spot is the right one more often than not, for the search of a motion.
std::optional<Eigen::Vector2d> FindInPatch(const SearchedPatch& searched, const Patch& in);

}  // namespace rigmap

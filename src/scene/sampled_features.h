// Features at pixels that somebody asks for, rather than where keypoints were found.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "scene/features.h"

namespace rigmap {

struct SampledFeature {
  Feature feature;
  Patch patch{};
};

// Gives frame i's features at these pixels of its left image, one entry each, nothing where the
// image is masked; no entries where the frame's images cannot be had.
using FeatureSampler = std::function<std::vector<std::optional<SampledFeature>>(
    int frame, const std::vector<Eigen::Vector2d>& pixels)>;

}  // namespace rigmap

// Which features of two frames look alike.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "scene/features.h"

namespace rigmap {

struct FeatureMatch {
  int a = 0, b = 0;  // indices of features
};

struct FeatureMatchOptions {
  // Largest ratio of the best to the second best descriptor distance (Lowe 2004).
  double max_ratio = 0.85;
  // Largest Euclidean distance of two descriptors; OpenCV scales them to a norm of about 512.
  double max_distance = 320.0;
};

// Every feature of a against every feature of b: mutual best, past the ratio test. Cost: the
// product of their numbers, about 25 ns each.
std::vector<FeatureMatch> MatchFeatures(const FrameFeatures& a, const FrameFeatures& b,
                                        const FeatureMatchOptions& options);

// As above, where each feature is compared only with those of its own group (one number, 0 or more,
// per feature). Many small groups cost as much less.
std::vector<FeatureMatch> MatchFeatures(const FrameFeatures& a, const FrameFeatures& b,
                                        std::span<const int> groups_of_a,
                                        std::span<const int> groups_of_b,
                                        const FeatureMatchOptions& options);

// As above, where each feature of a is looked for only within radius_px of its predicted left
// pixel in b; those without a prediction are left out.
std::vector<FeatureMatch> MatchFeatures(
    const FrameFeatures& a, const FrameFeatures& b,
    std::span<const std::optional<Eigen::Vector2d>> predicted_in_b, double radius_px,
    const FeatureMatchOptions& options);

// The features of both frames that were followed from one to the other, in the order of a.
std::vector<FeatureMatch> MatchTracks(const FrameFeatures& a, const FrameFeatures& b);

}  // namespace rigmap

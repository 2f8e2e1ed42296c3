// What neighbouring depth maps say about the points of one.
#pragma once

#include <optional>
#include <vector>

#include "fusion/fusion_options.h"
#include "fusion/internal/voxel_grid.h"
#include "imaging/depth_map.h"

namespace rigmap {

struct DepthView {
  DepthMap map;
  Rigid3 world_from_rectified;
};

struct ComparedViews {
  std::vector<const DepthView*> near;   // confirm and are averaged with
  std::vector<const DepthView*> ahead;  // may only deny, or have the point for themselves
};

// The points of `reference` that enough near views confirm, each the mean of all agreeing
// measurements weighed by 1 / sigma^2. Left out:
// - points on which fewer than min_views frames agree, or that half as many near views or more see
//   through (they see something clearly behind it); four that would show the point and know no
//   depth there count as one of these;
// - points that any view looks at from clearly nearer (better_view_share): if it agrees, it gives
//   them itself; if it sees through them, it knows better;
// - points seen too edge on (max_incidence_deg) where no surface goes on around them;
// - points known less well than max_sigma_pct of their distance.
// Of these rows of the reference, ordered by row and column. Uses all threads; the result does not
// depend on their number.
std::vector<SurfaceSample> ConfirmedSamples(const DepthView& reference,
                                            const ComparedViews& compared,
                                            const FusionOptions& options,
                                            const cv::Range& rows = cv::Range::all());

// How two views go together, by every eighth column and row of the first.
struct ViewAgreement {
  double share = 0.0;  // of the pixels known in both, on which they agree
  // Median of the second's grey value over the first's, where they agree and neither is dark.
  double brightness = 1.0;
};

// Nothing with fewer than kMinSharedPixels known in both.
inline constexpr int kMinSharedPixels = 100;
std::optional<ViewAgreement> AgreementOf(const DepthView& first, const DepthView& second,
                                         const FusionOptions& options);

// What the second view says of every eighth column and row of the first: CV_8UC1, a pixel each.
inline constexpr int kOpinionStride = 8;
inline constexpr int kSeenAsHere = 1;
inline constexpr int kSeenClearlyThrough = 2;  // what it sees there is further by a sixth or more
cv::Mat OpinionsOn(const DepthView& first, const DepthView& second, const FusionOptions& options);

}  // namespace rigmap

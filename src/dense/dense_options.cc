#include "dense/dense_options.h"

#include <string>

#include "dense/internal/matching_cost.h"

namespace rigmap {

OptionFields DenseOptions::Fields() {
  const OptionFields matching = {
      {"method",
       ChoiceOf(&method),
       "",
       {},
       "sgm: semi-global matching over eight paths (Hirschmüller 2008); with five, disparities on "
       "sand are off by up to 0.2 px. bm: OpenCV's block matching, about as fast, with holes."},
      {"block_px", &block_px, "px", AtLeast(1).Odd(),
       "Side of the window that a matching cost is summed over. With 7 twice as many false matches "
       "are left on sand, with 3 more noise. For bm at least 5, for sgm at most 17."},
      {"small_step_cost", &small_step_cost, "per pixel of the window", MoreThan(0.0),
       "Cost of a disparity step of one pixel. From OpenCV's sample for stereo matching."},
      {"large_step_cost", &large_step_cost, "per pixel of the window", MoreThan(0.0),
       "Cost of a disparity step of more than one pixel; above small_step_cost. From OpenCV's "
       "sample for stereo matching."},
      {"uniqueness_pct", &uniqueness_pct, "per cent", AtLeast(0).UpTo(100),
       "By how much the best cost must beat the second best elsewhere. With 5, 0.4 to 0.6 % of "
       "disparities on sand are wrong by more than 1.5 px, with 10 a tenth of that, and 0.4 % "
       "fewer are known."},
  };
  const OptionFields filters = {
      {"left_right_px", &left_right_px, "px", AtLeast(0),
       "By how much disparities seen from left and from right may differ."},
      {"speckle_size_px", &speckle_size_px, "px", AtLeast(0),
       "Connected patches of fewer pixels are dropped. False matches on weak texture reach a few "
       "hundred; real things hang together with the ground they stand on."},
      {"speckle_step_px", &speckle_step_px, "px", AtLeast(1),
       "Neighbours whose disparities differ by no more are connected."},
      {"refinement_px", &refinement_px, "px", AtLeast(3).UpTo(51).Odd(),
       "Side of the window in which both views are brought to agree below the pixel."},
      {"smoothing_px", &smoothing_px, "px", AtLeast(1).UpTo(51).Odd(),
       "Side of the window in which disparities of one surface are averaged (1: not at all)."},
      {"keep_bends",
       &keep_bends,
       "",
       {},
       "Whether bends are kept where depth is known to less than that window is wide. A map of "
       "nine frames is truer by it, a single depth map noisier by a seventh. Clouds that are "
       "chained frame by frame never do."},
      {"refined_sigma_factor", &refined_sigma_factor, "", MoreThan(0.0),
       "The sigma that comes with the refinement is multiplied with this: neighbours share the "
       "noise of resampled views. Against true depths 1.6 to 2.3."},
      {"least_sigma_px", &least_sigma_px, "px", MoreThan(0.0),
       "Least sigma of a refined disparity. Measured against true depths."},
  };
  const OptionFields range = {
      {"min_depth_m", &min_depth_m, "m", AtLeast(0.0),
       "Nearest depth that is searched. 0: half of what the nearest sparse points of the part "
       "have, but no nearer than where a disparity is half the width of the image."},
      {"max_range_m", &max_range_m, "m", AtLeast(0.0),
       "Largest depth, beyond min_depth_m. 0: no limit but that of max_depth_sigma_pct."},
      {"max_depth_sigma_pct", &max_depth_sigma_pct, "per cent of the depth", MoreThan(0.0),
       "Pixels whose own sigma is larger are left out of the depth maps: beyond, the errors of a "
       "depth are no longer symmetric."},
  };
  return JoinFields({matching, filters, range});
}

void DenseOptions::RequireRelations() const {
  RequireOption(method != DenseMethod::kBm || block_px >= 5, "dense.block_px",
                "at least 5 for method bm", block_px);
  RequireOption(
      method != DenseMethod::kSgm || block_px <= CostScale::kLargestBlock, "dense.block_px",
      "at most " + std::to_string(CostScale::kLargestBlock) + " for method sgm", block_px);
  RequireOption(large_step_cost > small_step_cost, "dense.large_step_cost",
                "more than dense.small_step_cost", large_step_cost);
  RequireOption(max_range_m == 0.0 || max_range_m > min_depth_m, "dense.max_range_m",
                "0 or more than dense.min_depth_m", max_range_m);
}

}  // namespace rigmap

#include "features/feature_options.h"

namespace rigmap {

OptionFields FeatureOptions::Fields() {
  return {
      {"max_keypoints", &max_keypoints, "", AtLeast(50).UpTo(50000),
       "Keypoints kept per left image, spread evenly. On sand 1500 leave some 600 matches to the "
       "next frame, five times what a pose needs; more cost time in every stage after."},
      {"half_resolution_above_mpx", &half_resolution_above_mpx, "megapixels", AtLeast(0.0),
       "Larger images are searched for keypoints at half resolution, in a quarter of the time. "
       "Positions are refined at full resolution either way."},
      {"contrast_threshold", &contrast_threshold, "share of full range", AtLeast(0.0).Below(0.5),
       "SIFT's threshold on contrast. Low, because on sand keypoints all over the image matter "
       "more than strong ones."},
      {"faint_contrast_threshold", &faint_contrast_threshold, "share of full range",
       AtLeast(0.0).Below(0.5),
       "The contrast threshold where an image has fewer than max_keypoints with the first. Half a "
       "grey level, below which there is only rounding. Dull flat sand then gives six times as "
       "many. Such a faint one counts only where the other eye shows it, too."},
      {"min_depth_baselines", &min_depth_baselines, "baselines", AtLeast(1.0),
       "Nearest depth that is searched for stereo matches. At 5 the two views of a patch differ "
       "by 11 degrees."},
      {"epipolar_band_px", &epipolar_band_px, "px", AtLeast(0.0).UpTo(20.0),
       "Half height of the band around the epipolar line that is searched. Wide on purpose: a rig "
       "whose rows are off shall show in the gate epipolar_px, not starve the stage of matches."},
      {"min_correlation", &min_correlation, "", MoreThan(0.0).Below(1.0),
       "Normalised correlation that a stereo match must reach."},
      {"min_uniqueness", &min_uniqueness, "", AtLeast(0.0).Below(1.0),
       "By how much the correlation of a stereo match must beat that of the second best position "
       "on the line."},
      {"max_epipolar_sigmas", &max_epipolar_sigmas, "robust sigmas", MoreThan(0.0),
       "Stereo matches further from the epipolar line than this, in sigmas of the frame's own "
       "epipolar "
       "errors, and further than 0.5 px, are dropped."},
  };
}

}  // namespace rigmap

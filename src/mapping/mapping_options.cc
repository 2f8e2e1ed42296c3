#include "mapping/mapping_options.h"

namespace rigmap {

OptionFields KeyframeGraphOptions::Fields() {
  return {
      {"tracks_per_keyframe", &tracks_per_keyframe, "", AtLeast(50),
       "Tracks per keyframe that COLMAP gets, the longest first. Its time is linear in them; the "
       "adjustment uses all tracks whatever this says."},
  };
}

OptionFields MappingOptions::Fields() {
  return {
      {"method",
       ChoiceOf(&method),
       "",
       {},
       "seeded: COLMAP starts from metric keyframes of the odometry and forgives errors of the "
       "rest. triangulate: takes all poses from the odometry. unseeded: stock COLMAP, for "
       "comparison only; it maps flat sand wrongly and says nothing. none: the odometry goes "
       "straight into the adjustment."},
      {"seed_keyframes", &seed_keyframes, "", AtLeast(2).UpTo(50),
       "Keyframes in a seed. 2, 4 and 8 do equally well; four survive one bad step."},
      {"min_model_keyframes", &min_model_keyframes, "", AtLeast(2),
       "Where COLMAP left so many keyframes in a row, another model is seeded."},
      {"max_models", &max_models, "", AtLeast(1),
       "Most models that are seeded; each costs a run of COLMAP."},
      {"random_seed", &random_seed, "", AtLeast(0),
       "Of COLMAP's sampling: equal seeds give equal models. Others show how much is chance."},
  };
}

}  // namespace rigmap

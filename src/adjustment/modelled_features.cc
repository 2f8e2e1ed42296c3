#include "adjustment/modelled_features.h"

#include <utility>

#include "adjustment/calibration.h"

namespace rigmap {

FeatureSource AsModelled(FeatureSource features, const Adjustment& adjustment) {
  return [features = std::move(features), &adjustment](int frame) {
    const StereoRig& rig = adjustment.rig;
    FrameFeatures moved = features(frame);
    for (Feature& feature : moved.features) {
      if (rig.left.lens_field) feature.left += rig.left.lens_field->At(feature.left);
      if (!feature.right) continue;
      Eigen::Vector2d right = *feature.right;
      if (!adjustment.right_turns.empty()) {
        right = Steadied(rig.right.camera, adjustment.right_turns[frame], right);
      }
      if (rig.right.lens_field) right += rig.right.lens_field->At(right);
      feature.right = right;
    }
    return moved;
  };
}

bool IsBesideModel(const Adjustment& adjustment) {
  return adjustment.rig.left.lens_field || adjustment.rig.right.lens_field ||
         !adjustment.right_turns.empty();
}

}  // namespace rigmap

#include "workflows/stages/feature_sampler.h"

#include <filesystem>
#include <memory>
#include <optional>

#include "features/extract_features.h"

namespace rigmap {

bool HasImages(const StereoFrame& frame) {
  return std::filesystem::exists(frame.left_path) && std::filesystem::exists(frame.right_path);
}

FeatureSampler SamplerOf(const Dataset& dataset, const StereoRig& rig,
                         const RigFixedCells& rig_fixed, const FeatureOptions& options,
                         const MaskOptions& masks) {
  // Made when it is first asked, which few drives do: it reads the mask files.
  auto setup = std::make_shared<std::optional<FeatureSetup>>();
  return [&dataset, &rig, &rig_fixed, &options, &masks, setup](
             int frame, const std::vector<Eigen::Vector2d>& pixels) {
    std::vector<std::optional<SampledFeature>> sampled;
    if (!HasImages(dataset.frames[frame])) return sampled;
    if (!*setup) *setup = MakeFeatureSetup(rig, options, masks);
    sampled = SampleFeatures(dataset.frames[frame], pixels, **setup);
    for (auto& feature : sampled) {
      if (feature && rig_fixed.Cover(feature->feature.left)) feature.reset();
    }
    return sampled;
  };
}

}  // namespace rigmap

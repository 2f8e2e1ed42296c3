// Features as a rig would have seen them that is no more than its model.
#pragma once

#include "scene/adjustment.h"
#include "scene/features.h"

namespace rigmap {

// With pixels moved to where the lens model has them and a stiff rig would have seen them, as those
// of the adjustment's observations are: by its field of the lenses and by the turns of the right
// eye. Patches and descriptors are those of the images. `adjustment` must outlive it.
FeatureSource AsModelled(FeatureSource features, const Adjustment& adjustment);
// False where that moves no pixel.
bool IsBesideModel(const Adjustment& adjustment);

}  // namespace rigmap

// The stereo folder, rigmap's own plain form of a data set:
//   left/ right/           images (image_file.h), as many in one as in the other, sorted by name
//   times.txt              seconds, one per pair, strictly increasing; lines with # are skipped
//   groundtruth_tum.txt    optional: t tx ty tz qx qy qz qw, world_from_left
//   groundtruth_xy.txt     optional, where there is no such file: t x y of a prism on the rover
// and a rig file (rig_file.h), calib.yaml or rig.yaml.
#pragma once

#include <filesystem>

#include "scene/dataset.h"

namespace rigmap {

// True if `folder` has left/, right/ or times.txt.
bool IsStereoFolder(const std::filesystem::path& folder);

// Frames, truth path and health; the rig is left open. `folder` must be absolute. Throws DataError
// naming the counts when an eye has no images or more than the other, or the line of times.txt that
// is no number or does not increase. Damaged images (IsWholeImage) are named in
// health.unreadable_images, their pairs kept. Pairs whose names hold different numbers are remarked
// on.
Dataset ReadStereoFolder(const std::filesystem::path& folder);

}  // namespace rigmap

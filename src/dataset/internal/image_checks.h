// What the images of a data set are, beside what its rig file says. Of this room only.
#pragma once

#include <vector>

#include "scene/dataset.h"

namespace rigmap {

// Of the masks and all images that can be read; there must be a pair. Images of another size are
// another camera's: better said before the first hour than after it. Throws DataError.
void CheckSizes(const Dataset& dataset);

// Leaves out pairs of which an image is that of the pair before byte for byte, with a remark. No
// two exposures of a camera are: it hung, and where it drove it would be seen standing still. Pairs
// whose own two images are the same bytes stay: such are black. Throws DataError where one eye
// alone hung in more than half of the pairs.
void LeaveOutRepeats(Dataset& dataset);

// How many bits the values of the part's files of 16 bit have. One frame may be dark, so all are
// asked, until one needs all 16.
void DecideSampleBits(const StereoRig& rig, std::vector<StereoFrame>& frames);

}  // namespace rigmap

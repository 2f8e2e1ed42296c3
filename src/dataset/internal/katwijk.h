// The Katwijk beach data set as it lies on disk:
//   <root>/Traverse<T>/Part<P>/LocCam/LocCam_<stamp>_{0,1}.<ext>     0 is the left eye
//   <root>/Traverse<T>/Part<P>/imu.txt                               see inclinometer.h
// The Traverse<T> level may be missing. Stamps: core/stamp.h.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "scene/dataset.h"

namespace rigmap {

// A part that has a LocCam folder. The numbers are those of the folder names, where they are so
// named.
struct KatwijkPart {
  std::filesystem::path folder;
  std::optional<int> traverse, part;
};

// The parts in `folder`, which may be a data set's root, a traverse or a part itself; sorted by
// number. Empty: this is no Katwijk folder. `folder` must be absolute.
std::vector<KatwijkPart> FindKatwijkParts(const std::filesystem::path& folder);

// The one part of `folder` with these numbers; a number may be left out where the other tells it,
// and one that the folder names do not tell is taken as given. Throws UsageError listing what is
// there when no part or several fit.
KatwijkPart SelectKatwijkPart(const std::filesystem::path& folder, std::optional<int> traverse,
                              std::optional<int> part);

// The same with as many parts of one traverse as fit. Throws UsageError, too, where parts of
// several traverses do.
std::vector<KatwijkPart> KatwijkPartsThatFit(const std::filesystem::path& folder,
                                             std::optional<int> traverse, std::optional<int> part);

// Frames and health of a part; the rig is left open. Frames are sorted by parsed stamp and paired
// by it. Images without a partner or with a stamp that cannot be read go to health.lone_images;
// damaged ones (IsWholeImage) are named in health.unreadable_images, but paired like any other.
// Where several images of an eye have the same stamp, one is kept, a whole one if there is one, and
// a remark made. Throws DataError with the counts if no pair is left.
Dataset ReadKatwijkFrames(const KatwijkPart& part);

}  // namespace rigmap

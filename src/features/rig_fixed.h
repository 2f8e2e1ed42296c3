// What stands still in the image while the rover moves: its own shadow, wheels.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "geometry/camera.h"
#include "geometry/serialize.h"
#include "scene/features.h"

namespace rigmap {

// Cells of the left image, row by row.
struct RigFixedCells {
  int cell_px = 0;
  int columns = 0;
  std::vector<std::uint8_t> fixed;  // not 0 where what is seen belongs to the rig

  bool Cover(const Eigen::Vector2d& pixel) const;
  // CV_8UC1 of this size (px, the left image's): 0 in fixed cells, else 255.
  cv::Mat Mask(int width, int height) const;
  // Takes the features in fixed cells, with all that belongs to them, away.
  void RemoveFrom(FrameFeatures& features) const;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(cell_px, columns, fixed);
  }
};

// Gathers votes from pairs of frames. A feature that looks the same at the same place in both votes
// for its cell, if it is at least as near as the median of the features that moved: further ones
// may rest because they are far. One that moved votes against it. Pairs in which hardly anything
// moved say nothing: the rover stands.
class RigFixedVotes {
 public:
  RigFixedVotes(int width, int height);  // px, of the left image

  void Compare(const FrameFeatures& earlier, const FrameFeatures& later);

  // Cells with at least three votes, and no fewer for than against.
  RigFixedCells Decide() const;

 private:
  int CellOf(const Eigen::Vector2d& pixel) const;

  RigFixedCells grid_;
  int width_px_;
  std::vector<int> for_, against_;
};

// The cells of a drive: every frame is compared with the next and, in case the rover crawls, with
// the third after it. Holds four frames at a time.
RigFixedCells FindRigFixed(int frame_count, const FeatureSource& features, const Camera& left);

}  // namespace rigmap

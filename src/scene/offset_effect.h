// What disparities that are all off alike do to a motion.
#pragma once

#include <Eigen/Core>

namespace rigmap {

// Of an offset (px) that every disparity has too much, as a rig has whose right eye is turned less
// than its file says: how far it moves a motion, and what the residuals of the motion say of it,
// all to first order at no offset.
struct OffsetEffect {
  double lengthening_m_per_px = 0.0;  // of the motion, if disparities were corrected by so much
  // Of the offset, the motion following it: the most probable one is score / information, its
  // variance 1 / information if residuals were independent.
  double score = 0.0, information = 0.0;  // 1/px, 1/px^2

  template <class Archive>
  void serialize(Archive& archive) {
    archive(lengthening_m_per_px, score, information);
  }
};

}  // namespace rigmap

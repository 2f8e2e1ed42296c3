#include "export/pose_text.h"

#include <fmt/format.h>

namespace rigmap {

std::string FormatPose(const Rigid3& world_from_body, char separator) {
  const Eigen::Vector3d& t = world_from_body.translation;
  Eigen::Quaterniond q = world_from_body.rotation;
  if (q.w() < 0.0) q.coeffs() = -q.coeffs();
  return fmt::format("{1:.9f}{0}{2:.9f}{0}{3:.9f}{0}{4:.12f}{0}{5:.12f}{0}{6:.12f}{0}{7:.12f}",
                     separator, t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
}

}  // namespace rigmap

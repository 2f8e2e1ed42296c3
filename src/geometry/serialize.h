// How Eigen's and geometry's types are stored in artefacts (cereal finds these by lookup).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "geometry/camera.h"
#include "geometry/rigid3.h"

namespace Eigen {

template <class Archive, class Scalar, int Rows, int Cols, int Options>
requires(Rows != Dynamic &&
         Cols != Dynamic) void serialize(Archive& archive,
                                         Matrix<Scalar, Rows, Cols, Options>& matrix) {
  for (int i = 0; i < Rows * Cols; ++i) archive(matrix.data()[i]);
}

template <class Archive>
void serialize(Archive& archive, Quaterniond& rotation) {
  archive(rotation.coeffs());
}

}  // namespace Eigen

namespace rigmap {

template <class Archive>
void serialize(Archive& archive, Rigid3& motion) {
  archive(motion.rotation, motion.translation);
}

template <class Archive>
void serialize(Archive& archive, Sim3& similarity) {
  archive(similarity.scale, similarity.rotation, similarity.translation);
}

template <class Archive>
void serialize(Archive& archive, Camera& camera) {
  archive(camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy, camera.k1,
          camera.k2, camera.p1, camera.p2, camera.k3);
}

}  // namespace rigmap

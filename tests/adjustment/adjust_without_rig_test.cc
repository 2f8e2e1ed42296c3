#include "adjustment/adjust_without_rig.h"

#include <gtest/gtest.h>

#include "core/statistics.h"
#include "correspondence/tracks.h"
#include "tests/adjustment/rover_bundle.h"

namespace rigmap {
namespace {

// A rover's frames, all keyframes, as a model whose images stand where `poses` put the rig.
class AdjustWithoutRigTest : public AdjustTest {
 protected:
  void SetUp() override { Make({.frames = 8, .points_per_m2 = 12.0, .seed = 5}); }

  SparseModel ModelOn(const std::vector<Rigid3>& poses) const {
    SparseModel model;
    model.cameras = {{Eye::kLeft, rover_.rig.left.camera}, {Eye::kRight, rover_.rig.right.camera}};
    for (int k = 0; k < static_cast<int>(poses.size()); ++k) {
      const Rigid3 left_from_world = poses[k].Inverse();
      model.images.push_back({{k, Eye::kLeft}, "l", left_from_world, {}});
      model.images.push_back(
          {{k, Eye::kRight}, "r", rover_.rig.right_from_left * left_from_world, {}});
    }
    const auto points = TriangulateTracks(BuildTracks(correspondences_, false), correspondences_,
                                          rover_.rig, InverseOf(AllOf(poses)), 50.0, 1000.0);
    for (const AdjustedPoint& made : points) {
      SparsePoint point{.id = model.points.size() + 1, .x_in_model = made.x};
      for (const PointObservation& o : made.observations) {
        SparseImage& image = model.images[2 * o.frame + (o.eye == Eye::kRight ? 1 : 0)];
        point.track.push_back({image.ref, static_cast<std::uint32_t>(image.keypoints.size())});
        image.keypoints.push_back({o.pixel, point.id});
      }
      model.points.push_back(std::move(point));
    }
    return model;
  }

  // Relative deviations of the left-right distances from their median.
  static std::vector<double> Deviations(const SparseModel& model) {
    std::vector<double> distances;
    for (std::size_t i = 0; i + 1 < model.images.size(); i += 2) {
      distances.push_back((model.images[i].camera_from_model.Inverse().translation -
                           model.images[i + 1].camera_from_model.Inverse().translation)
                              .norm());
    }
    const double median = Median(distances);
    for (double& distance : distances) distance = distance / median - 1.0;
    return distances;
  }
};

TEST_F(AdjustWithoutRigTest, TruePosesStayApartAlike) {
  const SparseModel adjusted =
      AdjustWithoutRig(ModelOn(rover_.world_from_left), rover_.rig, 15, {});
  ASSERT_EQ(adjusted.images.size(), 16U);
  for (const double deviation : Deviations(adjusted)) EXPECT_LT(std::abs(deviation), 0.01);
}

TEST_F(AdjustWithoutRigTest, WhatARigIsWrongByShowsInItsDistances) {
  // Stereo matches that belong to a wider rig: half of the frames contradict the other half.
  for (std::size_t f = 4; f < correspondences_.features.size(); ++f) {
    for (Feature& feature : correspondences_.features[f]) {
      if (feature.right) feature.right->x() -= 0.1 * (feature.left.x() - feature.right->x());
    }
  }
  const SparseModel model = ModelOn(rover_.world_from_left);
  for (const double deviation : Deviations(model)) EXPECT_LT(std::abs(deviation), 1e-9);
  std::vector<double> sizes;
  for (const double deviation : Deviations(AdjustWithoutRig(model, rover_.rig, 15, {}))) {
    sizes.push_back(std::abs(deviation));
  }
  EXPECT_GT(*std::max_element(sizes.begin(), sizes.end()), 0.03);
}

TEST_F(AdjustWithoutRigTest, KeyframesWithoutObservationsLeaveTheModel) {
  SparseModel model = ModelOn(rover_.world_from_left);
  // The fourth keyframe's left image loses its points.
  for (SparsePoint& point : model.points) {
    std::erase_if(point.track, [](const auto& element) {
      return element.image == ImageRef{3, Eye::kLeft};
    });
  }
  const SparseModel adjusted = AdjustWithoutRig(model, rover_.rig, 15, {});
  EXPECT_EQ(adjusted.images.size(), 14U);
  for (const SparseImage& image : adjusted.images) EXPECT_NE(image.ref.frame, 3);
  for (const SparsePoint& point : adjusted.points) {
    for (const TrackElement& element : point.track) EXPECT_NE(element.image.frame, 3);
  }
}

}  // namespace
}  // namespace rigmap

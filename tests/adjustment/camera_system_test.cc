#include "adjustment/internal/camera_system.h"

#include <gmock/gmock.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "adjustment/internal/bundle.h"
#include "adjustment/reprojection.h"
#include "tests/adjustment/rover_bundle.h"

namespace rigmap {
namespace {

constexpr double kNoHuber_px = 1e9;

class CameraSystemTest : public testing::Test {
 protected:
  void Make(const SyntheticRoverOptions& options) {
    rover_ = MakeSyntheticRover(options);
    correspondences_ = RoverCorrespondences(rover_, 3);
    left_from_world_ = InverseOf(AllOf(rover_.world_from_left));
    Triangulate();
  }

  void Triangulate() {
    points_ = TriangulateTracks(BuildTracks(correspondences_, false), correspondences_, rover_.rig,
                                left_from_world_, 8.0, 100.0);
  }

  CameraSystemResult Solve(double noise_px, double huber_px = kNoHuber_px) const {
    return SolveCameraSystem({points_, left_from_world_, rover_.rig, noise_px, huber_px});
  }

  SyntheticRover rover_;
  Correspondences correspondences_;
  MaybePoses left_from_world_;
  std::vector<AdjustedPoint> points_;
};

// The whole normal matrix over frames 1.., then points, in sigmas of one pixel.
Eigen::MatrixXd DenseNormalMatrix(const std::vector<AdjustedPoint>& points,
                                  const MaybePoses& left_from_world, const StereoRig& rig) {
  const int pose_unknowns = 6 * (static_cast<int>(left_from_world.size()) - 1);
  const int size = pose_unknowns + 3 * static_cast<int>(points.size());
  Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(size, size);
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (const PointObservation& o : points[i].observations) {
      const auto at = Reproject(rig, o.eye, *left_from_world[o.frame], points[i].x);
      Eigen::MatrixXd row = Eigen::MatrixXd::Zero(2, size);
      if (o.frame > 0) row.middleCols<6>(6 * (o.frame - 1)) = at->jacobians.pose;
      row.middleCols<3>(pose_unknowns + 3 * static_cast<int>(i)) = at->jacobians.point;
      normal += row.transpose() * row;
    }
  }
  return normal;
}

constexpr double kStep = 1e-6;  // m or rad, for differences

// By one step of the perturbation (rotation, translation) that poses are solved for.
Rigid3 Moved(const Rigid3& left_from_world, int axis) {
  const Vector6d delta = kStep * Vector6d::Unit(axis);
  return {ExpRotation(delta.head<3>()) * left_from_world.rotation,
          left_from_world.translation + delta.tail<3>()};
}

TEST_F(CameraSystemTest, CovariancesAreThoseOfTheWholeSystem) {
  Make({.frames = 4, .points_per_m2 = 1.5, .seed = 51});
  ASSERT_GT(points_.size(), 25u);
  const double noise_px = 0.3;
  const Eigen::MatrixXd covariance =
      noise_px * noise_px *
      DenseNormalMatrix(points_, left_from_world_, rover_.rig)
          .ldlt()
          .solve(Eigen::MatrixXd::Identity(18 + 3 * static_cast<int>(points_.size()),
                                           18 + 3 * static_cast<int>(points_.size())));
  const CameraSystemResult result = Solve(noise_px);
  for (int frame = 1; frame < 4; ++frame) {
    // From a perturbation of left_from_world to one of world_from_left, by differences.
    Matrix6d jacobian;
    for (int axis = 0; axis < 6; ++axis) {
      const Rigid3& pose = *left_from_world_[frame];
      jacobian.col(axis) = ErrorOf(Moved(pose, axis).Inverse(), pose.Inverse()) / kStep;
    }
    const Matrix6d block = covariance.block<6, 6>(6 * (frame - 1), 6 * (frame - 1));
    const Matrix6d expected = jacobian * block * jacobian.transpose();
    EXPECT_LT((result.covariances[frame] - expected).norm(), 1e-4 * expected.norm());
  }
}

TEST_F(CameraSystemTest, LinksAreThoseOfTheWholeSystem) {
  Make({.frames = 9, .points_per_m2 = 1.5, .seed = 51});
  const std::vector<int> references{0, 0, 1, 2, 3, 3, 5, 6, 1};  // the last shares no points
  const double noise_px = 0.3;
  const Eigen::MatrixXd normal = DenseNormalMatrix(points_, left_from_world_, rover_.rig);
  const Eigen::MatrixXd covariance =
      noise_px * noise_px *
      normal.ldlt().solve(Eigen::MatrixXd::Identity(normal.rows(), normal.cols()));
  const CameraSystemResult result =
      SolveCameraSystem({points_, left_from_world_, rover_.rig, noise_px, kNoHuber_px}, references);
  ASSERT_EQ(result.link_covariances.size(), 9u);
  EXPECT_FALSE(result.link_covariances[0]);
  for (int frame = 1; frame < 9; ++frame) {
    const Rigid3 &to = *left_from_world_[frame], &from = *left_from_world_[references[frame]];
    // Where the motion from the reference takes the frame, against where it is.
    Eigen::Matrix<double, 6, Eigen::Dynamic> jacobian =
        Eigen::Matrix<double, 6, Eigen::Dynamic>::Zero(6, normal.cols());
    for (int axis = 0; axis < 6; ++axis) {
      jacobian.col(6 * (frame - 1) + axis) =
          ErrorOf(Moved(to, axis).Inverse(), to.Inverse()) / kStep;
      if (references[frame] == 0) continue;
      const Rigid3 carried = Moved(from, axis).Inverse() * from * to.Inverse();
      jacobian.col(6 * (references[frame] - 1) + axis) = -ErrorOf(carried, to.Inverse()) / kStep;
    }
    const Matrix6d expected = jacobian * covariance * jacobian.transpose();
    ASSERT_TRUE(result.link_covariances[frame]) << frame;
    EXPECT_LT((*result.link_covariances[frame] - expected).norm(), 1e-4 * expected.norm()) << frame;
  }
}

TEST_F(CameraSystemTest, ScaleIsThatOfASimilarityAlignment) {
  Make({.frames = 5, .points_per_m2 = 2.0, .seed = 57});
  const double noise_px = 0.3;
  const int size = 24 + 3 * static_cast<int>(points_.size());
  const Eigen::MatrixXd covariance = noise_px * noise_px *
                                     DenseNormalMatrix(points_, left_from_world_, rover_.rig)
                                         .ldlt()
                                         .solve(Eigen::MatrixXd::Identity(size, size));
  std::vector<Eigen::Vector3d> positions;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const auto& pose : left_from_world_) {
    positions.push_back(pose->Inverse().translation);
    mean += positions.back() / 5.0;
  }
  double squares = 0.0;
  Eigen::VectorXd functional = Eigen::VectorXd::Zero(size);
  for (int frame = 0; frame < 5; ++frame) {
    const Eigen::Vector3d arm = positions[frame] - mean;
    squares += arm.squaredNorm();
    for (int axis = 0; axis < 6 && frame > 0; ++axis) {
      const Rigid3 moved = Moved(*left_from_world_[frame], axis).Inverse();
      functional(6 * (frame - 1) + axis) = arm.dot(moved.translation - positions[frame]) / kStep;
    }
  }
  functional /= squares;
  const CameraSystemResult result = Solve(noise_px);
  ASSERT_TRUE(result.scale);
  // Correlations within tracks can only add.
  const double independent = functional.dot(covariance * functional);
  EXPECT_GT(result.scale->variance, 0.999 * independent);
  EXPECT_LT(result.scale->variance, 3.0 * independent);
  // Of an exact rig with longer focal lengths all is longer along the path, or shorter.
  EXPECT_GT(std::abs(result.scale->by_calibration(kLogFocal)), 0.1);
}

TEST_F(CameraSystemTest, TheFirstFrameIsCertainAndDoubtGrowsAlongThePath) {
  Make({.frames = 12, .points_per_m2 = 5.0, .seed = 52});
  const CameraSystemResult result = Solve(0.2);
  EXPECT_THAT(result.datum_frames, testing::Each(0));
  EXPECT_EQ(result.covariances[0], Matrix6d::Zero());
  const auto variance_m2 = [&](int frame) {
    return result.covariances[frame].topLeftCorner<3, 3>().trace();
  };
  for (int frame : {4, 8, 11}) EXPECT_GT(variance_m2(frame), variance_m2(frame - 3));
}

TEST_F(CameraSystemTest, SigmasAreProportionalToTheNoise) {
  Make({.frames = 5, .points_per_m2 = 5.0, .seed = 53});
  const CameraSystemResult once = Solve(0.2), twice = Solve(0.4);
  const Matrix6d four_times = 4.0 * once.covariances[4];
  EXPECT_LT((twice.covariances[4] - four_times).norm(), 1e-9 * four_times.norm());
  ASSERT_TRUE(once.calibration && twice.calibration);
  const CalibrationMatrix quarter = 0.25 * once.calibration->information;
  EXPECT_LT((twice.calibration->information - quarter).norm(), 1e-9 * quarter.norm());
  const auto step_once = RotationAndFocalStep(*once.calibration),
             step_twice = RotationAndFocalStep(*twice.calibration);
  EXPECT_GT(step_twice->log_focal_sigma, step_once->log_focal_sigma);
  EXPECT_NEAR(step_twice->log_focal / step_once->log_focal, 1.0, 1e-6);
}

TEST_F(CameraSystemTest, CovariancesTurnWithTheWorld) {
  Make({.frames = 5, .points_per_m2 = 5.0, .seed = 54});
  SeededRandom random;
  const CameraSystemResult here = Solve(0.2);
  const Rigid3 moved_from_world = random.Motion(20.0);
  for (auto& pose : left_from_world_) pose = *pose * moved_from_world.Inverse();
  for (AdjustedPoint& point : points_) point.x = moved_from_world * point.x;
  const CameraSystemResult there = Solve(0.2);
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = moved_from_world.rotation.toRotationMatrix();
  turn.bottomRightCorner<3, 3>() = turn.topLeftCorner<3, 3>();
  const Matrix6d expected = turn * here.covariances[4] * turn.transpose();
  EXPECT_LT((there.covariances[4] - expected).norm(), 1e-6 * expected.norm());
  const auto step_there = RotationAndFocalStep(*there.calibration),
             step_here = RotationAndFocalStep(*here.calibration);
  EXPECT_LT((step_there->rig_rotation - step_here->rig_rotation).norm(),
            1e-6 * step_here->rig_rotation_sigma.norm());
}

TEST_F(CameraSystemTest, FramesThatShareNothingHangOnTheirOwnFirst) {
  Make({.frames = 8, .points_per_m2 = 5.0, .seed = 55});
  CutBefore(3, correspondences_);
  Triangulate();
  const CameraSystemResult result = Solve(0.2);
  EXPECT_THAT(result.datum_frames, testing::ElementsAre(0, 0, 0, 3, 3, 3, 3, 3));
  EXPECT_EQ(result.covariances[3], Matrix6d::Zero());
  for (int frame : {1, 2, 4, 7}) {
    const Eigen::Matrix3d of_position = result.covariances[frame].topLeftCorner<3, 3>();
    const double sigma_m = std::sqrt(of_position.trace());
    EXPECT_GT(sigma_m, 1e-5);
    EXPECT_LT(sigma_m, 0.01);
  }
}

TEST_F(CameraSystemTest, FramesWithoutPointsAreLeftAlone) {
  Make({.frames = 5, .points_per_m2 = 5.0, .seed = 56});
  left_from_world_[2].reset();
  Triangulate();
  const CameraSystemResult result = Solve(0.2);
  ASSERT_EQ(result.covariances.size(), 5u);
  EXPECT_EQ(result.covariances[2], Matrix6d::Zero());
  EXPECT_EQ(result.datum_frames[2], 2);
  points_.clear();
  EXPECT_FALSE(Solve(0.2, 1.0).calibration);
}

TEST_F(CameraSystemTest, ResidualsBeyondHubersLimitCountForLess) {
  Make({.frames = 5, .points_per_m2 = 5.0, .pixel_sigma = 0.5, .seed = 57});
  const double plain = Solve(0.2).covariances[4].trace();
  EXPECT_GT(Solve(0.2, 0.2).covariances[4].trace(), 1.2 * plain);
  EXPECT_NEAR(Solve(0.2, 20.0).covariances[4].trace(), plain, 1e-9 * plain);
}

TEST_F(CameraSystemTest, SigmasOfIndependentNoiseNeedNoInflation) {
  Make({.frames = 12, .points_per_m2 = 20.0, .pixel_sigma = 0.2, .seed = 58});
  const CameraSystemResult result = Solve(0.2);
  for (int frame = 1; frame < 12; ++frame) {
    EXPECT_GE(result.inflations[frame].minCoeff(), 1.0);
    EXPECT_LT(result.inflations[frame].maxCoeff(), 1.5);
  }
}

// Every track drifts in the image like a random walk: as many observations tell less.
TEST_F(CameraSystemTest, TracksThatDriftInflateSigmas) {
  Make({.frames = 12, .points_per_m2 = 20.0, .pixel_sigma = 0.0, .seed = 59});
  SeededRandom random;
  for (AdjustedPoint& point : points_) {
    Eigen::Vector2d drift = Eigen::Vector2d::Zero();
    int frame = point.observations.front().frame;
    for (PointObservation& o : point.observations) {
      if (o.frame != frame) drift += random.Noise(0.1).head<2>();
      frame = o.frame;
      o.pixel += drift;
    }
  }
  const CameraSystemResult result = Solve(0.1);
  EXPECT_GT(result.inflations[11].mean(), 1.5);
  EXPECT_GT(result.inflations[6].mean(), 1.3);
}

TEST_F(CameraSystemTest, CalibrationAloneIsThatOfTheWhole) {
  Make({.frames = 8, .points_per_m2 = 6.0, .pixel_sigma = 0.2, .seed = 58});
  const CameraSystemResult whole = Solve(0.2);
  const auto alone = SolveCalibration({points_, left_from_world_, rover_.rig, 0.2, kNoHuber_px});
  ASSERT_TRUE(whole.calibration && alone);
  EXPECT_EQ(alone->equations.information, whole.calibration->information);
  EXPECT_EQ(alone->equations.score, whole.calibration->score);
  EXPECT_EQ(alone->equations.stretches.size(), whole.calibration->stretches.size());
  EXPECT_EQ(alone->equations.regions.size(), whole.calibration->regions.size());
}

// Such points came out as large numbers less themselves, and made a calibration's information
// negative: one of 30 000 was enough.
TEST_F(CameraSystemTest, PointsWithoutAPositionSayNothingOfTheCalibration) {
  Make({.frames = 8, .points_per_m2 = 6.0, .pixel_sigma = 0.2, .seed = 60});
  const auto solve = [&] {
    return SolveCalibration({points_, left_from_world_, rover_.rig, 0.2, kNoHuber_px});
  };
  const auto without = solve();
  AdjustedPoint in_one_image = points_.front(), far_off = points_.front();
  in_one_image.observations.resize(1);
  const Rigid3 world_from_left = left_from_world_[3]->Inverse();
  far_off.observations.clear();
  far_off.x = world_from_left * Eigen::Vector3d(1e5, -2e4, 1e7);
  for (const Eye eye : kEyes) {
    const auto at = Reproject(rover_.rig, eye, *left_from_world_[3], far_off.x);
    ASSERT_TRUE(at);
    far_off.observations.push_back({.frame = 3, .eye = eye, .pixel = at->pixel});
  }
  for (int i = 0; i < 5; ++i) points_.push_back(in_one_image);
  const auto with_one = solve();
  ASSERT_TRUE(without && with_one);
  const CalibrationMatrix& before = without->equations.information;
  EXPECT_LT((with_one->equations.information - before).norm(), 1e-9 * before.norm());
  EXPECT_LT((with_one->equations.score - without->equations.score).norm(),
            1e-9 * without->equations.score.norm());
  // One that is as good as infinitely far tells the turn of one eye against the other.
  points_.push_back(far_off);
  const auto with_far = solve();
  ASSERT_TRUE(with_far);
  const CalibrationVector added = (with_far->equations.information - before).diagonal();
  EXPECT_GT(added(kRotationY), 0.0);
  EXPECT_GE((added.array() / before.diagonal().array()).minCoeff(), -1e-9);
  for (const CalibrationBlock& block : with_far->equations.regions) {
    const CalibrationVector scale = block.information.diagonal().cwiseSqrt().cwiseInverse();
    const CalibrationMatrix scaled = scale.asDiagonal() * block.information * scale.asDiagonal();
    EXPECT_LT((scaled - scaled.transpose()).norm(), 1e-6);
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<CalibrationMatrix>(scaled).eigenvalues()(0), -1e-6);
  }
}

// A pose that follows a change of the calibration is nearer to where an adjustment then puts it.
TEST_F(CameraSystemTest, PosesFollowTheCalibration) {
  Make({.frames = 8, .points_per_m2 = 6.0, .seed = 59});
  const auto solution = SolveCalibration({points_, left_from_world_, rover_.rig, 0.2, kNoHuber_px});
  ASSERT_TRUE(solution);
  CalibrationVector step = CalibrationVector::Zero();
  step(kLogFocal) = 0.002;
  Bundle bundle{Corrected(rover_.rig, step), left_from_world_, points_};
  SolveBundle(kNoHuber_px, 1e-10, bundle);
  const Rigid3& adjusted = *bundle.left_from_world[7];
  const Rigid3 followed = Moved(*left_from_world_[7], solution->responses[7], step);
  EXPECT_GT(ErrorOf(*left_from_world_[7], adjusted).norm(), 1e-4) << "it moves";
  EXPECT_LT(ErrorOf(followed, adjusted).norm(),
            0.1 * ErrorOf(*left_from_world_[7], adjusted).norm());
}

// Poses, calibration and field of one system that is written out, in this order, points eliminated.
struct WholeSystem {
  Eigen::MatrixXd information;
  Eigen::VectorXd score;
};

WholeSystem WriteOut(const Linearisation& at) {
  const int poses = 6 * (static_cast<int>(at.left_from_world.size()) - 1),
            field = poses + kCalibrationSize, size = field + at.field->Size();
  WholeSystem whole{Eigen::MatrixXd::Zero(size, size), Eigen::VectorXd::Zero(size)};
  for (const AdjustedPoint& point : at.points) {
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(2 * point.observations.size(), size);
    Eigen::MatrixXd by_point(2 * point.observations.size(), 3);
    Eigen::VectorXd residual(2 * point.observations.size());
    int row = 0;
    for (const PointObservation& o : point.observations) {
      const auto seen = Reproject(at.rig, o.eye, *at.left_from_world[o.frame], point.x);
      if (o.frame > 0) all.block<2, 6>(row, 6 * (o.frame - 1)) = seen->jacobians.pose;
      all.block<2, kCalibrationSize>(row, poses) = seen->jacobians.calibration;
      const LensField::Support support = at.field->At(o.eye, o.pixel);
      for (int i = 0; i < 4; ++i) {
        all.block<2, 2>(row, field + support.parameter[i]).diagonal().array() -= support.weight[i];
      }
      by_point.middleRows<2>(row) = seen->jacobians.point;
      residual.segment<2>(row) = seen->pixel - o.pixel;
      row += 2;
    }
    const Eigen::MatrixXd solved =
        (by_point.transpose() * by_point).inverse() * by_point.transpose();
    const Eigen::MatrixXd left = all - by_point * (solved * all);
    whole.information += left.transpose() * left / (at.noise_px * at.noise_px);
    whole.score -= left.transpose() * residual / (at.noise_px * at.noise_px);
  }
  whole.information.diagonal().tail(at.field->Size()).array() += at.field_information;
  whole.score.tail(at.field->Size()) -= at.field_information * at.field->Values();
  return whole;
}

TEST_F(CameraSystemTest, AFieldOfTheLensIsOneMoreUnknownOfTheWholeSystem) {
  Make({.frames = 5, .points_per_m2 = 6.0, .pixel_sigma = 0.2, .seed = 61});
  LensField field(rover_.rig);
  field.Move(Eigen::VectorXd::LinSpaced(field.Size(), -0.1, 0.2));
  const Linearisation at{points_, left_from_world_, rover_.rig, 0.2, kNoHuber_px, &field, 30.0};
  const WholeSystem whole = WriteOut(at);
  const auto found = SolveCalibration(at);
  const CameraSystemResult result = SolveCameraSystem(at);
  ASSERT_TRUE(found && found->field && result.calibration);
  const Eigen::MatrixXd covariance = whole.information.inverse();
  const Eigen::MatrixXd of_calibration =
      covariance.block<kCalibrationSize, kCalibrationSize>(24, 24).inverse();
  EXPECT_LT((found->equations.information - of_calibration).norm(), 1e-6 * of_calibration.norm());
  // All of it moves by what the calibration does and what follows.
  const Eigen::VectorXd step = covariance * whole.score;
  const CalibrationVector calibration = step.segment<kCalibrationSize>(24);
  EXPECT_LT((found->equations.information * calibration - found->equations.score).norm(),
            1e-6 * found->equations.score.norm());
  const FieldResponse& response = found->field->response;
  EXPECT_LT(
      (response.step + response.by_calibration * calibration - step.tail(field.Size())).norm(),
      1e-6 * step.tail(field.Size()).norm());
  const PoseResponse& pose = found->responses[3];
  EXPECT_LT((pose.step + pose.by_calibration * calibration - step.segment<6>(12)).norm(),
            1e-6 * step.segment<6>(12).norm());
  // So is what stretches, or regions, and the field's prior say of it.
  EXPECT_TRUE(found->equations.HasField());
  for (const auto* blocks : {&found->equations.stretches, &found->equations.regions}) {
    CalibrationBlock sum = found->equations.of_field;
    for (const CalibrationBlock& block : *blocks) sum += block;
    EXPECT_LT((sum.information - of_calibration).norm(), 1e-6 * of_calibration.norm());
    EXPECT_LT((sum.score - found->equations.score).norm(), 1e-6 * sum.score.norm());
  }
  // Of poses, the calibration held: without its rows and columns.
  Eigen::MatrixXd held = whole.information;
  held.middleRows<kCalibrationSize>(24).setZero();
  held.middleCols<kCalibrationSize>(24).setZero();
  held.diagonal().segment<kCalibrationSize>(24).setOnes();
  const Matrix6d of_pose = held.inverse().block<6, 6>(18, 18);
  Matrix6d back;
  const Rigid3& left_from_world = *left_from_world_[4];
  for (int axis = 0; axis < 6; ++axis) {
    back.col(axis) =
        ErrorOf(Moved(left_from_world, axis).Inverse(), left_from_world.Inverse()) / kStep;
  }
  const Matrix6d expected = back * of_pose * back.transpose();
  EXPECT_LT((result.covariances[4] - expected).norm(), 1e-3 * expected.norm());
}

}  // namespace
}  // namespace rigmap

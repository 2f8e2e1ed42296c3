// Levenberg's and Marquardt's method for a bundle whose rig is held. Of this room only.
#pragma once

#include <optional>
#include <vector>

#include "adjustment/internal/bundle.h"
#include "adjustment/internal/pose_matrix.h"
#include "adjustment/reprojection.h"

namespace rigmap {

// Normal equations of a bundle with its points eliminated (Triggs et al. 2000, sec. 6.1), solved by
// a sparse factorisation. Points are shared out in parts of a fixed size, whose sums are added in
// order: results do not depend on the number of threads.
class BundleSolver {
 public:
  // `bundle` must outlive it.
  BundleSolver(Bundle& bundle, double huber_px);

  struct Summary {
    int iterations = 0;
    double initial_cost = 0.0, final_cost = 0.0;  // half the sum of Huber's loss, px^2
    bool settled = false;  // false: the last step allowed was taken, or there was nothing to solve
  };
  // Until a step changes the cost by less than this share of it. Leaves the bundle as it is where a
  // point lies behind an eye that sees it.
  Summary Solve(double function_tolerance);

 private:
  using PosePoint = Eigen::Matrix<double, 6, 3>;

  // A frame that sees a point and whose pose is unknown.
  struct View {
    int unknown = 0, local = 0;  // the second among the part's unknowns
    PosePoint coupling;
  };
  struct Eliminated {
    Eigen::Matrix3d inverse;
    Eigen::Vector3d gradient;
  };
  // Points that one task works on.
  struct Part {
    std::size_t begin = 0, end = 0;
    std::vector<int> unknowns;  // that its points are seen from, ascending
    std::vector<int> pairs;     // of them, indices into pairs_, ascending
    std::vector<int> pair_of;   // index into `pairs` of each two views of each point, in order
  };
  // Over the points of a part.
  struct Sums {
    explicit Sums(const Part& part);

    std::vector<Matrix6d> blocks;                // one per pair
    std::vector<Vector6d> gradients, diagonals;  // per unknown; the points not eliminated
    double gain = 0.0;                           // what the points alone would gain
  };
  // Over all points, but for the blocks, which are blocks_.
  struct Total {
    Eigen::VectorXd gradient, diagonal;
    double gain = 0.0;
  };
  struct Step {
    std::vector<Rigid3> poses;  // per frame
    std::vector<Eigen::Vector3d> points;
    double expected_gain = 0.0;
  };

  void NumberUnknowns();
  void ListViews();
  void ListPairs();
  // Into blocks_; gradient by the poses and gain of the points.
  Total Linearise(double damping);
  Sums Linearise(const Part& part, const std::vector<FrameProjection>& frames, double damping);
  void Eliminate(const Eigen::Matrix3d& v, std::size_t point, const int* pair, Sums& sums);
  void Add(const Part& part, const Sums& sums, Total& total);
  // Nothing where the equations are singular.
  std::optional<Step> FindStep(double damping);
  Eigen::Vector3d MovePoint(std::size_t point, const Eigen::VectorXd& step) const;
  // Infinite where a point lies behind an eye.
  double Cost(const std::vector<Rigid3>& poses, const std::vector<Eigen::Vector3d>& points) const;
  std::vector<FrameProjection> Projections(const std::vector<Rigid3>& poses) const;

  Bundle& bundle_;
  double huber_px_;
  std::vector<Rigid3> poses_;  // left_from_world per frame; any for frames without one
  std::vector<Eigen::Vector3d> points_;
  std::vector<int> unknown_;  // per frame; -1 where the pose is held
  int unknowns_ = 0;
  bool is_near_ = false;                 // the solution: the second derivative of the loss counts
  std::vector<std::size_t> first_view_;  // per point, and one more
  std::vector<View> views_;
  std::vector<Eliminated> eliminated_;  // per point
  std::vector<PoseMatrix::Pair> pairs_;
  std::vector<Part> parts_;
  std::optional<PoseMatrix> matrix_;  // where a pose is unknown
  std::vector<Matrix6d> blocks_;      // per pair
};

}  // namespace rigmap

// What the scripts draw.
#include <cmath>

#include "report/part_content.h"
#include "report/rounded.h"

namespace rigmap {
namespace {

Json DescribePoses(const Trajectory& trajectory) {
  const StampNs first_ns = trajectory.front().stamp_ns;
  const auto axis = [&](int i) {
    return Values(trajectory, [i](const TimedPose& pose) {
      return ToTenthOfMillimetre(pose.world_from_left.translation[i]);
    });
  };
  const auto known = [](double value) {  // null where nothing is known, as COLMAP says of its poses
    return std::isfinite(value) ? Json(Rounded5(value)) : Json(nullptr);
  };
  const auto sigma = [&](int i) {
    return Values(trajectory, [&, i](const TimedPose& pose) { return known(pose.sigmas[i]); });
  };
  Json rotations = Json::array();
  for (const TimedPose& pose : trajectory) {
    for (const double number : pose.world_from_left.rotation.coeffs()) {
      rotations.push_back(Rounded5(number));
    }
  }
  const auto turn = [&](const TimedPose& pose) {
    return known(pose.sigmas.allFinite() ? pose.sigmas.tail<3>().maxCoeff() : NAN);
  };
  return {{"t", Values(trajectory,
                       [&](const TimedPose& pose) {
                         return ToTenthOfMillimetre(1e-9 *
                                                    static_cast<double>(pose.stamp_ns - first_ns));
                       })},
          {"x", axis(0)},
          {"y", axis(1)},
          {"z", axis(2)},
          {"q", rotations},
          {"sx", sigma(0)},
          {"sy", sigma(1)},
          {"sz", sigma(2)},
          {"sr", Values(trajectory, turn)},
          {"source", Values(trajectory, [](const auto& pose) { return Name(pose.source); })},
          {"keyframe", Values(trajectory, [](const auto& pose) { return pose.keyframe; })}};
}

Json DescribeLeftCamera(const PartContent& content) {
  const auto& sparse = content.folder.sparse;
  if (const Camera* c = sparse ? LeftCameraOf(*sparse) : nullptr) {
    return {{"width", c->width}, {"height", c->height}, {"fx", c->fx},
            {"fy", c->fy},       {"cx", c->cx},         {"cy", c->cy}};
  }
  return {{"width", 4}, {"height", 3}, {"fx", 4}, {"fy", 4}, {"cx", 2}, {"cy", 1.5}};
}

Json Positions(const Json& rows) {
  Json positions = Json::array();
  for (const Json& row : rows) positions.push_back({row[1], row[2], row[3]});
  return positions;
}

// Of points and path together.
Json BoundsOfScene(const PartContent& content) {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(INFINITY), high = -low;
  if (!content.points.levels.empty()) {
    low = Eigen::Map<const Eigen::Vector3d>(content.points.bounds_m[0].data());
    high = Eigen::Map<const Eigen::Vector3d>(content.points.bounds_m[1].data());
  }
  for (const TimedPose& pose : content.folder.trajectory) {
    low = low.cwiseMin(pose.world_from_left.translation);
    high = high.cwiseMax(pose.world_from_left.translation);
  }
  if (!low.allFinite()) return nullptr;
  return {{"low", {low.x(), low.y(), low.z()}}, {"high", {high.x(), high.y(), high.z()}}};
}

Json RocksOfView(const PartContent& content) {
  Json rocks = Json::array();
  if (!content.cloud || !content.cloud->rocks) return rocks;
  for (const SegmentedRock& rock : *content.cloud->rocks) {
    rocks.push_back({{"x", ToTenthOfMillimetre(rock.centre.x())},
                     {"y", ToTenthOfMillimetre(rock.centre.y())},
                     {"top", ToTenthOfMillimetre(rock.top_z_m)},
                     {"width", ToTenthOfMillimetre(rock.width_m)},
                     {"height", ToTenthOfMillimetre(rock.height_m)}});
  }
  return rocks;
}

// Sigmas, relative: of the scale, and of that what the poses' sigmas hold, which the baseline's is
// not in.
Json DescribeScale(const PartContent& content) {
  constexpr double kSigmasOf95Pct = 1.96;
  const auto sigma_at = [&](const char* pointer) {
    const Json& pct = At(content.folder.summary, pointer);
    return pct.is_number() ? pct.get<double>() / 100.0 / kSigmasOf95Pct : 0.0;
  };
  const double sigma = sigma_at("/verdict/scale_95_pct");
  const double of_baseline = sigma_at("/verdict/known/scale_95_pct_of_baseline");
  const bool is_in_poses = IsCalibrationInSigmas(content) && sigma > of_baseline;
  return {{"sigma", sigma},
          {"inPoses", is_in_poses ? std::sqrt(sigma * sigma - of_baseline * of_baseline) : 0.0}};
}

}  // namespace

// Techniques that do not check the rig file know of its errors in the verdict only.
bool IsCalibrationInSigmas(const PartContent& content) {
  const std::string technique = TextAt(content.folder.summary, "/technique");
  return technique == "rig" || technique == "join";
}

Json PageData(const PartContent& content) {
  const Trajectory& trajectory = content.folder.trajectory;
  const auto distances = DistancesAlong(trajectory);
  const FigureSource summary = content.folder.Summary();
  Json data = {{"charts", Charts(content)},
               {"map", content.map},
               {"truth", Positions(At(content.folder.reference, "/truth"))},
               {"rtk", Positions(At(content.folder.reference, "/rtk"))},
               {"rocks", RocksOfView(content)},
               {"camera", DescribeLeftCamera(content)},
               {"bounds", BoundsOfScene(content)},
               {"pathLength", distances.empty() ? 0.0 : ToTenthOfMillimetre(distances.back())}};
  if (trajectory.size() > 1) data["poses"] = DescribePoses(trajectory);
  if (!content.points.levels.empty()) {
    data["points"] = DescribePoints(content.points, content.cloud->count_in_map);
  }
  if (HasFigure(summary, "/verdict/scale_95_pct")) data["scale"] = DescribeScale(content);
  return data;
}

}  // namespace rigmap

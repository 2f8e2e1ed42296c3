#include "simulation/internal/truth_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>
#include <ostream>

#include "core/file.h"
#include "export/pose_text.h"
#include "georeference/utm_grid.h"

namespace rigmap {
namespace {

using Json = nlohmann::ordered_json;

void WriteText(const std::filesystem::path& file, const std::string& text) {
  WriteFileAtomically(file, [&](std::ostream& stream) { stream << text; });
}

// Whole milliseconds, rounded down as FormatKatwijkStamp does.
std::string FormatMilliseconds(StampNs stamp_ns) {
  const std::string nine_decimals = FormatSeconds(stamp_ns);
  return nine_decimals.substr(0, nine_decimals.size() - 6);
}

std::string TrajectoryText(std::span<const TruthFrame> frames) {
  std::string text =
      "# timestamp tx ty tz qx qy qz qw ; world_T_leftcam, local true-ENU metres, camera x right y "
      "down z forward\n";
  for (const TruthFrame& frame : frames) {
    text +=
        FormatMilliseconds(frame.stamp_ns) + ' ' + FormatPose(frame.world_from_left, ' ') + '\n';
  }
  return text;
}

std::string FramesText(std::span<const TruthFrame> frames) {
  std::string text = "# index stamp unix_seconds path_s_m\n";
  for (const TruthFrame& frame : frames) {
    text += fmt::format("{} {} {} {:.4f}\n", frame.index, FormatKatwijkStamp(frame.stamp_ns),
                        FormatMilliseconds(frame.stamp_ns), frame.travelled_m);
  }
  return text;
}

std::string AntennaText(std::span<const TruthFrame> frames, const Eigen::Vector3d& antenna_in_left,
                        const LocalFrame& local) {
  std::string text = "# unix_s enu_x enu_y enu_z utm31_easting utm31_northing ellipsoid_alt\n";
  for (const TruthFrame& frame : frames) {
    const Eigen::Vector3d antenna = frame.world_from_left * antenna_in_left;
    const Geodetic position = local.ToGeodetic(antenna);
    const UtmPoint utm = ToUtm(kUtm31, position);
    text += fmt::format("{} {:.6f} {:.6f} {:.6f} {:.6f} {:.6f} {:.6f}\n",
                        FormatMilliseconds(frame.stamp_ns), antenna.x(), antenna.y(), antenna.z(),
                        utm.easting_m, utm.northing_m, position.altitude_m);
  }
  return text;
}

std::string BloomText(std::span<const TruthFrame> frames) {
  std::string text = "# index bloom_amount saturated_fraction_left saturated_fraction_right\n";
  for (const TruthFrame& frame : frames) {
    text += fmt::format("{} {:.3f} {:.4f} {:.4f}\n", frame.index, frame.glare_area,
                        frame.saturated_left, frame.saturated_right);
  }
  return text;
}

Json ToJson(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Json ToJson(const Rigid3& b_from_a) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = b_from_a.rotation.toRotationMatrix();
  matrix.topRightCorner<3, 1>() = b_from_a.translation;
  Json rows = Json::array();
  for (int i = 0; i < 4; ++i) {
    rows.push_back({matrix(i, 0), matrix(i, 1), matrix(i, 2), matrix(i, 3)});
  }
  return rows;
}

void PutOrigin(Json& json, const LocalFrame& local) {
  const Geodetic& origin = local.origin();
  const UtmPoint utm = ToUtm(kUtm31, origin);
  json["frame"] = "local true ENU (x east, y north, z up) tangent to WGS84 at origin, metres";
  json["origin_lat_lon_alt"] = {origin.latitude_deg, origin.longitude_deg, origin.altitude_m};
  json["utm_zone"] = "31N";
  json["utm31_origin_easting"] = utm.easting_m;
  json["utm31_origin_northing"] = utm.northing_m;
  json["grid_convergence_deg"] = -utm.convergence_rad * 180.0 / std::numbers::pi;
  json["note_convergence"] = fmt::format(
      "easting increases by sin(grid_convergence_deg) per metre true north; point scale factor "
      "{:.6f}",
      utm.scale);
}

void PutMounts(Json& json, const TruthSetting& setting) {
  const RoverMount& mount = setting.mount;
  const Eigen::Vector3d& imu = mount.body_from_imu.translation;
  json["world_T_leftcam"] = "p_world = R p_cam + t; camera OpenCV axes; quaternion order x y z w";
  json["antenna_in_leftcam_m"] = ToJson(mount.antenna_in_left);
  json["antenna_body_flu_m"] = ToJson(mount.AntennaInBody());
  json["body_T_leftcam"] = ToJson(mount.body_from_left);
  json["body_frame"] = "x forward y left z up, on the ground under the IMU";
  json["imu_T"] = fmt::format("IMU at body ({:.4g},{:.4g},{:.4g}), axes x backward y right z up",
                              imu.x() + 0.0, imu.y() + 0.0, imu.z());
  json["body_T_imu"] = ToJson(mount.body_from_imu);
  json["imu_T_leftcam"] = ToJson(mount.imu_from_left);
  json["left_T_right"] = ToJson(setting.rig.right_from_left.Inverse());
}

std::string TruthText(const TruthSetting& setting, const LocalFrame& local) {
  Json json;
  PutOrigin(json, local);
  PutMounts(json, setting);
  json["stamps"] = "unix seconds UTC of the file-name stamp";
  json["depth"] = "depth/depth_NNNN.png by index of frames.txt, see depth/camera.json";
  json["sun_direction_enu"] = ToJson(setting.scene.SunDirection());
  json["gps_clock_offset_s"] = setting.gps_clock_offset_s;
  json["seed"] = setting.seed;
  json["scene"] = setting.scene.name;
  json["path"] = setting.path;
  json["faults"] = setting.faults;
  json["unusable_frames"] = setting.unusable_frames;
  return json.dump(1) + '\n';
}

double DistanceFrom(std::span<const Eigen::Vector2d> path, const Eigen::Vector2d& position) {
  double nearest_m = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Eigen::Vector2d step = path[std::min(i + 1, path.size() - 1)] - path[i];
    const double along = (position - path[i]).dot(step) / std::max(step.squaredNorm(), 1e-12);
    const Eigen::Vector2d foot = path[i] + std::clamp(along, 0.0, 1.0) * step;
    nearest_m = std::min(nearest_m, (position - foot).norm());
  }
  return nearest_m;
}

Json ToJson(const Boulder& boulder, std::span<const Eigen::Vector2d> path,
            const LocalFrame& local) {
  const UtmPoint utm = ToUtm(kUtm31, local.ToGeodetic(boulder.centre));
  return {{"size", boulder.size},
          {"height", boulder.height_m},
          {"width", boulder.width_m},
          {"x", boulder.centre.x()},
          {"y", boulder.centre.y()},
          {"z", boulder.centre.z()},
          {"yaw_rad", boulder.yaw_rad},
          {"top", ToJson(boulder.top)},
          {"path_dist", DistanceFrom(path, boulder.centre.head<2>())},
          {"utm31_easting", utm.easting_m},
          {"utm31_northing", utm.northing_m}};
}

}  // namespace

void WriteTruthFiles(const std::filesystem::path& folder, std::span<const TruthFrame> frames,
                     const TruthSetting& setting, const LocalFrame& local) {
  WriteText(folder / "trajectory.tum", TrajectoryText(frames));
  WriteText(folder / "frames.txt", FramesText(frames));
  WriteText(folder / "antenna_at_frames.txt",
            AntennaText(frames, setting.mount.antenna_in_left, local));
  WriteText(folder / "bloom.txt", BloomText(frames));
  WriteText(folder / "truth.json", TruthText(setting, local));
}

void WriteTruthRocks(const std::filesystem::path& file, std::span<const Boulder> boulders,
                     std::span<const Eigen::Vector2d> path, const LocalFrame& local) {
  Json json;
  json["note"] =
      "exact: x,y,z = centre of the rock at the sand line in local ENU; top = highest point; "
      "published Rock Data files carry 3 cm (1 sigma) survey noise";
  json["rocks"] = Json::array();
  for (const Boulder& boulder : boulders) json["rocks"].push_back(ToJson(boulder, path, local));
  WriteText(file, json.dump(1) + '\n');
}

}  // namespace rigmap

#include "simulation/photograph.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "core/error.h"
#include "core/file.h"
#include "simulation/camera_response.h"
#include "simulation/internal/noise.h"

namespace rigmap {
namespace {

constexpr int kStrides = 4;

// Where a person is who crosses the rover's view within a range of frames: from near the left to
// far on the right, always ahead.
Rigid3 WorldFromPerson(const DrivePlan& plan, const World& world, const FrameRange& range,
                       double time_s) {
  const double begin_s = plan.frame_times_s[range.first], end_s = plan.frame_times_s[range.end - 1];
  const PlanarState first = plan.path.At(begin_s), last = plan.path.At(end_s);
  const auto ahead = [](const PlanarState& state, double forward_m, double left_m) {
    const Eigen::Rotation2Dd turn(state.heading_rad);
    return Eigen::Vector2d(state.position_m + turn * Eigen::Vector2d(forward_m, left_m));
  };
  const Eigen::Vector2d from = ahead(first, 3.8, 1.6), to = ahead(last, 5.5, -2.6), way = to - from;
  const double share = end_s > begin_s ? (time_s - begin_s) / (end_s - begin_s) : 0.0;
  const Eigen::Vector2d position = from + share * way;
  return {
      Eigen::Quaterniond(Eigen::AngleAxisd(std::atan2(way.y(), way.x()), Eigen::Vector3d::UnitZ())),
      {position.x(), position.y(), world.terrain().Height(position.x(), position.y())}};
}

std::uint32_t SeedOf(const DrivePlan& plan, const DriveFrame& frame, Eye eye) {
  return HashOf(static_cast<std::uint32_t>(plan.clock.seed),
                static_cast<std::uint32_t>(frame.index), static_cast<std::uint32_t>(eye) + 81u);
}

}  // namespace

std::string ImageFileName(StampNs stamp_ns, Eye eye) {
  return fmt::format("LocCam_{}_{}.png", FormatKatwijkStampAsRecorded(stamp_ns),
                     static_cast<int>(eye));
}

Photographer::Photographer(const World& world, const StereoRig& rig, const DrivePlan& plan,
                           const RoverMotion& motion)
    : rig_(rig),
      world_(world),
      plan_(plan),
      motion_(motion),
      renderers_{ViewRenderer(world, rig.left.camera), ViewRenderer(world, rig.right.camera)},
      rover_(MakeRoverBody()) {
  for (int i = 0; i < kStrides; ++i) {
    strides_.push_back(MakePersonBody(static_cast<double>(i) / kStrides));
  }
}

std::vector<PosedBody> Photographer::BodiesAt(const DriveFrame& frame) const {
  std::vector<PosedBody> bodies;
  if (frame.fault.shadow) bodies.push_back({rover_.get(), motion_.WorldFromBody(frame.time_s)});
  for (const FrameRange& range : plan_.faults.persons) {
    if (frame.index < range.first || frame.index >= range.end) continue;
    bodies.push_back({strides_[frame.index % kStrides].get(),
                      WorldFromPerson(plan_, world_, range, frame.time_s)});
  }
  return bodies;
}

cv::Mat Photographer::Take(const DriveFrame& frame, Eye eye) const {
  const auto bodies = BodiesAt(frame);
  const Camera& camera = rig_.Of(eye).camera;
  Shot shot{.exposure_gain = frame.fault.exposure_gain,
            .glare_area = frame.fault.glare_area,
            .glare_seed = static_cast<std::uint32_t>(plan_.clock.seed),
            // As the rover turns and nods the pattern wanders, equally in both eyes.
            .glare_column_px = 0.04 * camera.width * std::sin(0.37 * frame.index),
            .noise_seed = SeedOf(plan_, frame, eye)};
  if (frame.fault.black) {
    return TakePicture(cv::Mat::zeros(camera.height, camera.width, CV_32FC3), CameraResponse(),
                       {.noise_seed = shot.noise_seed});
  }
  const Rigid3 world_from_eye = eye == Eye::kLeft
                                    ? frame.world_from_left
                                    : frame.world_from_left * rig_.right_from_left.Inverse();
  return TakePicture(renderers_[static_cast<std::size_t>(eye)].Render(world_from_eye, bodies),
                     CameraResponse(), shot);
}

double Photographer::Write(const DriveFrame& frame, Eye eye,
                           const std::filesystem::path& folder) const {
  if (!frame.HasImage(eye)) return 0.0;
  const cv::Mat picture = Take(frame, eye);
  std::vector<unsigned char> bytes;
  cv::imencode(".png", picture, bytes, {cv::IMWRITE_PNG_COMPRESSION, 1});
  if (frame.fault.truncated == eye) bytes.resize(bytes.size() * 2 / 5);
  WriteFileAtomically(folder / ImageFileName(frame.stamp_ns, eye), [&](std::ostream& stream) {
    stream.write(reinterpret_cast<const char*>(bytes.data()),
                 static_cast<std::streamsize>(bytes.size()));
  });
  return SaturatedShare(picture);
}

}  // namespace rigmap

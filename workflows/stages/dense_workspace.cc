#include "workflows/stages/dense_workspace.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "colmap/dense_workspace.h"
#include "colmap/model_io.h"
#include "core/freed_memory.h"
#include "core/job.h"
#include "core/memory_peak.h"
#include "imaging/depth_images.h"
#include "imaging/disparity_normal.h"
#include "imaging/image.h"
#include "imaging/rectifier.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

std::string ViewName(const StereoFrame& frame) { return fmt::format("{}.png", frame.stamp_ns); }

// What shows in the pixel of the rectified view; nothing for one that lies outside.
std::optional<Eigen::Vector2d> RectifiedPixel(const Rectifier& rectifier, const Camera& left,
                                              const Eigen::Vector2d& pixel) {
  const std::optional<Eigen::Vector2d> ray = Undistort(left, pixel);
  if (!ray) return std::nullopt;
  const auto rectified = Project(rectifier.RectifiedCamera(),
                                 rectifier.LeftFromRectified().inverse() * ray->homogeneous());
  if (!rectified || !rectifier.RectifiedCamera().Contains(*rectified)) return std::nullopt;
  return rectified;
}

// The views without their points.
SparseModel PosedViews(const Dataset& dataset, const PosedPart& part,
                       const std::vector<int>& frames, const Rectifier& rectifier) {
  SparseModel model;
  model.cameras = {{Eye::kLeft, rectifier.RectifiedCamera()}};
  const Rigid3 left_from_rectified{rectifier.LeftFromRectified(), Eigen::Vector3d::Zero()};
  for (const int frame : frames) {
    const Rigid3 world_from_rectified =
        part.trajectory[frame].world_from_left * left_from_rectified;
    model.images.push_back(
        {{frame, Eye::kLeft}, ViewName(dataset.frames[frame]), world_from_rectified.Inverse(), {}});
  }
  return model;
}

// Adds the points that at least two of the views show. By how many of them views share, COLMAP
// tells neighbours.
void AddPoints(const PosedPart& part, const Rectifier& rectifier, SparseModel& model) {
  std::map<int, SparseImage*> image_of_frame;
  for (SparseImage& image : model.images) image_of_frame[image.ref.frame] = &image;
  const Camera& camera = rectifier.RectifiedCamera();
  for (const PosedPoint& posed : part.points) {
    std::vector<std::pair<SparseImage*, Eigen::Vector2d>> seen;
    double error_px = 0.0;
    for (const PointObservation& o : posed.in_left) {
      const auto image = image_of_frame.find(o.frame);
      if (image == image_of_frame.end()) continue;
      const auto pixel = RectifiedPixel(rectifier, part.rig.left.camera, o.pixel);
      const auto expected = Project(camera, image->second->camera_from_model * posed.x_in_world);
      if (!pixel || !expected) continue;
      seen.emplace_back(image->second, *pixel);
      error_px += (*pixel - *expected).norm();
    }
    if (seen.size() < 2) continue;
    SparsePoint point{.id = model.points.size() + 1, .x_in_model = posed.x_in_world};
    point.error_px = error_px / static_cast<double>(seen.size());
    for (const auto& [image, pixel] : seen) {
      point.track.push_back({image->ref, static_cast<std::uint32_t>(image->keypoints.size())});
      image->keypoints.push_back({pixel, point.id});
    }
    model.points.push_back(std::move(point));
  }
}

// Colours the points whose first view this is.
void ColourPoints(const SparseImage& image, const cv::Mat& view, SparseModel& model) {
  for (const SparseKeypoint& keypoint : image.keypoints) {
    SparsePoint& point = model.points[*keypoint.point_id - 1];
    if (point.track.front().image != image.ref) continue;
    const cv::Vec3b bgr = view.at<cv::Vec3b>(static_cast<int>(std::lround(keypoint.pixel.y())),
                                             static_cast<int>(std::lround(keypoint.pixel.x())));
    point.rgb = {bgr[2], bgr[1], bgr[0]};
  }
}

void WriteDepthAndNormals(const DepthMap& map, const std::string& name, const fs::path& folder) {
  const cv::Mat depth = DepthImage(map, 0.0F);
  cv::Mat normals(3 * depth.rows, depth.cols, CV_32FC1);
  std::vector<cv::Mat> channels;
  for (int i = 0; i < 3; ++i) {
    channels.push_back(normals.rowRange(i * depth.rows, (i + 1) * depth.rows));
  }
  cv::split(NormalsInRectified(map), channels);
  WriteStereoView({name,
                   depth.cols,
                   depth.rows,
                   {depth.ptr<float>(), depth.total()},
                   {normals.ptr<float>(), normals.total()}},
                  folder);
}

// How many frames may be written at once within what --memory allows the whole process.
int ThreadsWithin(const Camera& camera, const StageContext& context) {
  // The image as read and rectified, the map as kept and as read, depth and normals twice.
  constexpr double kBytesPerPixel = 70.0;
  const double frame_mb = 1e-6 * kBytesPerPixel * camera.width * camera.height;
  const double present_mb = ResidentMegabytes();
  return std::clamp(static_cast<int>((context.memory_mb - present_mb) / frame_mb), 1,
                    context.threads);
}

}  // namespace

void PublishDenseWorkspace(const Dataset& dataset, const PosedPart& part, const DepthIndex& depths,
                           const StageContext& context, Publication& publication) {
  if (depths.frames.empty()) return;
  const Rectifier rectifier(part.rig);
  SparseModel model = PosedViews(dataset, part, depths.frames, rectifier);
  AddPoints(part, rectifier, model);
  std::vector<std::string> names;
  for (const SparseImage& image : model.images) names.push_back(image.name);
  publication.Folder("dense_workspace", [&](const fs::path& folder) {
    const int threads = ThreadsWithin(rectifier.RectifiedCamera(), context);
    Job::Current()->RunWithThreads(threads, [&] {
      tbb::parallel_for(std::size_t{0}, names.size(), [&](std::size_t i) {
        const StereoFrame& frame = dataset.frames[depths.frames[i]];
        const cv::Mat view = rectifier.RectifyLeft(
            ReadColour(frame.left_path, part.rig.left.camera, frame.sample_bits));
        WriteImage(folder / "images" / names[i], view);
        ColourPoints(model.images[i], view, model);
        const FrameFile& file = depths.files[i];
        WriteDepthAndNormals(ReadDepth(file.In(context.root), file.key), names[i], folder);
        ReturnFreedMemory(0.5 * context.memory_mb);
      });
    });
    WriteModel(model, folder / "sparse");
    WriteStereoLists(names, folder);
  });
}

}  // namespace rigmap

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
#include "core/memory_share.h"
#include "imaging/depth_images.h"
#include "imaging/disparity_normal.h"
#include "imaging/image.h"
#include "imaging/rectifier.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

std::string ViewName(const StereoFrame& frame) { return fmt::format("{}.png", frame.stamp_ns); }

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

struct Observation {
  SparseImage* image;
  Eigen::Vector2d pixel;
};

// Adds a point that at least two of the views show. By how many of them views share, COLMAP tells
// neighbours.
void AddPoint(SparsePoint point, const std::vector<Observation>& seen, SparseModel& model) {
  if (seen.size() < 2) return;
  point.id = model.points.size() + 1;
  point.error_px = 0.0;
  const Camera& camera = model.cameras.front().camera;
  for (const auto& [image, pixel] : seen) {
    point.track.push_back({image->ref, static_cast<std::uint32_t>(image->keypoints.size())});
    image->keypoints.push_back({pixel, point.id});
    const auto expected = Project(camera, image->camera_from_model * point.x_in_model);
    if (expected) point.error_px += (pixel - *expected).norm() / static_cast<double>(seen.size());
  }
  model.points.push_back(std::move(point));
}

void AddPoints(const PosedPart& part, const Rectifier& rectifier, SparseModel& model) {
  std::map<int, SparseImage*> image_of_frame;
  for (SparseImage& image : model.images) image_of_frame[image.ref.frame] = &image;
  for (const PosedPoint& point : part.points) {
    std::vector<Observation> seen;
    for (const PointObservation& o : point.in_left) {
      const auto image = image_of_frame.find(o.frame);
      if (image == image_of_frame.end()) continue;
      const auto pixel = rectifier.RectifiedLeft(o.pixel);
      if (pixel) seen.push_back({image->second, *pixel});
    }
    AddPoint({.x_in_model = point.x_in_world}, seen, model);
  }
}

// A point of a depth map, with the pixel that shows it.
struct DepthSample {
  Eigen::Vector3d x_in_world;
  Eigen::Vector2d pixel;
  std::array<std::uint8_t, 3> rgb{};
};

std::array<std::uint8_t, 3> Rgb(const cv::Vec3b& bgr) { return {bgr[2], bgr[1], bgr[0]}; }

// Some hundred points, evenly over what is known.
std::vector<DepthSample> SampleDepth(const DepthMap& map, const cv::Mat& view,
                                     const Rigid3& world_from_rectified) {
  constexpr double kPixelsOfView = 400.0;
  const int step = std::max(1, static_cast<int>(std::sqrt(map.disparity.total() / kPixelsOfView)));
  std::vector<DepthSample> samples;
  for (int row = step / 2; row < map.disparity.rows; row += step) {
    for (int column = step / 2; column < map.disparity.cols; column += step) {
      const float disparity_px = map.disparity.at<float>(row, column);
      if (disparity_px <= 0.0F || map.disparity_sigma.at<float>(row, column) >= kUnsurePx) continue;
      samples.push_back({world_from_rectified * map.PointInRectified(column, row, disparity_px),
                         {column, row},
                         Rgb(view.at<cv::Vec3b>(row, column))});
    }
  }
  return samples;
}

// Where a view shows a point that another sees at a depth; nothing where it is twice as far or as
// near, for there is little to compare, or out of view. What hides the point is not asked.
std::optional<Eigen::Vector2d> PixelAtLikeDepth(const Camera& camera, const SparseImage& image,
                                                const Eigen::Vector3d& x_in_world, double depth_m) {
  const Eigen::Vector3d x = image.camera_from_model * x_in_world;
  if (x.z() < 0.5 * depth_m || x.z() > 2.0 * depth_m) return std::nullopt;
  const auto pixel = Project(camera, x);
  return pixel && camera.Contains(*pixel) ? pixel : std::nullopt;
}

// The points of a part that has none of its own: samples of each image's depth.
void AddSamples(const std::vector<std::vector<DepthSample>>& samples, SparseModel& model) {
  const Camera& camera = model.cameras.front().camera;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    SparseImage& own = model.images[i];
    for (const DepthSample& sample : samples[i]) {
      std::vector<Observation> seen{{&own, sample.pixel}};
      const double depth_m = (own.camera_from_model * sample.x_in_world).z();
      for (SparseImage& image : model.images) {
        if (&image == &own) continue;
        const auto pixel = PixelAtLikeDepth(camera, image, sample.x_in_world, depth_m);
        if (pixel) seen.push_back({&image, *pixel});
      }
      AddPoint({.x_in_model = sample.x_in_world, .rgb = sample.rgb}, seen, model);
    }
  }
}

// Colours the points whose first view this is.
void ColourPoints(const SparseImage& image, const cv::Mat& view, SparseModel& model) {
  for (const SparseKeypoint& keypoint : image.keypoints) {
    SparsePoint& point = model.points[*keypoint.point_id - 1];
    if (point.track.front().image != image.ref) continue;
    point.rgb = Rgb(view.at<cv::Vec3b>(static_cast<int>(std::lround(keypoint.pixel.y())),
                                       static_cast<int>(std::lround(keypoint.pixel.x()))));
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
  return std::clamp(static_cast<int>(MemoryShare(context.memory_mb) / frame_mb), 1,
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
  std::vector<std::vector<DepthSample>> samples(names.size());
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
        const DepthMap map = ReadDepth(file.In(context.root), file.key);
        WriteDepthAndNormals(map, names[i], folder);
        if (part.points.empty()) {
          samples[i] = SampleDepth(map, view, model.images[i].camera_from_model.Inverse());
        }
        ReturnFreedMemory(0.5 * context.memory_mb);
      });
    });
    if (part.points.empty()) AddSamples(samples, model);
    WriteModel(model, folder / "sparse");
    WriteStereoLists(names, folder);
  });
}

}  // namespace rigmap

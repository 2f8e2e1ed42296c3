#include "workflows/stages/sparse_output.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "adjustment/reprojection.h"
#include "colmap/model_io.h"
#include "core/file.h"
#include "export/ply.h"
#include "imaging/image.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

std::array<std::uint8_t, 3> ColourAt(const cv::Mat& image, const Eigen::Vector2d& pixel) {
  const int x = std::clamp(static_cast<int>(std::lround(pixel.x())), 0, image.cols - 1);
  const int y = std::clamp(static_cast<int>(std::lround(pixel.y())), 0, image.rows - 1);
  const cv::Vec3b bgr = image.at<cv::Vec3b>(y, x);
  return {bgr[2], bgr[1], bgr[0]};
}

// Colours the points by their first observation, a left one if there is any.
void Colour(const Dataset& dataset, const Adjustment& adjustment, SparseModel& model) {
  using Image = std::pair<int, Eye>;
  std::map<Image, std::vector<std::size_t>> by_image;
  for (std::size_t i = 0; i < adjustment.points.size(); ++i) {
    const auto& first = adjustment.points[i].observations.front();
    by_image[{first.frame, first.eye}].push_back(i);
  }
  const std::vector<std::pair<Image, std::vector<std::size_t>>> images(by_image.begin(),
                                                                       by_image.end());
  tbb::parallel_for(std::size_t{0}, images.size(), [&](std::size_t f) {
    const auto [index, eye] = images[f].first;
    const StereoFrame& frame = dataset.frames[index];
    const cv::Mat image =
        ReadColour(frame.PathOf(eye), dataset.rig.Of(eye).camera, frame.sample_bits);
    for (const std::size_t i : images[f].second) {
      model.points[i].rgb = ColourAt(image, adjustment.points[i].observations.front().pixel);
    }
  });
}

// Which file each of COLMAP's image names stands for, in the folder that it came from.
std::string ImageNames(const Dataset& dataset) {
  std::string table = "image,original\n";
  for (const StereoFrame& frame : dataset.frames) {
    for (const Eye eye : kEyes) {
      const fs::path path = frame.PathOf(eye);
      const fs::path original = path.parent_path().filename() / path.filename();
      table += fmt::format("{},{}\n", ImageName(frame, eye), original.string());
    }
  }
  return table;
}

}  // namespace

SparseModel MakeSparseOutput(const Dataset& dataset, const Adjustment& adjustment,
                             const Rigid3& world_from_gauge) {
  SparseModel model;
  const StereoRig& rig = adjustment.rig;
  model.cameras = {{Eye::kLeft, rig.left.camera}, {Eye::kRight, rig.right.camera}};
  std::vector<std::size_t> first_image(dataset.frames.size(), 0);
  std::vector<Rigid3> left_from_gauge(dataset.frames.size());
  for (std::size_t i = 0; i < dataset.frames.size(); ++i) {
    const auto& pose = adjustment.world_from_left[i];
    if (!pose) continue;
    first_image[i] = model.images.size();
    left_from_gauge[i] = pose->Inverse();
    const Rigid3 left_from_world = (world_from_gauge * *pose).Inverse();
    const int frame = static_cast<int>(i);
    model.images.push_back(
        {{frame, Eye::kLeft}, ImageName(dataset.frames[i], Eye::kLeft), left_from_world});
    model.images.push_back({{frame, Eye::kRight},
                            ImageName(dataset.frames[i], Eye::kRight),
                            rig.right_from_left * left_from_world});
  }
  for (const AdjustedPoint& adjusted : adjustment.points) {
    SparsePoint point{.id = model.points.size() + 1, .x_in_model = world_from_gauge * adjusted.x};
    double error_px = 0.0;
    for (const PointObservation& o : adjusted.observations) {
      SparseImage& image = model.images[first_image[o.frame] + (o.eye == Eye::kLeft ? 0 : 1)];
      point.track.push_back({image.ref, static_cast<std::uint32_t>(image.keypoints.size())});
      image.keypoints.push_back({o.pixel, point.id});
      const auto seen = Reproject(rig, o.eye, left_from_gauge[o.frame], adjusted.x);
      if (seen) error_px += (seen->pixel - o.pixel).norm();
    }
    point.error_px = error_px / static_cast<double>(adjusted.observations.size());
    model.points.push_back(std::move(point));
  }
  Colour(dataset, adjustment, model);
  return model;
}

void PublishSparse(const SparseModel& model, const Dataset& dataset, Publication& publication) {
  publication.Folder("sparse", [&](const fs::path& folder) {
    WriteModel(model, folder);
    WriteFileAtomically(folder / "image_names.csv",
                        [&](std::ostream& stream) { stream << ImageNames(dataset); });
  });
  publication.File("sparse.ply",
                   [&](std::ostream& stream) { WriteSparsePly(stream, model.points); });
}

}  // namespace rigmap

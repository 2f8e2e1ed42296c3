#include "colmap/model_io.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <ostream>
#include <set>
#include <string>
#include <type_traits>
#include <unordered_map>

#include "colmap/internal/camera_model.h"
#include "colmap/internal/image_ids.h"
#include "core/error.h"
#include "core/file.h"

namespace rigmap {
namespace {

static_assert(std::endian::native == std::endian::little, "the files are little endian");

constexpr const char* kCamerasFile = "cameras.bin";
constexpr const char* kImagesFile = "images.bin";
constexpr const char* kPointsFile = "points3D.bin";
constexpr auto kNoPoint = std::numeric_limits<std::uint64_t>::max();
constexpr std::uint64_t kLargestImageSide = 1'000'000;  // px; beyond, the file is damaged
// Smallest sizes of an entry in bytes: a count that asks for more than the file holds is damaged.
constexpr std::size_t kCameraBytes = 24, kImageBytes = 73, kKeypointBytes = 24, kPointBytes = 51,
                      kTrackBytes = 8;

const Eigen::Vector2d kShift(kColmapPixelShift, kColmapPixelShift);

// A file in memory with the place up to which it was read.
class Reader {
 public:
  explicit Reader(std::filesystem::path path) : path_(std::move(path)), text_(ReadBytes(path_)) {}

  template <class Value>
  Value Take() {
    static_assert(std::is_trivially_copyable_v<Value>);
    if (text_.size() - offset_ < sizeof(Value)) throw Damaged("it is truncated");
    Value value;
    std::memcpy(&value, text_.data() + offset_, sizeof(Value));
    offset_ += sizeof(Value);
    return value;
  }

  double TakeFinite() {
    const auto value = Take<double>();
    if (!std::isfinite(value)) throw Damaged("expected a finite number");
    return value;
  }

  std::size_t TakeCount(std::size_t bytes_each) {
    const auto count = Take<std::uint64_t>();
    if (count > (text_.size() - offset_) / bytes_each) {
      throw Damaged(fmt::format("it is truncated or damaged, it announces {} entries", count));
    }
    return static_cast<std::size_t>(count);
  }

  std::string TakeName() {
    const auto end = text_.find('\0', offset_);
    if (end == std::string::npos) throw Damaged("it is truncated");
    std::string name = text_.substr(offset_, end - offset_);
    offset_ = end + 1;
    return name;
  }

  void RequireEnd() const {
    if (offset_ != text_.size()) throw Damaged("expected the end of the file");
  }

  DataError Damaged(const std::string& sentence) const {
    return DataError(
        fmt::format("{}: {} (at byte {} of {})", path_.string(), sentence, offset_, text_.size()));
  }

 private:
  std::filesystem::path path_;
  std::string text_;
  std::size_t offset_ = 0;
};

SparseCamera ReadCamera(Reader& reader) {
  const auto id = reader.Take<std::uint32_t>();
  const Eye eye = id == CameraIdOf(Eye::kLeft) ? Eye::kLeft : Eye::kRight;
  if (id != CameraIdOf(eye)) {
    throw reader.Damaged(fmt::format("expected camera 1 (left) or 2 (right), found {}", id));
  }
  ColmapCamera camera{.model = reader.Take<std::int32_t>(), .parameters = {}};
  const auto width = reader.Take<std::uint64_t>(), height = reader.Take<std::uint64_t>();
  if (width > kLargestImageSide || height > kLargestImageSide) {
    throw reader.Damaged(fmt::format("found an image size of {} x {}", width, height));
  }
  const auto count = ParameterCount(camera.model);
  if (!count) {
    throw reader.Damaged(fmt::format(
        "expected camera model PINHOLE, OPENCV or FULL_OPENCV, found {}", ModelName(camera.model)));
  }
  for (std::size_t i = 0; i < *count; ++i) camera.parameters.push_back(reader.TakeFinite());
  return {eye, FromColmap(camera, static_cast<int>(width), static_cast<int>(height))};
}

ImageRef TakeImage(Reader& reader) {
  const auto id = reader.Take<std::uint32_t>();
  if (id == 0) throw reader.Damaged("expected image ids from 1, found 0");
  return ImageOf(id);
}

std::vector<SparseKeypoint> ReadKeypoints(Reader& reader) {
  std::vector<SparseKeypoint> keypoints(reader.TakeCount(kKeypointBytes));
  for (auto& keypoint : keypoints) {
    const double x = reader.TakeFinite(), y = reader.TakeFinite();
    keypoint.pixel = Eigen::Vector2d(x, y) - kShift;
    const auto point_id = reader.Take<std::uint64_t>();
    if (point_id != kNoPoint) keypoint.point_id = point_id;
  }
  return keypoints;
}

Rigid3 ReadPose(Reader& reader) {
  Rigid3 pose;
  pose.rotation.w() = reader.TakeFinite();
  for (int i = 0; i < 3; ++i) pose.rotation.vec()[i] = reader.TakeFinite();
  for (int i = 0; i < 3; ++i) pose.translation[i] = reader.TakeFinite();
  const double norm = pose.rotation.norm();
  if (!(norm > 0.5 && norm < 2.0)) throw reader.Damaged("expected a unit quaternion");
  if (std::abs(norm - 1.0) > 1e-9) pose.rotation.normalize();  // else left as it is, bit by bit
  return pose;
}

SparseImage ReadImage(Reader& reader) {
  SparseImage image;
  image.ref = TakeImage(reader);
  image.camera_from_model = ReadPose(reader);
  const auto camera = reader.Take<std::uint32_t>();
  if (camera != CameraIdOf(image.ref.eye)) {
    throw reader.Damaged(fmt::format("expected image {} to be of camera {}, found camera {}",
                                     ImageIdOf(image.ref), CameraIdOf(image.ref.eye), camera));
  }
  image.name = reader.TakeName();
  image.keypoints = ReadKeypoints(reader);
  return image;
}

SparsePoint ReadPoint(Reader& reader) {
  SparsePoint point;
  point.id = reader.Take<std::uint64_t>();
  for (int i = 0; i < 3; ++i) point.x_in_model[i] = reader.TakeFinite();
  for (auto& value : point.rgb) value = reader.Take<std::uint8_t>();
  point.error_px = reader.TakeFinite();
  point.track.resize(reader.TakeCount(kTrackBytes));
  for (auto& element : point.track) {
    element.image = TakeImage(reader);
    element.keypoint = reader.Take<std::uint32_t>();
  }
  return point;
}

template <class Entry>
std::vector<Entry> ReadAll(const std::filesystem::path& path, std::size_t bytes_each,
                           Entry (*read)(Reader&)) {
  Reader reader(path);
  const std::size_t count = reader.TakeCount(bytes_each);
  std::vector<Entry> entries;
  entries.reserve(count);
  for (std::size_t i = 0; i < count; ++i) entries.push_back(read(reader));
  reader.RequireEnd();
  return entries;
}

void CheckReferences(const SparseModel& model, const std::filesystem::path& folder) {
  const auto require = [&](bool holds, const char* file, const std::string& sentence) {
    if (!holds) throw DataError(fmt::format("{}: {}", (folder / file).string(), sentence));
  };
  std::set<Eye> cameras;
  for (const auto& [eye, camera] : model.cameras) cameras.insert(eye);
  std::unordered_map<std::uint32_t, std::size_t> keypoint_counts;
  for (const auto& image : model.images) {
    const std::uint32_t id = ImageIdOf(image.ref);
    require(cameras.contains(image.ref.eye), kImagesFile,
            fmt::format("image {} names camera {}, which does not exist", id,
                        CameraIdOf(image.ref.eye)));
    keypoint_counts.emplace(id, image.keypoints.size());
  }
  for (const auto& point : model.points) {
    for (const auto& [image, keypoint] : point.track) {
      const auto count = keypoint_counts.find(ImageIdOf(image));
      require(count != keypoint_counts.end() && keypoint < count->second, kPointsFile,
              fmt::format("point {} names keypoint {} of image {}, which does not exist", point.id,
                          keypoint, ImageIdOf(image)));
    }
  }
}

template <class Value>
void Put(std::ostream& stream, Value value) {
  static_assert(std::is_trivially_copyable_v<Value>);
  stream.write(reinterpret_cast<const char*>(&value), sizeof(value));
}

void PutCount(std::ostream& stream, std::size_t count) {
  Put(stream, static_cast<std::uint64_t>(count));
}

void WriteCameras(std::ostream& stream, const std::vector<SparseCamera>& cameras) {
  PutCount(stream, cameras.size());
  for (const auto& [eye, camera] : cameras) {
    const ColmapCamera converted = ToColmap(camera);
    Put(stream, CameraIdOf(eye));
    Put(stream, static_cast<std::int32_t>(converted.model));
    Put(stream, static_cast<std::uint64_t>(camera.width));
    Put(stream, static_cast<std::uint64_t>(camera.height));
    for (const double value : converted.parameters) Put(stream, value);
  }
}

void WriteImages(std::ostream& stream, const std::vector<SparseImage>& images) {
  PutCount(stream, images.size());
  for (const auto& image : images) {
    Put(stream, ImageIdOf(image.ref));
    Put(stream, image.camera_from_model.rotation.w());
    for (int i = 0; i < 3; ++i) Put(stream, image.camera_from_model.rotation.vec()[i]);
    for (int i = 0; i < 3; ++i) Put(stream, image.camera_from_model.translation[i]);
    Put(stream, CameraIdOf(image.ref.eye));
    stream.write(image.name.c_str(), static_cast<std::streamsize>(image.name.size() + 1));
    PutCount(stream, image.keypoints.size());
    for (const auto& keypoint : image.keypoints) {
      const Eigen::Vector2d pixel = keypoint.pixel + kShift;
      Put(stream, pixel.x());
      Put(stream, pixel.y());
      Put(stream, keypoint.point_id.value_or(kNoPoint));
    }
  }
}

void WritePoints(std::ostream& stream, const std::vector<SparsePoint>& points) {
  PutCount(stream, points.size());
  for (const auto& point : points) {
    Put(stream, point.id);
    for (int i = 0; i < 3; ++i) Put(stream, point.x_in_model[i]);
    for (const std::uint8_t value : point.rgb) Put(stream, value);
    Put(stream, point.error_px);
    PutCount(stream, point.track.size());
    for (const auto& element : point.track) {
      Put(stream, ImageIdOf(element.image));
      Put(stream, element.keypoint);
    }
  }
}

}  // namespace

SparseModel ReadModel(const std::filesystem::path& folder) {
  SparseModel model;
  model.cameras = ReadAll(folder / kCamerasFile, kCameraBytes, &ReadCamera);
  model.images = ReadAll(folder / kImagesFile, kImageBytes, &ReadImage);
  model.points = ReadAll(folder / kPointsFile, kPointBytes, &ReadPoint);
  CheckReferences(model, folder);
  return model;
}

void WriteModel(const SparseModel& model, const std::filesystem::path& folder) {
  WriteFileAtomically(folder / kCamerasFile,
                      [&](std::ostream& stream) { WriteCameras(stream, model.cameras); });
  WriteFileAtomically(folder / kImagesFile,
                      [&](std::ostream& stream) { WriteImages(stream, model.images); });
  WriteFileAtomically(folder / kPointsFile,
                      [&](std::ostream& stream) { WritePoints(stream, model.points); });
}

bool HasModel(const std::filesystem::path& folder) {
  for (const char* file : {kCamerasFile, kImagesFile, kPointsFile}) {
    if (!std::filesystem::is_regular_file(folder / file)) return false;
  }
  return true;
}

}  // namespace rigmap

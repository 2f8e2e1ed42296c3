#include "fusion/internal/voxel_grid.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <fstream>
#include <limits>
#include <system_error>
#include <type_traits>

#include "core/error.h"

namespace rigmap {
namespace {

constexpr double kReach_m = 100'000.0;  // where a float is good to 8 mm
constexpr int kAxisBits = 21;
constexpr std::int64_t kHalf = std::int64_t{1} << (kAxisBits - 1);
constexpr std::uint64_t kAxisMask = (std::uint64_t{1} << kAxisBits) - 1;

// `cube`: counted from the grid's corner.
std::uint64_t KeyOf(const Eigen::Vector3d& cube) {
  std::uint64_t key = 0;
  for (const double value : cube) {
    if (!(std::abs(value) < static_cast<double>(kHalf - 1))) {
      throw DataError(
          fmt::format("fusion: expected points within {} voxels of their tile, found one {:g} off",
                      kHalf, value));
    }
    key = (key << kAxisBits) | static_cast<std::uint64_t>(static_cast<std::int64_t>(value) + kHalf);
  }
  return key;
}

Eigen::Vector3d CubeOf(std::uint64_t key) {
  const auto axis = [key](int shift) {
    return static_cast<double>(static_cast<std::int64_t>((key >> shift) & kAxisMask) - kHalf);
  };
  return {axis(2 * kAxisBits), axis(kAxisBits), axis(0)};
}

void AddTo(std::array<float, 3>& sum, const Eigen::Vector3f& value) {
  Eigen::Map<Eigen::Vector3f>(sum.data()) += value;
}

// The finaliser of splitmix64 (Steele et al. 2014): every key bit changes half of the hash's.
std::size_t HashOf(std::uint64_t key) {
  key = (key ^ (key >> 30U)) * 0xBF58476D1CE4E5B9ULL;
  key = (key ^ (key >> 27U)) * 0x94D049BB133111EBULL;
  return key ^ (key >> 31U);
}

}  // namespace

float SurfaceSample::OffSurfaceM() const {
  constexpr float kRoughness = 0.4F;  // slope; docs/measured.md, "Sigmas of points"
  return shared * sigma_m *
         std::hypot(cosine, kRoughness * std::sqrt(std::max(0.0F, 1.0F - cosine * cosine)));
}

VoxelGrid::VoxelGrid(double voxel_m, const Eigen::Vector2d& corner_in_world)
    : voxel_m_(voxel_m), slots_(kFirstSlots, kEmpty) {
  corner_ << (corner_in_world / voxel_m).array().floor(), 0.0;
}

void VoxelGrid::Add(const SurfaceSample& sample) {
  if (!(sample.x_in_world.cwiseAbs().maxCoeff() <= kReach_m)) {
    throw DataError(fmt::format("fusion: expected points within {} m of the origin, found {:g} m",
                                kReach_m, sample.x_in_world.cwiseAbs().maxCoeff()));
  }
  const Eigen::Vector3d x_in_voxels = sample.x_in_world / voxel_m_;
  Voxel& voxel = At(KeyOf(x_in_voxels.array().floor().matrix() - corner_));
  const float weight = 1.0F / (sample.sigma_m * sample.sigma_m);
  AddTo(voxel.offset, weight * (x_in_voxels - (corner_ + CubeOf(voxel.key))).cast<float>());
  AddTo(voxel.normal, weight * sample.normal);
  AddTo(voxel.rgb, weight * Eigen::Vector3f(sample.rgb[0], sample.rgb[1], sample.rgb[2]));
  voxel.weight += weight;
  voxel.observations += static_cast<std::uint32_t>(sample.observations);
  const float off_m = sample.OffSurfaceM();
  voxel.off += weight * off_m * off_m;
}

VoxelGrid::Voxel& VoxelGrid::At(std::uint64_t key) {
  if (2 * voxels_.size() >= slots_.size()) Index(2 * slots_.size());
  const std::size_t mask = slots_.size() - 1;
  std::size_t slot = HashOf(key) & mask;
  while (slots_[slot] != kEmpty && voxels_[slots_[slot]].key != key) slot = (slot + 1) & mask;
  if (slots_[slot] == kEmpty) {
    slots_[slot] = static_cast<std::uint32_t>(voxels_.size());
    voxels_.emplace_back().key = key;
  }
  return voxels_[slots_[slot]];
}

void VoxelGrid::Index(std::size_t slot_count) {
  slots_.assign(slot_count, kEmpty);
  const std::size_t mask = slots_.size() - 1;
  for (std::uint32_t i = 0; i < voxels_.size(); ++i) {
    std::size_t slot = HashOf(voxels_[i].key) & mask;
    while (slots_[slot] != kEmpty) slot = (slot + 1) & mask;
    slots_[slot] = i;
  }
}

SurfacePoint VoxelGrid::PointOf(const Voxel& voxel) const {
  SurfacePoint point;
  const Eigen::Map<const Eigen::Vector3f> sum(voxel.offset.data()), normal(voxel.normal.data());
  const Eigen::Vector3d offset = (sum / voxel.weight).cast<double>();
  point.x_in_world = (voxel_m_ * (corner_ + CubeOf(voxel.key) + offset)).cast<float>();
  const float length = normal.norm();
  if (length > 0.0F) point.normal = normal / length;
  for (int i = 0; i < 3; ++i) {
    point.rgb[i] = static_cast<std::uint8_t>(std::lround(voxel.rgb[i] / voxel.weight));
  }
  constexpr std::uint32_t kMost = std::numeric_limits<std::uint16_t>::max();
  point.observations = static_cast<std::uint16_t>(std::min(voxel.observations, kMost));
  point.grain_m = static_cast<float>(voxel_m_);
  // Of one sample, not of the mean: they share their frames' errors.
  point.sigma_m = std::sqrt(voxel.off / voxel.weight);
  return point;
}

PointCloud VoxelGrid::Points(int min_observations, double max_sigma_m) const {
  std::vector<std::uint32_t> order;
  for (std::uint32_t i = 0; i < voxels_.size(); ++i) {
    if (voxels_[i].observations >= static_cast<std::uint32_t>(min_observations)) order.push_back(i);
  }
  std::sort(order.begin(), order.end(),
            [this](std::uint32_t a, std::uint32_t b) { return voxels_[a].key < voxels_[b].key; });
  PointCloud points;
  points.reserve(order.size());
  for (const std::uint32_t i : order) {
    const SurfacePoint point = PointOf(voxels_[i]);
    if (point.sigma_m <= max_sigma_m) points.push_back(point);
  }
  return points;
}

void VoxelGrid::Save(const std::filesystem::path& path) const {
  static_assert(std::is_trivially_copyable_v<Voxel>);
  const std::uint64_t count = voxels_.size();
  std::ofstream stream(path, std::ios::binary);
  stream.write(reinterpret_cast<const char*>(&count), sizeof(count));
  stream.write(reinterpret_cast<const char*>(voxels_.data()),
               static_cast<std::streamsize>(count * sizeof(Voxel)));
  stream.close();
  if (!stream) {
    throw DataError(fmt::format("{}: expected to write {} voxels, found no room or no permission",
                                path.string(), count));
  }
}

void VoxelGrid::Load(const std::filesystem::path& path) {
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(path, error);
  if (error) {
    throw DataError(
        fmt::format("{}: expected voxels set aside, found: {}", path.string(), error.message()));
  }
  // The count tells a file that was cut between two voxels.
  std::uint64_t count = 0;
  std::ifstream stream(path, std::ios::binary);
  stream.read(reinterpret_cast<char*>(&count), sizeof(count));
  if (stream && count == (bytes - sizeof(count)) / sizeof(Voxel)) {
    voxels_.resize(count);
    stream.read(reinterpret_cast<char*>(voxels_.data()),
                static_cast<std::streamsize>(count * sizeof(Voxel)));
  } else {
    stream.setstate(std::ios::failbit);
  }
  if (!stream) {
    throw DataError(fmt::format("{}: expected {} voxels set aside, found a file of {} bytes",
                                path.string(), count, bytes));
  }
  Index(std::max(kFirstSlots, std::bit_ceil(4 * voxels_.size())));
}

}  // namespace rigmap

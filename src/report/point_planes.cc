#include "report/point_planes.h"

#include <fmt/format.h>
#include <oneapi/tbb/parallel_for.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <stdexcept>

#include "report/base64.h"

namespace rigmap {
namespace {

constexpr int kBitsOfAxis = 21;
constexpr int kDeflateLevel = 6;
constexpr std::size_t kPlanes = 18;

struct SteppedPoint {
  std::uint64_t morton = 0;
  std::array<std::uint32_t, 3> steps{};
  std::uint32_t index = 0;
};

// Two zero bits after each of the lowest 21.
std::uint64_t Spread(std::uint64_t bits) {
  bits &= (1ULL << kBitsOfAxis) - 1;
  bits = (bits | bits << 32) & 0x1f00000000ffffULL;
  bits = (bits | bits << 16) & 0x1f0000ff0000ffULL;
  bits = (bits | bits << 8) & 0x100f00f00f00f00fULL;
  bits = (bits | bits << 4) & 0x10c30c30c30c30c3ULL;
  return (bits | bits << 2) & 0x1249249249249249ULL;
}

struct BoundsOfPoints {
  Eigen::Vector3d low = Eigen::Vector3d::Constant(INFINITY);
  Eigen::Vector3d high = Eigen::Vector3d::Constant(-INFINITY);
};

BoundsOfPoints BoundsOf(const PointCloud& points) {
  BoundsOfPoints bounds;
  for (const SurfacePoint& point : points) {
    bounds.low = bounds.low.cwiseMin(point.x_in_world.cast<double>());
    bounds.high = bounds.high.cwiseMax(point.x_in_world.cast<double>());
  }
  return bounds;
}

std::vector<SteppedPoint> SortByMorton(const PointCloud& points, const PackedPoints& packed) {
  std::vector<SteppedPoint> sorted(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    SteppedPoint& point = sorted[i];
    point.index = i;
    for (int axis = 0; axis < 3; ++axis) {
      const double steps =
          (double{points[i].x_in_world[axis]} - packed.origin_m[axis]) / packed.step_m;
      point.steps[axis] = static_cast<std::uint32_t>(std::lround(std::max(steps, 0.0)));
      point.morton |= Spread(point.steps[axis]) << axis;
    }
  }
  std::ranges::sort(sorted, {}, [](const auto& p) { return std::pair(p.morton, p.index); });
  return sorted;
}

std::uint8_t CodeOf(double value, double per_octave, double offset) {
  return static_cast<std::uint8_t>(
      std::clamp(std::lround(offset + per_octave * std::log2(value)), 0L, 255L));
}

std::uint8_t SigmaCode(const SurfacePoint& point) {
  return point.sigma_m > 0.0F ? std::max<std::uint8_t>(1, CodeOf(point.sigma_m / 1e-5, 12.0, 1.0))
                              : std::uint8_t{0};
}
std::uint8_t ObservationsCode(const SurfacePoint& point) {
  return CodeOf(std::max<int>(point.observations, 1), 16.0, 0.0);
}

class PlaneWriter {
 public:
  explicit PlaneWriter(std::size_t count) : count_(count), bytes_(kPlanes * count) {}

  void Steps(std::size_t at, int axis, std::uint32_t steps) {
    const auto change = static_cast<std::int32_t>(steps - last_steps_[axis]);
    last_steps_[axis] = steps;
    const auto coded =
        (static_cast<std::uint32_t>(change) << 1) ^ static_cast<std::uint32_t>(change >> 31);
    for (std::size_t byte = 0; byte < 4; ++byte) {
      Put(4 * static_cast<std::size_t>(axis) + byte, at,
          static_cast<std::uint8_t>(coded >> (8 * byte)));
    }
  }
  void Colour(std::size_t at, const std::array<std::uint8_t, 3>& rgb) {
    const std::array<std::uint8_t, 3> now{rgb[1], static_cast<std::uint8_t>(rgb[0] - rgb[1]),
                                          static_cast<std::uint8_t>(rgb[2] - rgb[1])};
    for (std::size_t i = 0; i < 3; ++i) {
      Put(12 + i, at, static_cast<std::uint8_t>(now[i] - last_colour_[i]));
    }
    last_colour_ = now;
  }
  void Put(std::size_t plane, std::size_t at, std::uint8_t byte) {
    bytes_[plane * count_ + at] = byte;
  }
  const std::vector<std::uint8_t>& bytes() const { return bytes_; }

 private:
  std::size_t count_;
  std::vector<std::uint8_t> bytes_;
  std::array<std::uint32_t, 3> last_steps_{};
  std::array<std::uint8_t, 3> last_colour_{};
};

std::string DeflatedText(const std::vector<std::uint8_t>& bytes) {
  uLongf size = compressBound(bytes.size());
  std::vector<std::uint8_t> deflated(size);
  if (compress2(deflated.data(), &size, bytes.data(), bytes.size(), kDeflateLevel) != Z_OK) {
    throw std::runtime_error("zlib cannot deflate the points of a report");
  }
  return Base64({deflated.data(), size});
}

PackedLevel PackLevel(const std::vector<SteppedPoint>& order, const PointCloud& points,
                      double finest_m) {
  PlaneWriter planes(order.size());
  for (std::size_t at = 0; at < order.size(); ++at) {
    const SurfacePoint& point = points[order[at].index];
    for (int axis = 0; axis < 3; ++axis) planes.Steps(at, axis, order[at].steps[axis]);
    planes.Colour(at, point.rgb);
    planes.Put(15, at, SigmaCode(point));
    planes.Put(16, at, ObservationsCode(point));
    const double grain_m = point.grain_m > 0.0F ? point.grain_m : finest_m;
    planes.Put(17, at, CodeOf(grain_m / finest_m, 4.0, 0.0));
  }
  return {order.size(), DeflatedText(planes.bytes())};
}

// Without the share left out at either end.
template <class Value, class Get>
std::array<Value, 2> UsualRange(const PointCloud& points, const Get& get, double left_out = 0.02) {
  std::vector<Value> values;
  values.reserve(points.size());
  for (const SurfacePoint& point : points) values.push_back(get(point));
  const auto at = [&](double share) {
    const auto nth = values.begin() +
                     static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
    std::ranges::nth_element(values, nth);
    return *nth;
  };
  const Value low = at(left_out);
  return {low, at(1.0 - left_out)};
}

void PutRanges(const PointCloud& points, PackedPoints& packed) {
  packed.height_range_m =
      UsualRange<double>(points, [](const auto& p) { return double{p.x_in_world.z()}; });
  packed.sigma_range = UsualRange<int>(points, SigmaCode);
  packed.observations_range = UsualRange<int>(points, ObservationsCode);
  for (int axis = 0; axis < 3; ++axis) {
    const auto range = UsualRange<double>(
        points, [&](const auto& p) { return double{p.x_in_world[axis]}; }, 0.1);
    for (std::size_t end = 0; end < 2; ++end) packed.bounds_m[end][axis] = range[end];
  }
}

}  // namespace

PackedPoints PackPoints(const PointCloud& points, double finest_m) {
  PackedPoints packed;
  if (points.empty()) return packed;
  const BoundsOfPoints bounds = BoundsOf(points);
  const double extent_m = (bounds.high - bounds.low).maxCoeff();
  packed.finest_m = finest_m > 0.0 ? finest_m : std::max(extent_m / 1000.0, 1e-6);
  packed.step_m = std::max(packed.finest_m / 10.0, extent_m / ((1 << kBitsOfAxis) - 1));
  for (int axis = 0; axis < 3; ++axis) packed.origin_m[axis] = bounds.low[axis];
  PutRanges(points, packed);
  std::array<std::vector<SteppedPoint>, 3> orders;
  const auto sorted = SortByMorton(points, packed);
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    orders[i % 64 == 0 ? 0 : i % 8 == 0 ? 1 : 2].push_back(sorted[i]);
  }
  packed.levels.resize(orders.size());
  oneapi::tbb::parallel_for(std::size_t{0}, orders.size(), [&](std::size_t level) {
    packed.levels[level] = PackLevel(orders[level], points, packed.finest_m);
  });
  std::erase_if(packed.levels, [](const PackedLevel& level) { return level.count == 0; });
  return packed;
}

Json DescribePoints(const PackedPoints& packed, std::uint64_t count_in_map) {
  Json levels = Json::array();
  for (std::size_t i = 0; i < packed.levels.size(); ++i) {
    levels.push_back({{"id", fmt::format("points-{}", i)}, {"count", packed.levels[i].count}});
  }
  return {{"origin", packed.origin_m},         {"step_m", packed.step_m},
          {"finest_m", packed.finest_m},       {"height_range_m", packed.height_range_m},
          {"sigma_range", packed.sigma_range}, {"observations_range", packed.observations_range},
          {"count_in_map", count_in_map},      {"levels", std::move(levels)}};
}

}  // namespace rigmap

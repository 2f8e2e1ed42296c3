#include "export/ply.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <ostream>
#include <string>
#include <type_traits>

#include "core/error.h"

namespace rigmap {
namespace {

static_assert(std::endian::native == std::endian::little, "PLY rows are copied as they lie");

constexpr std::size_t kPointsPerBlock = 4096;

constexpr const char* kSurfaceProperties =
    "property float x\nproperty float y\nproperty float z\n"
    "property float nx\nproperty float ny\nproperty float nz\n"
    "property uchar red\nproperty uchar green\nproperty uchar blue\n"
    "property ushort observations\nproperty float sigma\nproperty float grain\n";

constexpr const char* kSparseProperties =
    "property float x\nproperty float y\nproperty float z\n"
    "property uchar red\nproperty uchar green\nproperty uchar blue\n"
    "property float error\nproperty uint track_length\n";

// Of the same length for every count: blanks at the end of a comment make up for missing digits.
std::string HeaderText(std::uint64_t count, const char* properties) {
  const std::string digits = fmt::format("{}", count);
  constexpr std::size_t kMaxDigits = 20;
  return fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment lengths in metres{:{}}\n"
      "element vertex {}\n{}end_header\n",
      "", kMaxDigits - digits.size(), digits, properties);
}

template <class Scalar>
void Append(std::string& bytes, Scalar value) {
  static_assert(std::is_arithmetic_v<Scalar>);
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

void AppendRgb(std::string& bytes, const std::array<std::uint8_t, 3>& rgb) {
  for (const std::uint8_t channel : rgb) Append(bytes, channel);
}

void AppendPoint(std::string& bytes, const SurfacePoint& point) {
  for (int i = 0; i < 3; ++i) Append(bytes, point.x_in_world(i));
  for (int i = 0; i < 3; ++i) Append(bytes, point.normal(i));
  AppendRgb(bytes, point.rgb);
  Append(bytes, point.observations);
  Append(bytes, point.sigma_m);
  Append(bytes, point.grain_m);
}

void RequireWritten(const std::ostream& stream) {
  if (!stream) throw DataError("cannot write a point cloud: the stream failed");
}

}  // namespace

PlyWriter::PlyWriter(std::ostream& stream) : stream_(stream), start_(stream.tellp()) {
  stream_ << HeaderText(0, kSurfaceProperties);
}

void PlyWriter::Write(std::span<const SurfacePoint> points) {
  std::string bytes;
  for (std::size_t begin = 0; begin < points.size(); begin += kPointsPerBlock) {
    bytes.clear();
    const auto count = std::min(kPointsPerBlock, points.size() - begin);
    for (const SurfacePoint& point : points.subspan(begin, count)) AppendPoint(bytes, point);
    stream_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  }
  point_count_ += points.size();
  RequireWritten(stream_);
}

void PlyWriter::Finish() {
  stream_.seekp(start_);
  stream_ << HeaderText(point_count_, kSurfaceProperties);
  stream_.seekp(0, std::ios::end);
  RequireWritten(stream_);
}

void WriteSparsePly(std::ostream& stream, const std::vector<SparsePoint>& points) {
  std::string bytes = HeaderText(points.size(), kSparseProperties);
  for (const SparsePoint& point : points) {
    for (int i = 0; i < 3; ++i) Append(bytes, static_cast<float>(point.x_in_model(i)));
    AppendRgb(bytes, point.rgb);
    Append(bytes, static_cast<float>(point.error_px));
    Append(bytes, static_cast<std::uint32_t>(point.track.size()));
  }
  stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  RequireWritten(stream);
}

}  // namespace rigmap

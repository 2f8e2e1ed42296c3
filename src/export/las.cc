#include "export/las.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <ostream>
#include <stdexcept>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/error.h"

namespace rigmap {
namespace {

static_assert(std::endian::native == std::endian::little, "LAS is little endian");

constexpr double kStep_m = 1e-4;
constexpr std::uint16_t kHeaderBytes = 375;
constexpr std::uint8_t kFormat = 2;          // with colours, without time
constexpr std::uint16_t kRecordBytes = 32;   // 26 of the format, 6 extra
constexpr std::uint16_t kExtraBytesId = 4;   // of LASF_Spec
constexpr std::uint16_t kTextAreaId = 3;     // of LASF_Spec
constexpr std::uint16_t kGeoKeysId = 34735;  // of LASF_Projection

// Fields one after the other, without padding.
class Bytes {
 public:
  template <class Value>
  requires std::is_arithmetic_v<Value> Bytes& Put(Value value) {
    const auto* first = reinterpret_cast<const char*>(&value);
    bytes_.insert(bytes_.end(), first, first + sizeof(value));
    return *this;
  }
  // Cut or filled up with zeros to `size`.
  Bytes& Put(const std::string& text, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i) bytes_.push_back(i < text.size() ? text[i] : '\0');
    return *this;
  }
  Bytes& Zeros(std::size_t size) { return Put(std::string(), size); }
  Bytes& Append(const Bytes& other) {
    bytes_.insert(bytes_.end(), other.bytes_.begin(), other.bytes_.end());
    return *this;
  }

  std::size_t size() const { return bytes_.size(); }
  void WriteTo(std::ostream& stream) const {
    stream.write(bytes_.data(), static_cast<std::streamsize>(bytes_.size()));
  }

 private:
  std::vector<char> bytes_;
};

// A variable length record (section 2.5).
Bytes Vlr(const std::string& user, std::uint16_t id, const std::string& about,
          const Bytes& content) {
  Bytes record;
  record.Put(std::uint16_t{0}).Put(user, 16).Put(id);
  record.Put(static_cast<std::uint16_t>(content.size())).Put(about, 32);
  return record.Append(content);
}

// An extra byte descriptor (table 24): of a type, with nothing optional.
void PutExtra(Bytes& content, std::uint8_t type, const std::string& name,
              const std::string& about) {
  content.Put(std::uint16_t{0}).Put(type).Put(std::uint8_t{0}).Put(name, 32).Zeros(4);
  content.Zeros(24).Zeros(24).Zeros(24).Zeros(24).Zeros(24).Put(about, 32);
}

// The GeoTIFF key directory: projected, metres in all directions.
Bytes GeoKeys(int epsg) {
  constexpr std::uint16_t kModelType = 1024, kRasterType = 1025, kProjectedSystem = 3072,
                          kProjectedUnits = 3076, kVerticalUnits = 4099, kMetre = 9001;
  const std::vector<std::array<std::uint16_t, 2>> keys{
      {kModelType, 1},
      {kRasterType, 1},
      {kProjectedSystem, static_cast<std::uint16_t>(epsg)},
      {kProjectedUnits, kMetre},
      {kVerticalUnits, kMetre}};
  Bytes content;
  content.Put(std::uint16_t{1}).Put(std::uint16_t{1}).Put(std::uint16_t{0});
  content.Put(static_cast<std::uint16_t>(keys.size()));
  for (const auto& [key, value] : keys) {
    content.Put(key).Put(std::uint16_t{0}).Put(std::uint16_t{1}).Put(value);
  }
  return content;
}

std::vector<Bytes> Records(const LasFrame& frame) {
  constexpr std::uint8_t kUshort = 3, kFloat = 9;
  Bytes extra;
  PutExtra(extra, kFloat, "sigma", "metres off the surface");
  PutExtra(extra, kUshort, "observations", "depth pixels merged");
  std::vector<Bytes> records{Vlr("LASF_Spec", kExtraBytesId, "", extra)};
  if (frame.epsg != 0) {
    records.push_back(Vlr("LASF_Projection", kGeoKeysId, "", GeoKeys(frame.epsg)));
  }
  if (!frame.warning.empty()) {
    Bytes text;
    text.Put(frame.warning, std::min<std::size_t>(frame.warning.size() + 1, 65535));
    records.push_back(Vlr("LASF_Spec", kTextAreaId, "", text));
  }
  return records;
}

void Require(const std::ostream& stream) {
  if (!stream) throw DataError("cannot write the LAS file");
}

std::int32_t Steps(double coordinate_m, double offset_m) {
  return static_cast<std::int32_t>(std::lround((coordinate_m - offset_m) / kStep_m));
}

}  // namespace

LasWriter::LasWriter(std::ostream& stream, LasFrame frame)
    : stream_(stream), frame_(std::move(frame)) {}

Eigen::Vector3d LasWriter::InFile(const SurfacePoint& point) const {
  const Eigen::Vector3d x_in_world = point.x_in_world.cast<double>();
  return frame_.file_from_world ? frame_.file_from_world(x_in_world) : x_in_world;
}

void LasWriter::Bound(std::span<const SurfacePoint> points) {
  for (const SurfacePoint& point : points) {
    if (!point.x_in_world.allFinite()) continue;
    bounds_.extend(InFile(point));
    ++bounded_;
  }
}

// The public header block (section 2.4), field by field, then the records.
void LasWriter::WriteHead() {
  has_head_ = true;
  if (bounded_ > 0) {
    offset_ = (bounds_.center() / 1000.0).array().round() * 1000.0;
    const Eigen::Vector3d farthest =
        (bounds_.max() - offset_).cwiseMax(offset_ - bounds_.min()) / kStep_m;
    if (!(farthest.maxCoeff() < std::numeric_limits<std::int32_t>::max())) {
      throw DataError(fmt::format("expected a cloud of less than 400 km for LAS, found {:g} km",
                                  1e-3 * bounds_.sizes().maxCoeff()));
    }
  }
  const std::vector<Bytes> records = Records(frame_);
  std::size_t record_bytes = 0;
  for (const Bytes& record : records) record_bytes += record.size();
  const bool fits_legacy = bounded_ <= std::numeric_limits<std::uint32_t>::max();
  const std::uint32_t legacy = fits_legacy ? static_cast<std::uint32_t>(bounded_) : 0;
  Bytes head;
  head.Put("LASF", 4).Put(std::uint16_t{0}).Put(std::uint16_t{0});     // source, global encoding
  head.Zeros(16).Put(std::uint8_t{1}).Put(std::uint8_t{4});            // GUID, version
  head.Put("EXTRACTION", 32).Put("rigmap", 32);                        // made of images, by
  head.Put(std::uint16_t{0}).Put(std::uint16_t{0}).Put(kHeaderBytes);  // no day, no year
  head.Put(static_cast<std::uint32_t>(kHeaderBytes + record_bytes));
  head.Put(static_cast<std::uint32_t>(records.size())).Put(kFormat).Put(kRecordBytes);
  head.Put(legacy).Put(legacy).Zeros(16);  // all, then by return
  for (int i = 0; i < 3; ++i) head.Put(kStep_m);
  for (int i = 0; i < 3; ++i) head.Put(offset_(i));
  for (int i = 0; i < 3; ++i) {
    // As the coordinates are stored.
    const auto stored = [&](double x) { return offset_(i) + kStep_m * Steps(x, offset_(i)); };
    head.Put(bounded_ ? stored(bounds_.max()(i)) : 0.0)
        .Put(bounded_ ? stored(bounds_.min()(i)) : 0.0);
  }
  head.Zeros(8);                                   // waveforms
  head.Zeros(8).Put(std::uint32_t{0});             // extended records
  head.Put(bounded_).Put(bounded_).Zeros(14 * 8);  // all, then by return
  head.WriteTo(stream_);
  for (const Bytes& record : records) record.WriteTo(stream_);
}

void LasWriter::Write(std::span<const SurfacePoint> points) {
  if (!has_head_) WriteHead();
  Bytes rows;
  for (const SurfacePoint& point : points) {
    if (!point.x_in_world.allFinite()) continue;
    const Eigen::Vector3d x_in_file = InFile(point);
    for (int i = 0; i < 3; ++i) rows.Put(Steps(x_in_file(i), offset_(i)));
    rows.Put(std::uint16_t{0}).Put(std::uint8_t{0b001001}).Put(std::uint8_t{0});  // return 1 of 1
    rows.Put(std::int8_t{0}).Put(std::uint8_t{0}).Put(std::uint16_t{0});
    for (const std::uint8_t channel : point.rgb) {
      rows.Put(static_cast<std::uint16_t>(257 * channel));
    }
    rows.Put(point.sigma_m).Put(point.observations);
    ++written_;
  }
  rows.WriteTo(stream_);
  Require(stream_);
}

void LasWriter::Finish() {
  if (!has_head_) WriteHead();
  if (written_ != bounded_) {
    throw std::logic_error(fmt::format("LAS: {} points bounded, {} written", bounded_, written_));
  }
  stream_.flush();
  Require(stream_);
}

}  // namespace rigmap

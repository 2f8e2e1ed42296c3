#include "export/ply_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>

#include "core/error.h"

namespace rigmap {
namespace {

constexpr std::uint64_t kBlockBytes = 1 << 18;

std::string NamesOf(const PlyHeader& header) {
  std::string names;
  for (const PlyProperty& property : header.properties) {
    names += (names.empty() ? "" : " ") + property.name;
  }
  return names;
}

}  // namespace

PlyRows::PlyRows(const std::filesystem::path& path)
    : name_(path.string()), stream_(path, std::ios::binary) {
  if (!stream_ || std::filesystem::is_directory(path)) {
    throw DataError(fmt::format("{}: cannot read: {}", name_, std::strerror(errno)));
  }
  header_ = ReadPlyHeader(stream_, name_);
  if (header_.row_bytes == 0) {
    throw DataError(fmt::format("{}: expected vertices with properties, found none", name_));
  }
  const auto bytes_left = std::filesystem::file_size(path) - stream_.tellg();
  if (bytes_left / header_.row_bytes < header_.vertex_count) {
    throw DataError(fmt::format("{}: expected {} vertices of {} bytes, found {} bytes", name_,
                                header_.vertex_count, header_.row_bytes, bytes_left));
  }
}

const PlyProperty& PlyRows::At(const char* name) const {
  const PlyProperty* property = header_.Find(name);
  if (!property) {
    throw DataError(fmt::format("{}: expected vertices with a property '{}', found '{}'", name_,
                                name, NamesOf(header_)));
  }
  return *property;
}

PlyRows::Columns PlyRows::At(const std::array<const char*, 3>& names) const {
  return {&At(names[0]), &At(names[1]), &At(names[2])};
}

const char* PlyRows::Next() {
  if (next_in_block_ == block_.size()) {
    const auto rows = std::min(std::max<std::uint64_t>(kBlockBytes / header_.row_bytes, 1),
                               header_.vertex_count - rows_read_);
    block_.resize(rows * header_.row_bytes);
    stream_.read(block_.data(), static_cast<std::streamsize>(block_.size()));
    if (!stream_) throw DataError(fmt::format("{}: cannot read its vertices", name_));
    rows_read_ += rows;
    next_in_block_ = 0;
  }
  row_ = block_.data() + next_in_block_;
  next_in_block_ += header_.row_bytes;
  return row_;
}

Eigen::Vector3f PlyRows::FinitePoint(const Columns& columns) const {
  Eigen::Vector3f point;
  for (int i = 0; i < 3; ++i) {
    point(i) = static_cast<float>(PlyValue(*columns[i], row_));
    if (std::isfinite(point(i))) continue;
    const auto row = rows_read_ - (block_.size() - next_in_block_) / header_.row_bytes - 1;
    throw DataError(fmt::format("{}: expected finite numbers, found {} as {} of vertex {}", name_,
                                point(i), columns[i]->name, row));
  }
  return point;
}

}  // namespace rigmap

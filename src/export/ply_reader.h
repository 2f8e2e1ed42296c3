// Point clouds from PLY files block by block, for clouds that are larger than the memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "export/ply_rows.h"
#include "scene/point_cloud.h"

namespace rigmap {

// Takes and refuses the same files as ReadPly, with the same messages.
class PlyReader {
 public:
  static constexpr std::size_t kMaxPointsPerBlock = 8192;

  // Reads the header. Throws DataError naming the file.
  explicit PlyReader(const std::filesystem::path& path);

  std::uint64_t point_count() const { return rows_.size(); }

  // Replaces `block` by the next points in the file's order, at most kMaxPointsPerBlock. False, and
  // none, after the last. Throws DataError when the file cannot be read on.
  bool Read(PointCloud& block);

 private:
  PlyRows rows_;
  std::uint64_t points_read_ = 0;
};

}  // namespace rigmap

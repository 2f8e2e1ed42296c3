// Point clouds as PLY files (binary, little endian). `vertex` is the first and only element; the
// header holds no date, path or host, so that equal clouds give equal bytes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <span>
#include <vector>

#include "scene/point_cloud.h"
#include "scene/sparse_model.h"

namespace rigmap {

// Writes a cloud piece by piece, 37 bytes per point: float x y z nx ny nz, uchar red green blue,
// ushort observations, float sigma grain. Coordinates, sigma and grain in metres. The stream must
// be seekable; the file is complete only after Finish.
class PlyWriter {
 public:
  // Writes a header that says no points; `stream` must outlive the writer.
  explicit PlyWriter(std::ostream& stream);

  // Throws DataError when the stream fails, as does Finish.
  void Write(std::span<const SurfacePoint> points);
  // Puts the count into the header, whose length stays, and leaves the stream at its end.
  void Finish();

  std::uint64_t point_count() const { return point_count_; }

 private:
  std::ostream& stream_;
  std::int64_t start_;  // of the header, in the stream
  std::uint64_t point_count_ = 0;
};

// Sparse points: float x y z (metres where the model is metric), uchar red green blue, float error
// (mean reprojection error, px), uint track_length (images that see it).
void WriteSparsePly(std::ostream& stream, const std::vector<SparsePoint>& points);

// The vertices of a binary little-endian PLY file with x y z; normals, colour, observations,
// sigma and grain are taken where the file has them, by the names above, and other properties
// passed over. `vertex` must be the first element. Throws DataError naming the file for anything
// else, and for a file that ends too early.
PointCloud ReadPly(const std::filesystem::path& path);

}  // namespace rigmap

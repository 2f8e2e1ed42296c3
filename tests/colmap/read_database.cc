#include "tests/colmap/read_database.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

#include <cstring>
#include <limits>
#include <stdexcept>

#include "colmap/internal/camera_model.h"
#include "colmap/internal/image_ids.h"

namespace rigmap {
namespace {

constexpr std::int64_t kImageLimit = std::numeric_limits<std::int32_t>::max();

void Require(bool holds, const std::string& sentence) {
  if (!holds) throw std::runtime_error(sentence);
}

DatabaseImage ReadImageRow(SQLite::Statement& row) {
  const std::uint32_t id = row.getColumn(0).getUInt(), camera = row.getColumn(2).getUInt();
  Require(id > 0 && camera == CameraIdOf(ImageOf(id).eye),
          fmt::format("expected images of a rig, found image {} of camera {}", id, camera));
  DatabaseImage image{.ref = ImageOf(id), .name = row.getColumn(1).getString(), .keypoints = {}};
  const auto count = static_cast<std::size_t>(row.getColumn(3).getInt64());
  const auto columns = static_cast<std::size_t>(row.getColumn(4).getInt64());
  const auto blob = row.getColumn(5);
  Require(
      columns >= 2 && static_cast<std::size_t>(blob.getBytes()) == count * columns * sizeof(float),
      fmt::format("image {}: its keypoints do not have the stated size", id));
  std::vector<float> data(count * columns);
  if (!data.empty()) std::memcpy(data.data(), blob.getBlob(), data.size() * sizeof(float));
  for (std::size_t i = 0; i < count; ++i) {
    const auto shift = static_cast<float>(kColmapPixelShift);
    image.keypoints.emplace_back(data[i * columns] - shift, data[i * columns + 1] - shift);
  }
  return image;
}

DatabasePair ReadPair(SQLite::Statement& row) {
  const std::int64_t pair_id = row.getColumn(0).getInt64();
  DatabasePair pair{.image_a = ImageOf(static_cast<std::uint32_t>(pair_id / kImageLimit)),
                    .image_b = ImageOf(static_cast<std::uint32_t>(pair_id % kImageLimit)),
                    .matches = {}};
  const auto count = static_cast<std::size_t>(row.getColumn(1).getInt64());
  const auto blob = row.getColumn(2);
  Require(static_cast<std::size_t>(blob.getBytes()) == count * 2 * sizeof(std::uint32_t),
          fmt::format("pair {}: its matches do not have the stated size", pair_id));
  std::vector<std::uint32_t> data(count * 2);
  if (!data.empty()) std::memcpy(data.data(), blob.getBlob(), data.size() * sizeof(data[0]));
  for (std::size_t i = 0; i < count; ++i) pair.matches.emplace_back(data[2 * i], data[2 * i + 1]);
  return pair;
}

SparseCamera ReadCameraRow(SQLite::Statement& row) {
  ColmapCamera camera{.model = row.getColumn(1).getInt(), .parameters = {}};
  const auto count = ParameterCount(camera.model);
  Require(count.has_value(),
          "expected cameras PINHOLE or OPENCV, found " + ModelName(camera.model));
  const auto blob = row.getColumn(4);
  Require(static_cast<std::size_t>(blob.getBytes()) == *count * sizeof(double),
          "a camera does not have the parameters of its model");
  camera.parameters.resize(*count);
  std::memcpy(camera.parameters.data(), blob.getBlob(), *count * sizeof(double));
  const std::uint32_t id = row.getColumn(0).getUInt();
  const Eye eye = id == CameraIdOf(Eye::kLeft) ? Eye::kLeft : Eye::kRight;
  Require(id == CameraIdOf(eye),
          fmt::format("expected camera 1 (left) or 2 (right), found {}", id));
  return {.eye = eye,
          .camera = FromColmap(camera, row.getColumn(2).getInt(), row.getColumn(3).getInt())};
}

}  // namespace

DatabaseContent ReadDatabase(const std::filesystem::path& path) {
  DatabaseContent content;
  SQLite::Database database(path.string(), SQLite::OPEN_READONLY);
  SQLite::Statement cameras(
      database, "SELECT camera_id, model, width, height, params FROM cameras ORDER BY camera_id");
  while (cameras.executeStep()) content.cameras.push_back(ReadCameraRow(cameras));
  SQLite::Statement images(
      database,
      "SELECT image_id, name, camera_id, IFNULL(rows, 0), IFNULL(cols, 2), data "
      "FROM images LEFT JOIN keypoints USING (image_id) ORDER BY image_id");
  while (images.executeStep()) content.images.push_back(ReadImageRow(images));
  SQLite::Statement pairs(database,
                          "SELECT pair_id, rows, data FROM two_view_geometries ORDER BY pair_id");
  while (pairs.executeStep()) content.pairs.push_back(ReadPair(pairs));
  return content;
}

}  // namespace rigmap

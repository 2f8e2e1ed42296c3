#include "colmap/database.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <set>

#include "colmap/internal/camera_model.h"
#include "colmap/internal/command_line.h"
#include "colmap/internal/image_ids.h"
#include "core/error.h"

namespace rigmap {
namespace {

constexpr std::int64_t kImageLimit = std::numeric_limits<std::int32_t>::max();  // COLMAP's
constexpr int kFrameLimit = static_cast<int>(kImageLimit / 2);  // ids stay below that
constexpr int kCalibrated = 2;                                  // two_view_geometries.config
constexpr const char* kUnfinished = ".unfinished";
constexpr int kSqliteBusy = 5, kSqliteLocked = 6;
constexpr std::array kDatabaseSuffixes{"", "-wal", "-shm", "-journal"};

const std::map<std::string, std::vector<std::string>> kNeededColumns{
    {"cameras", {"camera_id", "model", "width", "height", "params", "prior_focal_length"}},
    {"images", {"image_id", "name", "camera_id"}},
    {"keypoints", {"image_id", "rows", "cols", "data"}},
    {"matches", {"pair_id", "rows", "cols", "data"}},
    {"two_view_geometries", {"pair_id", "rows", "cols", "data", "config"}}};

std::int64_t PairId(std::int64_t smaller, std::int64_t larger) {
  return kImageLimit * smaller + larger;
}

void Require(bool holds, const std::filesystem::path& path, const std::string& sentence) {
  if (!holds) throw DataError(fmt::format("{}: {}", path.string(), sentence));
}

// ---- Checks ----

void CheckPair(const DatabasePair& pair, const std::map<ImageRef, const DatabaseImage*>& images,
               const std::filesystem::path& path) {
  const std::uint32_t id_a = ImageIdOf(pair.image_a), id_b = ImageIdOf(pair.image_b);
  const auto a = images.find(pair.image_a), b = images.find(pair.image_b);
  Require(a != images.end() && b != images.end() && a != b, path,
          fmt::format("expected a pair of two images, found {} and {}", id_a, id_b));
  const auto count_a = a->second->keypoints.size(), count_b = b->second->keypoints.size();
  for (const auto& [keypoint_a, keypoint_b] : pair.matches) {
    Require(keypoint_a < count_a && keypoint_b < count_b, path,
            fmt::format("pair {}, {}: expected matches within {} and {} keypoints, found {}, {}",
                        id_a, id_b, count_a, count_b, keypoint_a, keypoint_b));
  }
}

void CheckContent(const DatabaseContent& content, const std::filesystem::path& path) {
  std::set<Eye> cameras;
  for (const auto& camera : content.cameras) cameras.insert(camera.eye);
  std::map<ImageRef, const DatabaseImage*> images;
  for (const auto& image : content.images) {
    const auto [frame, eye] = image.ref;
    Require(frame >= 0 && frame < kFrameLimit, path,
            fmt::format("expected frames from 0 to {}, found {}", kFrameLimit - 1, frame));
    Require(cameras.contains(eye), path,
            fmt::format("image {}: expected a known camera, found {}", ImageIdOf(image.ref),
                        CameraIdOf(eye)));
    images.emplace(image.ref, &image);
  }
  for (const auto& pair : content.pairs) CheckPair(pair, images, path);
}

void CheckTables(SQLite::Database& database, const ColmapInstallation& colmap) {
  for (const auto& [table, needed] : kNeededColumns) {
    std::set<std::string> found;
    SQLite::Statement columns(database, fmt::format("PRAGMA table_info({})", table));
    while (columns.executeStep()) found.insert(columns.getColumn(1).getString());
    for (const auto& column : needed) {
      if (found.count(column)) continue;
      throw ToolError(fmt::format(
          "{} database_creator: expected a column {} in table {}, found {}", colmap.path, column,
          table, found.empty() ? "no such table" : fmt::format("{}", fmt::join(found, ", "))));
    }
  }
}

// ---- Writing ----

void InsertCameras(SQLite::Database& database, const std::vector<SparseCamera>& cameras) {
  SQLite::Statement insert(database,
                           "INSERT INTO cameras (camera_id, model, width, height, params, "
                           "prior_focal_length) VALUES (?, ?, ?, ?, ?, 1)");
  for (const auto& [eye, camera] : cameras) {
    const ColmapCamera converted = ToColmap(camera);
    insert.bind(1, static_cast<std::int64_t>(CameraIdOf(eye)));
    insert.bind(2, converted.model);
    insert.bind(3, camera.width);
    insert.bind(4, camera.height);
    insert.bind(5, converted.parameters.data(),
                static_cast<int>(converted.parameters.size() * sizeof(double)));
    insert.exec();
    insert.reset();
  }
}

void InsertImages(SQLite::Database& database, const std::vector<DatabaseImage>& images) {
  SQLite::Statement insert_image(database,
                                 "INSERT INTO images (image_id, name, camera_id) VALUES (?, ?, ?)");
  SQLite::Statement insert_keypoints(
      database, "INSERT INTO keypoints (image_id, rows, cols, data) VALUES (?, ?, 2, ?)");
  for (const auto& image : images) {
    const auto id = static_cast<std::int64_t>(ImageIdOf(image.ref));
    insert_image.bind(1, id);
    insert_image.bind(2, image.name);
    insert_image.bind(3, static_cast<std::int64_t>(CameraIdOf(image.ref.eye)));
    insert_image.exec();
    insert_image.reset();
    if (image.keypoints.empty()) continue;  // an empty row would keep COLMAP from finding some
    std::vector<float> data;
    for (const auto& keypoint : image.keypoints) {
      data.push_back(keypoint.x() + static_cast<float>(kColmapPixelShift));
      data.push_back(keypoint.y() + static_cast<float>(kColmapPixelShift));
    }
    insert_keypoints.bind(1, id);
    insert_keypoints.bind(2, static_cast<std::int64_t>(image.keypoints.size()));
    insert_keypoints.bind(3, data.data(), static_cast<int>(data.size() * sizeof(float)));
    insert_keypoints.exec();
    insert_keypoints.reset();
  }
}

// The first column belongs to the image with the smaller id.
std::vector<std::uint32_t> MatchData(const DatabasePair& pair) {
  std::vector<std::uint32_t> data;
  for (auto [first, second] : pair.matches) {
    if (pair.image_a > pair.image_b) std::swap(first, second);
    data.push_back(first);
    data.push_back(second);
  }
  return data;
}

void InsertPairs(SQLite::Database& database, const std::vector<DatabasePair>& pairs) {
  SQLite::Statement insert_matches(
      database, "INSERT INTO matches (pair_id, rows, cols, data) VALUES (?, ?, 2, ?)");
  // F, E, H, qvec and tvec stay NULL: COLMAP takes zeros for a geometry.
  SQLite::Statement insert_geometry(database,
                                    fmt::format("INSERT INTO two_view_geometries (pair_id, rows, "
                                                "cols, data, config) VALUES (?, ?, 2, ?, {})",
                                                kCalibrated));
  for (const auto& pair : pairs) {
    const std::vector<std::uint32_t> data = MatchData(pair);
    const auto [smaller, larger] = std::minmax({ImageIdOf(pair.image_a), ImageIdOf(pair.image_b)});
    for (SQLite::Statement* insert : {&insert_matches, &insert_geometry}) {
      insert->bind(1, PairId(smaller, larger));
      insert->bind(2, static_cast<std::int64_t>(pair.matches.size()));
      insert->bind(3, data.data(), static_cast<int>(data.size() * sizeof(std::uint32_t)));
      insert->exec();
      insert->reset();
    }
  }
}

void Fill(const std::filesystem::path& path, const ColmapInstallation& colmap,
          const DatabaseContent& content) {
  SQLite::Database database(path.string(), SQLite::OPEN_READWRITE);
  CheckTables(database, colmap);
  SQLite::Transaction transaction(database);
  InsertCameras(database, content.cameras);
  InsertImages(database, content.images);
  InsertPairs(database, content.pairs);
  transaction.commit();
  // Ends the write-ahead log that COLMAP began: all is in the one file that is renamed.
  database.exec("PRAGMA journal_mode = DELETE");
}

// ---- Files ----

void RemoveDatabase(const std::filesystem::path& path) {
  std::error_code ignored;
  for (const char* suffix : kDatabaseSuffixes) {
    std::filesystem::remove(path.string() + suffix, ignored);
  }
}

// Removes what a database in the making would leave when it fails.
struct Unfinished {
  const std::filesystem::path& path;
  ~Unfinished() { RemoveDatabase(path); }
};

}  // namespace

void RequireUnlocked(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) return;
  int code = 0;
  try {
    SQLite::Database database(path.string(), SQLite::OPEN_READWRITE);
    code = database.tryExec("BEGIN EXCLUSIVE");
  } catch (const SQLite::Exception& error) {
    code = error.getErrorCode();
  }
  Require(code != kSqliteBusy && code != kSqliteLocked, path,
          "expected a database of our own, found it locked by another program");
}

void WriteDatabase(const ColmapInstallation& colmap, const DatabaseContent& content,
                   const std::filesystem::path& path, const std::filesystem::path& log_path) {
  CheckContent(content, path);
  const std::filesystem::path temporary = path.string() + kUnfinished;
  try {
    if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path());
    RequireUnlocked(path);
    RemoveDatabase(temporary);
    const Unfinished unfinished{temporary};
    CommandLine command("database_creator");
    command.Path("database_path", temporary);
    RunTool(ProcessOf(colmap, command, log_path, 1), "creating the database");
    Fill(temporary, colmap, content);
    RemoveDatabase(path);
    std::filesystem::rename(temporary, path);
  } catch (const std::filesystem::filesystem_error& error) {
    throw DataError(fmt::format("{}: cannot write: {}", path.string(), error.code().message()));
  } catch (const SQLite::Exception& error) {
    throw DataError(fmt::format("{}: cannot write: {}", path.string(), error.what()));
  }
}

}  // namespace rigmap

// COLMAP's database, written whole.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "colmap/installation.h"
#include "scene/sparse_model.h"

namespace rigmap {

struct DatabaseImage {
  ImageRef ref;
  std::string name;  // relative to the image folder; unique
  // Px, OpenCV's convention, distorted image; none where COLMAP's extractor is to find them.
  std::vector<Eigen::Vector2f> keypoints;
};

struct DatabasePair {
  ImageRef image_a, image_b;  // different; in any order
  // (keypoint of image_a, keypoint of image_b), verified by the caller.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> matches;
};

struct DatabaseContent {
  std::vector<SparseCamera> cameras;
  std::vector<DatabaseImage> images;
  std::vector<DatabasePair> pairs;  // each unordered pair of images at most once
};

// Throws DataError when another program has locked the database at `path`, if there is one:
// replacing it would lose that program's work.
void RequireUnlocked(const std::filesystem::path& path);

// The tables are made by the COLMAP that will read them (`database_creator`), checked, filled in
// one transaction under a temporary name and renamed to `path`, whose folder is created. Cameras
// are marked as calibrated; each pair's matches count as verified (two_view_geometries, config 2)
// and as raw matches. No descriptors are stored. The tool's output is appended to `log_path`.
//
// Throws DataError when images, names or keypoint indices contradict each other, when the file
// cannot be written or another program has locked a database at `path`; ToolError when
// database_creator fails or makes a table without a column that is needed.
void WriteDatabase(const ColmapInstallation& colmap, const DatabaseContent& content,
                   const std::filesystem::path& path, const std::filesystem::path& log_path);

}  // namespace rigmap

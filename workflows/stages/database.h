// The stage `database`: leaves colmap/database.db and colmap/images.
#pragma once

#include <filesystem>

#include "colmap/installation.h"
#include "mapping/build_graph.h"
#include "pipeline/stage.h"

namespace rigmap {

// Where COLMAP's files lie in an output folder.
struct ColmapFolder {
  std::filesystem::path root;
  std::filesystem::path Database() const { return root / "colmap" / "database.db"; }
  std::filesystem::path Images() const { return root / "colmap" / "images"; }
  std::filesystem::path Models() const { return root / "colmap" / "models"; }
};

using DatabaseStage =
    Stage<KeyframeGraph, Takes<ColmapInstallation, Dataset, Odometry, Correspondences>,
          Reads<KeyframeGraphOptions>>;
DatabaseStage Database();

// Makes `images`/left and right hold a link per frame to its file.
void LinkImages(const Dataset& dataset, const std::filesystem::path& images);

}  // namespace rigmap

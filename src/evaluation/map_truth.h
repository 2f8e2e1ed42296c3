// What a map is judged by: the true path, points of the true surface, the surveyed rocks.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "export/tum.h"

namespace rigmap {

// Points of the true surface about 1 cm apart, in the frame of the true path (metric, z up). In
// parallel; 26 bytes a point.
struct TrueSurface {
  std::vector<Eigen::Vector3f> x_in_truth;  // m
  std::vector<Eigen::Vector3f> normal;      // of unit length to a hundredth
  std::vector<std::uint8_t> visible;        // not 0: the cameras saw it well enough to map it
  std::vector<std::uint8_t> kind;           // kRockKind or other; all 0 where the file has none

  std::size_t size() const { return x_in_truth.size(); }
};

inline constexpr std::uint8_t kRockKind = 2;

struct TrueRock {
  std::string size;  // as the survey calls it: small, medium, large
  Eigen::Vector3d x_in_truth =
      Eigen::Vector3d::Zero();  // m; the rock's centre at the level of the sand
  double width_m = 0.0;
};

struct MapTruth {
  std::vector<TumPose> path;  // in order of time
  TrueSurface surface;
  std::vector<TrueRock> rocks;
};

// Reads a folder's surface.ply and, where it exists, ../rocks.json; of several folders, one for
// each part of a drive and all in one frame, one surface and their rocks. Points that several parts
// have are there once, visible where any part has seen them. Of the surface only what lies within 8
// m of `path`, in plan, and squares of 1 m that reach as far: a short stretch of a long drive takes
// little memory. Nothing for an empty path, and where a folder has no surface.ply. surface.ply is a
// binary little-endian PLY with x y z, nx ny nz (the unit normal times 127), visible and kind
// (needed where there are rocks); coordinates are taken as float. rocks.json is {"rocks": [{"size",
// "x", "y", "z", "width", ...}, ...]}. Throws DataError naming file, expected and found for
// anything else.
std::optional<MapTruth> ReadMapTruth(const std::vector<std::filesystem::path>& folders,
                                     std::vector<TumPose> path);

// Those of the files that ReadMapTruth reads which exist.
std::vector<std::filesystem::path> MapTruthFiles(const std::vector<std::filesystem::path>& folders);

}  // namespace rigmap

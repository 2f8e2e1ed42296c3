// COLMAP's incremental mapper and point triangulator, with every option that matters said aloud.
// Both are deterministic, whatever the number of threads: equal databases, options and seeds give
// equal models.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "colmap/installation.h"

namespace rigmap {

// The defaults are lean: safe only for a mapper that continues a metric seed. About a quarter of
// the time of COLMAP's own defaults (StockMapperOptions), at the same accuracy.
struct MapperOptions {
  int min_num_matches = 15;                   // of a pair; fewer are not used at all
  bool multiple_models = true;                // unseeded: begin another model with what is left
  int min_model_size = 10;                    // images; smaller further models are dropped
  double init_min_tri_angle_deg = 16.0;       // of the first pair, unseeded; relaxed if none has it
  int ba_local_num_images = 4;                // neighbours adjusted with each new image
  int ba_local_max_refinements = 1;           // rounds of adjusting and filtering
  double ba_local_function_tolerance = 1e-3;  // relative; a rough fit will do between global ones
  double ba_global_images_ratio = 2.0;        // growth between global adjustments; raise both
  double ba_global_points_ratio = 2.0;        // together, the smaller one decides
  int ba_global_max_refinements = 1;          // rounds of adjusting, completing and filtering
  int ba_global_max_num_iterations = 10;      // in each round
  double ba_global_function_tolerance = 1e-4;  // relative; the rig adjustment comes afterwards
  double abs_pose_max_error_px = 12.0;         // inlier of a new image's pose
  int abs_pose_min_num_inliers = 30;           // fewer: the image is not registered
  double abs_pose_min_inlier_ratio = 0.25;     // of the correspondences, the same
  double filter_max_reproj_error_px = 4.0;     // at 2 px the mapper takes three times as long
  double tri_min_angle_deg = 1.5;              // of a new point, and to keep one
  // Points that a single stereo pair sees carry the baseline: they are kept.
  bool tri_ignore_two_view_tracks = false;
  bool refine_intrinsics = false;  // focal lengths and distortion; COLMAP's own default is true
  int random_seed = 0;             // of its sampling
};

// COLMAP 3.8's own values of these options, for unseeded mapping, but that intrinsics are held.
// They ignore two-view tracks.
MapperOptions StockMapperOptions();

struct MapperRequest {
  std::filesystem::path database;
  std::filesystem::path images;  // may be empty, no image is read; created if missing
  // Model to continue: same image ids and names as the database, and of each image either no
  // keypoints or exactly the database's, in its order. It must hold points.
  std::optional<std::filesystem::path> seed;
  std::filesystem::path output;  // replaced
  std::filesystem::path log;     // appended to
  int threads = 1;
  double max_s = 0.0;  // killed after this time, which is a ToolError; 0: never
  std::function<void(int registered)> on_progress;  // images in the present model; may be empty
};

// The folders of the models made, output/0, output/1, ..., in COLMAP's own gauge: the metric scale
// of a seed is not kept. A seeded run makes one. Throws ToolError when COLMAP fails or ends without
// a model, as it does when it cannot read the database.
std::vector<std::filesystem::path> RunMapper(const ColmapInstallation& colmap,
                                             const MapperOptions& options,
                                             const MapperRequest& request);

// Loose by default: poses from odometry are not yet good to a pixel, and an adjustment that rejects
// outliers comes afterwards.
struct TriangulatorOptions {
  int min_num_matches = 1;                         // of a pair; fewer are not used at all
  double tri_create_max_angle_error_deg = 6.0;     // of a ray to a new point
  double tri_continue_max_angle_error_deg = 6.0;   // of a ray to a point that is extended
  double tri_re_max_angle_error_deg = 10.0;        // the same in the second attempt
  double tri_merge_max_reproj_error_px = 15.0;     // of points that become one
  double tri_complete_max_reproj_error_px = 15.0;  // of an observation added to a track
  double filter_max_reproj_error_px = 30.0;        // beyond, an observation is dropped
  double tri_min_angle_deg = 1.5;                  // of a new point, and to keep one
  int ba_global_max_refinements = 5;      // rounds of refining, completing and filtering points
  int ba_global_max_num_iterations = 50;  // in each round; only points move
  double ba_global_function_tolerance = 1e-4;  // relative; they are adjusted afterwards
  // As for the mapper.
  bool tri_ignore_two_view_tracks = false;
};

struct TriangulatorRequest {
  std::filesystem::path database;
  std::filesystem::path images;       // as for the mapper
  std::filesystem::path input_model;  // its poses are kept; its keypoints and points are not used
  std::filesystem::path output;       // the model's folder itself; replaced
  std::filesystem::path log;          // appended to
  int threads = 1;
};

// Triangulates the database's correspondences on the poses of a model, in that model's gauge.
// Throws ToolError when COLMAP fails or writes no model.
void RunPointTriangulator(const ColmapInstallation& colmap, const TriangulatorOptions& options,
                          const TriangulatorRequest& request);

}  // namespace rigmap

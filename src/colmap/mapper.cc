#include "colmap/mapper.h"

#include <fmt/format.h>

#include <cstdint>
#include <limits>
#include <regex>

#include "colmap/internal/command_line.h"
#include "colmap/internal/process.h"
#include "colmap/model_io.h"
#include "core/error.h"

namespace rigmap {
namespace {

// Options of the mapper as --Mapper.NAME VALUE.
class MapperCommand : public CommandLine {
 public:
  using CommandLine::CommandLine;

  MapperCommand& Set(const std::string& name, double value) {
    Number("Mapper." + name, value);
    return *this;
  }
  // What holds for every run, whatever the options: no image is read for its colours, and equal
  // runs give equal models.
  MapperCommand& SetFixed(int threads, int random_seed, bool refine_intrinsics) {
    Number("random_seed", random_seed);
    for (const char* name : {"ba_refine_focal_length", "ba_refine_extra_params"}) {
      Set(name, refine_intrinsics ? 1 : 0);
    }
    Set("ba_refine_principal_point", 0);
    Set("extract_colors", 0);
    // With several threads 3.8's adjustment sums in the order of their arrival: above this number
    // of residuals two equal runs differ, and gain no time.
    Set("ba_min_num_residuals_for_multi_threading", std::numeric_limits<std::int32_t>::max());
    return Set("num_threads", threads);
  }
};

void SetAll(const MapperOptions& options, MapperCommand& command) {
  command.Set("min_num_matches", options.min_num_matches)
      .Set("multiple_models", options.multiple_models)
      .Set("min_model_size", options.min_model_size)
      .Set("init_min_tri_angle", options.init_min_tri_angle_deg)
      .Set("ba_local_num_images", options.ba_local_num_images)
      .Set("ba_local_max_refinements", options.ba_local_max_refinements)
      .Set("ba_local_function_tolerance", options.ba_local_function_tolerance)
      .Set("ba_global_images_ratio", options.ba_global_images_ratio)
      .Set("ba_global_points_ratio", options.ba_global_points_ratio)
      .Set("ba_global_max_refinements", options.ba_global_max_refinements)
      .Set("ba_global_max_num_iterations", options.ba_global_max_num_iterations)
      .Set("ba_global_function_tolerance", options.ba_global_function_tolerance)
      .Set("abs_pose_max_error", options.abs_pose_max_error_px)
      .Set("abs_pose_min_num_inliers", options.abs_pose_min_num_inliers)
      .Set("abs_pose_min_inlier_ratio", options.abs_pose_min_inlier_ratio)
      .Set("filter_max_reproj_error", options.filter_max_reproj_error_px)
      .Set("filter_min_tri_angle", options.tri_min_angle_deg)
      .Set("tri_min_angle", options.tri_min_angle_deg)
      .Set("tri_ignore_two_view_tracks", options.tri_ignore_two_view_tracks);
}

void SetAll(const TriangulatorOptions& options, MapperCommand& command) {
  command.Set("min_num_matches", options.min_num_matches)
      .Set("tri_create_max_angle_error", options.tri_create_max_angle_error_deg)
      .Set("tri_continue_max_angle_error", options.tri_continue_max_angle_error_deg)
      .Set("tri_re_max_angle_error", options.tri_re_max_angle_error_deg)
      .Set("tri_merge_max_reproj_error", options.tri_merge_max_reproj_error_px)
      .Set("tri_complete_max_reproj_error", options.tri_complete_max_reproj_error_px)
      .Set("filter_max_reproj_error", options.filter_max_reproj_error_px)
      .Set("filter_min_tri_angle", options.tri_min_angle_deg)
      .Set("tri_min_angle", options.tri_min_angle_deg)
      .Set("ba_global_max_refinements", options.ba_global_max_refinements)
      .Set("ba_global_max_num_iterations", options.ba_global_max_num_iterations)
      .Set("ba_global_function_tolerance", options.ba_global_function_tolerance)
      .Set("tri_ignore_two_view_tracks", options.tri_ignore_two_view_tracks);
}

void PrepareFolders(const std::filesystem::path& images, const std::filesystem::path& output) {
  try {
    std::filesystem::create_directories(images);
    std::filesystem::remove_all(output);
    std::filesystem::create_directories(output);
  } catch (const std::filesystem::filesystem_error& error) {
    throw DataError(
        fmt::format("{}: cannot be prepared: {}", error.path1().string(), error.code().message()));
  }
}

// 3.8 prints "Registering image #ID (K)" as it adds the K-th image of a model.
std::optional<int> ParseRegistered(const std::string& line) {
  static const std::regex kRegistering("Registering image #[0-9]+ \\(([0-9]{1,9})\\)");
  std::smatch match;
  if (!std::regex_search(line, match, kRegistering)) return std::nullopt;
  return std::stoi(match[1]);
}

std::vector<std::filesystem::path> NumberedModels(const std::filesystem::path& output) {
  std::vector<std::filesystem::path> folders;
  while (HasModel(output / std::to_string(folders.size()))) {
    folders.push_back(output / std::to_string(folders.size()));
  }
  return folders;
}

}  // namespace

MapperOptions StockMapperOptions() {
  MapperOptions options;
  options.ba_local_num_images = 6;
  options.ba_local_max_refinements = 2;
  options.ba_local_function_tolerance = 0.0;
  options.ba_global_images_ratio = 1.1;
  options.ba_global_points_ratio = 1.1;
  options.ba_global_max_refinements = 5;
  options.ba_global_max_num_iterations = 50;
  options.ba_global_function_tolerance = 0.0;
  options.tri_ignore_two_view_tracks = true;
  return options;
}

std::vector<std::filesystem::path> RunMapper(const ColmapInstallation& colmap,
                                             const MapperOptions& options,
                                             const MapperRequest& request) {
  PrepareFolders(request.images, request.output);
  // A run that continues a model writes into the output folder itself, any other into 0/, 1/, ...
  const auto written_to = request.seed ? request.output / "0" : request.output;
  std::filesystem::create_directories(written_to);
  MapperCommand command("mapper");
  command.Path("database_path", request.database)
      .Path("image_path", request.images)
      .Path("output_path", written_to);
  if (request.seed) command.Path("input_path", *request.seed);
  command.SetFixed(request.threads, options.random_seed, options.refine_intrinsics);
  SetAll(options, command);
  ProcessRequest process = ProcessOf(colmap, command, request.log, request.threads);
  process.timeout_s = request.max_s;
  process.on_line = [&](const std::string& line) {
    const auto registered = ParseRegistered(line);
    if (registered && request.on_progress) request.on_progress(*registered);
  };
  const ProcessResult result = RunTool(process, "incremental mapping");
  auto models = NumberedModels(request.output);
  if (models.empty()) {
    throw ToolError(fmt::format("incremental mapping: expected a model in {}, found none {}",
                                request.output.string(), DescribeOutput(process, result)));
  }
  return models;
}

void RunPointTriangulator(const ColmapInstallation& colmap, const TriangulatorOptions& options,
                          const TriangulatorRequest& request) {
  PrepareFolders(request.images, request.output);
  MapperCommand command("point_triangulator");
  command.Path("database_path", request.database)
      .Path("image_path", request.images)
      .Path("input_path", request.input_model)
      .Path("output_path", request.output);
  command.SetFixed(request.threads, 0, false);
  SetAll(options, command);
  command.Number("clear_points", 1);
  const ProcessRequest process = ProcessOf(colmap, command, request.log, request.threads);
  const ProcessResult result = RunTool(process, "triangulating points");
  if (HasModel(request.output)) return;
  throw ToolError(fmt::format("triangulating points: expected a model in {}, found none {}",
                              request.output.string(), DescribeOutput(process, result)));
}

}  // namespace rigmap

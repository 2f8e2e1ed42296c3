#include "mapping/free_cameras.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <set>

#include "colmap/database.h"
#include "colmap/mapper.h"
#include "colmap/model_io.h"
#include "colmap/own_matching.h"
#include "core/error.h"
#include "core/progress.h"
#include "mapping/internal/models_by_size.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

// Doubled distances go on up to so many frames, as COLMAP's do at its default overlap.
constexpr int kFarthest = 256;

std::set<int> FrameDistances(int overlap) {
  std::set<int> distances;
  for (int distance = 0; distance <= overlap; ++distance) distances.insert(distance);
  for (int distance = 1; distance <= kFarthest; distance *= 2) distances.insert(distance);
  return distances;
}

DatabaseContent EmptyContent(const Dataset& dataset) {
  DatabaseContent content;
  for (const Eye eye : kEyes) content.cameras.push_back({eye, dataset.rig.Of(eye).camera});
  for (std::size_t i = 0; i < dataset.frames.size(); ++i) {
    for (const Eye eye : kEyes) {
      content.images.push_back({{static_cast<int>(i), eye}, ImageName(dataset.frames[i], eye), {}});
    }
  }
  return content;
}

}  // namespace

OptionFields FreeMatchingOptions::Fields() {
  return {
      {"overlap", &overlap, "frames", AtLeast(1),
       "Images are compared with those of so many next frames, and of frames 2, 4, 8, ... up to "
       "256 "
       "away. 5 frames are the 10 images that COLMAP's matcher for videos takes."},
  };
}

OptionFields FreeMappingOptions::Fields() {
  return {
      {"refine_intrinsics",
       &refine_intrinsics,
       "",
       {},
       "Whether COLMAP changes focal lengths and distortion, as it does by default."},
      {"random_seed", &random_seed, "", AtLeast(0),
       "Of COLMAP's sampling: other seeds give other models, equal ones equal models."},
      {"max_mapping_s", &max_mapping_s, "s", MoreThan(0.0),
       "COLMAP's mapper is ended after this time, without a model. With free cameras it may drop "
       "what it has and begin anew for hours."},
  };
}

std::vector<std::pair<std::string, std::string>> ImagePairs(const std::vector<StereoFrame>& frames,
                                                            int overlap) {
  const std::set<int> distances = FrameDistances(overlap);
  std::vector<std::pair<std::string, std::string>> pairs;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    for (const int distance : distances) {
      const std::size_t j = i + static_cast<std::size_t>(distance);
      if (j >= frames.size()) break;
      for (const Eye a : kEyes) {
        for (const Eye b : kEyes) {
          if (distance == 0 && !(a == Eye::kLeft && b == Eye::kRight)) continue;
          pairs.emplace_back(ImageName(frames[i], a), ImageName(frames[j], b));
        }
      }
    }
  }
  return pairs;
}

std::size_t MatchFreeCameras(const ColmapInstallation& colmap, const Dataset& dataset,
                             const FreeCameraPaths& paths, const FreeMatchingOptions& options,
                             int threads) {
  WriteDatabase(colmap, EmptyContent(dataset), paths.database, paths.log);
  OwnMatchingRequest request{
      .database = paths.database, .images = paths.images, .log = paths.log, .threads = threads};
  Progress extraction("extraction", 2 * dataset.frames.size());
  request.on_progress = [&](int done) { extraction.Set(static_cast<std::size_t>(done)); };
  RunFeatureExtractor(colmap, request);
  const auto pairs = ImagePairs(dataset.frames, options.overlap);
  Progress matching("matching", pairs.size());
  request.on_progress = [&](int done) { matching.Set(static_cast<std::size_t>(done)); };
  RunMatchesImporter(colmap, request, pairs, paths.scratch / "pairs.txt");
  return pairs.size();
}

MappingResult MapFreeCameras(const ColmapInstallation& colmap, const FreeCameraPaths& paths,
                             const fs::path& models, const FreeMappingOptions& options,
                             std::size_t frame_count, int threads) {
  Progress progress("mapping", 2 * frame_count);
  MapperOptions stock = StockMapperOptions();
  stock.refine_intrinsics = options.refine_intrinsics;
  stock.random_seed = options.random_seed;
  MapperRequest request{.database = paths.database,
                        .images = paths.images,
                        .output = paths.scratch / "models",
                        .log = paths.log,
                        .threads = threads,
                        .max_s = options.max_mapping_s};
  request.on_progress = [&](int registered) { progress.Set(static_cast<std::size_t>(registered)); };
  MappingResult result{.method = MappingMethod::kUnseeded};
  std::vector<MadeModel> made;
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  try {
    for (const fs::path& folder : RunMapper(colmap, stock, request)) {
      made.push_back({folder, ReadModel(folder)});
    }
  } catch (const ToolError& error) {
    result.method = std::nullopt;
    const std::chrono::duration<double> mapped = Clock::now() - start;
    result.remarks.push_back(mapped.count() < options.max_mapping_s
                                 ? fmt::format("COLMAP made no model: {}", error.what())
                                 : fmt::format("COLMAP made no model in {:.4g} s "
                                               "(sfm.max_mapping_s); log: {}",
                                               options.max_mapping_s, paths.log.string()));
    spdlog::warn("{}", result.remarks.back());
  }
  result.models = NumberBySize(std::move(made), models);
  return result;
}

}  // namespace rigmap

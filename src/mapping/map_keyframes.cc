#include "mapping/map_keyframes.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "colmap/mapper.h"
#include "colmap/model_io.h"
#include "core/error.h"
#include "core/progress.h"
#include "mapping/internal/models_by_size.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

// COLMAP's triangulator aborts where no point is left after its filters.
constexpr std::size_t kMinTriangulatedPoints = 30;

int LongestRun(const std::vector<bool>& flags) {
  int longest = 0, run = 0;
  for (const bool flag : flags) {
    run = flag ? run + 1 : 0;
    longest = std::max(longest, run);
  }
  return longest;
}

class KeyframeMapper {
 public:
  KeyframeMapper(const ColmapInstallation& colmap, const GraphWithPoses& input,
                 const MappingPaths& paths, const MappingOptions& options, int threads)
      : colmap_(colmap), input_(input), paths_(paths), options_(options), threads_(threads) {
    fs::remove_all(paths.models);
    fs::create_directories(paths.models);
  }

  MappingResult Seeded() {
    Progress progress("mapping", 2 * input_.graph.keyframes.size());
    std::vector<bool> left_over(input_.graph.keyframes.size(), true);
    while (static_cast<int>(made_.size()) < options_.max_models) {
      // Half of what is there to map at the most: a model that is all seed was not mapped, and its
      // left-right distances would be those that were put in.
      const int length = std::min(options_.seed_keyframes, std::max(2, LongestRun(left_over) / 2));
      const auto first = BestSeedStart(input_.graph, left_over, length);
      if (!first) break;
      // A seed that fails is not tried again.
      for (int k = *first; k < *first + length; ++k) left_over[k] = false;
      MapFrom(*first, length, progress);
      MarkRegistered(left_over);
    }
    if (made_.empty()) {
      Remark("no seed led to a model, so the odometric poses were triangulated");
      return Triangulated();
    }
    return Finish(MappingMethod::kSeeded);
  }

  MappingResult Triangulated() {
    const fs::path poses = paths_.scratch / "poses";
    const int keyframes = static_cast<int>(input_.graph.keyframes.size());
    const SparseModel start = MakeSeedModel(input_, 0, keyframes);
    if (start.points.size() < kMinTriangulatedPoints) {
      Remark(fmt::format("the keyframes share {} places, too few to map", start.points.size()));
      return Finish(std::nullopt);
    }
    WriteModel(start, poses);
    const fs::path output = paths_.scratch / "triangulated";
    RunPointTriangulator(colmap_, {},
                         {.database = paths_.database,
                          .images = paths_.images,
                          .input_model = poses,
                          .output = output,
                          .log = paths_.log,
                          .threads = threads_});
    Keep(output);
    return Finish(MappingMethod::kTriangulate);
  }

  MappingResult Unseeded() {
    Progress progress("mapping", 2 * input_.graph.keyframes.size());
    const fs::path run = paths_.scratch / "unseeded";
    auto request = Request(run, progress, 0);
    MapperOptions stock = StockMapperOptions();
    stock.random_seed = options_.random_seed;
    try {
      for (const fs::path& model : RunMapper(colmap_, stock, request)) Keep(model);
    } catch (const ToolError& error) {
      Remark(fmt::format("unseeded mapping led to no model: {}", error.what()));
    }
    if (made_.empty()) {
      Remark("without a model the odometric poses were triangulated");
      return Triangulated();
    }
    return Finish(MappingMethod::kUnseeded);
  }

 private:
  MapperRequest Request(const fs::path& output, Progress& progress, std::size_t before) const {
    MapperRequest request;
    request.database = paths_.database;
    request.images = paths_.images;
    request.output = output;
    request.log = paths_.log;
    request.threads = threads_;
    request.on_progress = [&progress, before](int registered) {
      progress.Set(before + static_cast<std::size_t>(registered));
    };
    return request;
  }

  void MapFrom(int first, int length, Progress& progress) {
    const fs::path seed = paths_.scratch / "seed", run = paths_.scratch / "run";
    WriteModel(MakeSeedModel(input_, first, length), seed);
    std::size_t before = 0;
    for (const MadeModel& made : made_) before += made.model.images.size();
    MapperRequest request = Request(run, progress, before);
    request.seed = seed;
    // Otherwise COLMAP drops a seed that it cannot extend and begins a model of its own, unseeded.
    MapperOptions seeded;
    seeded.multiple_models = false;
    seeded.min_model_size = 2;
    seeded.random_seed = options_.random_seed;
    try {
      for (const fs::path& model : RunMapper(colmap_, seeded, request)) Keep(model);
    } catch (const ToolError& error) {
      Remark(fmt::format("the seed at keyframe {} led to no model: {}", first, error.what()));
    }
  }

  void Remark(const std::string& sentence) {
    spdlog::warn("{}", sentence);
    result_.remarks.push_back(sentence);
  }

  void Keep(const fs::path& model) {
    const fs::path kept = paths_.models / fmt::format("made-{}", made_.size());
    fs::rename(model, kept);
    made_.push_back({kept, ReadModel(kept)});
  }

  // Largest first, the folders numbered alike.
  MappingResult Finish(std::optional<MappingMethod> method) {
    result_.models = NumberBySize(std::move(made_), paths_.models);
    result_.method = method;
    return std::move(result_);
  }

  // Keyframes of the last model, and short runs that are left, are not seeded again.
  void MarkRegistered(std::vector<bool>& left_over) const {
    if (made_.empty()) return;
    for (const SparseImage& image : made_.back().model.images) {
      left_over[image.ref.frame] = false;
    }
    const int keyframes = static_cast<int>(left_over.size());
    for (int first = 0; first < keyframes; ++first) {
      int end = first;
      while (end < keyframes && left_over[end]) ++end;
      if (end - first < options_.min_model_keyframes) {
        std::fill(left_over.begin() + first, left_over.begin() + end, false);
      }
      first = end;
    }
  }

  const ColmapInstallation& colmap_;
  const GraphWithPoses& input_;
  const MappingPaths& paths_;
  const MappingOptions& options_;
  int threads_;
  std::vector<MadeModel> made_;  // in the order in which they were made
  MappingResult result_;
};

}  // namespace

MappingResult MapKeyframes(const ColmapInstallation& colmap, const GraphWithPoses& input,
                           const MappingPaths& paths, const MappingOptions& options, int threads) {
  KeyframeMapper mapper(colmap, input, paths, options, threads);
  if (options.method == MappingMethod::kTriangulate) return mapper.Triangulated();
  if (options.method == MappingMethod::kUnseeded) return mapper.Unseeded();
  return mapper.Seeded();
}

}  // namespace rigmap

#include "workflows/stages/features.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/artefact.h"
#include "core/error.h"
#include "core/job.h"
#include "core/memory_share.h"
#include "core/progress.h"
#include "core/statistics.h"
#include "correspondence/stereo_points.h"
#include "pipeline/code_identity.h"
#include "workflows/stages/joinable.h"

namespace rigmap {
namespace {

constexpr const char* kJoinableFeatures = "joining/features.bin";
constexpr const char* kJoinableInput = "joining/input.bin";

struct StoredInput {
  JoinableInput input;

  template <class Archive>
  void save(Archive& archive) const {
    const PooledRig& file = input.rig_file;
    archive(input.dataset, input.content, file.rig, file.pool.has_value());
    if (!file.pool) return;
    archive(file.pool->start, file.pool->parts.size());
    for (const RigWithoutPart& part : file.pool->parts) {
      archive(part.frames, part.correction, part.covariance);
    }
  }
  template <class Archive>
  void load(Archive& archive) {
    PooledRig& file = input.rig_file;
    bool is_pooled = false;
    archive(input.dataset, input.content, file.rig, is_pooled);
    if (!is_pooled) return;
    std::size_t parts = 0;
    archive(file.pool.emplace().start, parts);
    for (std::size_t i = 0; i < parts; ++i) {
      RigWithoutPart& part = file.pool->parts.emplace_back();
      archive(part.frames, part.correction, part.covariance);
    }
  }
};

// As kept, or found now and kept.
FrameFeatures FeaturesOf(const StereoFrame& frame, const FrameFile& file, const FeatureSetup& setup,
                         const StageContext& context) {
  const auto path = file.In(context.root);
  if (context.may_reuse) {
    if (auto kept = ReadArtefact<FrameFeatures>(path, file.key)) return std::move(*kept);
  }
  FrameFeatures features = ExtractFeatures(frame, setup);
  WriteArtefact(path, file.key, features);
  return features;
}

// Of a frame whose keypoints are looked for: both images, their scales and gradients.
double MegabytesOf(const StereoRig& rig) {
  constexpr double kPerMegapixel = 62.0;  // measured at 12
  const Camera& camera = rig.left.camera;
  return kPerMegapixel * 1e-6 * camera.width * camera.height;
}

FeatureIndex MakeFeatures(const StageContext& context, const Dataset& dataset,
                          const DatasetContent& content, const FeatureOptions& options,
                          const MaskOptions& masks) {
  const FeatureSetup setup = MakeFeatureSetup(dataset.rig, options, masks);
  const std::string how =
      std::string(CodeHere()) + content.rig + OptionsText(options) + OptionsText(masks);
  const std::size_t count = dataset.frames.size();
  FeatureIndex index{
      .how = HashText(std::string(CodeHere()) + OptionsText(options) + OptionsText(masks))};
  for (std::size_t i = 0; i < count; ++i) {
    index.files.push_back(
        FrameFileOf("features", dataset.frames[i].stamp_ns, HashText(how + content.frames[i])));
  }
  std::vector<std::optional<float>> epipolar(count);
  std::vector<std::optional<double>> near_m(count);
  std::vector<std::vector<std::string>> unreadable(count);
  Progress progress("features", count);
  const auto extract = [&](std::size_t i) {
    FrameFeatures features = FeaturesOf(dataset.frames[i], index.files[i], setup, context);
    if (!features.epipolar_errors_px.empty()) {
      epipolar[i] = MedianAbsolute(features.epipolar_errors_px);
    }
    near_m[i] = NearDepth(features.features, dataset.rig);
    unreadable[i] = std::move(features.unreadable_images);
    progress.Advance();
  };
  const int sharing = Job::Current()->sharing();
  const double room_mb = static_cast<double>(context.memory_mb) / sharing - kProgramMegabytes;
  const int at_once = static_cast<int>(room_mb / MegabytesOf(dataset.rig));
  Job::Current()->RunWithThreads(std::clamp(at_once, 1, context.threads),
                                 [&] { tbb::parallel_for(std::size_t{0}, count, extract); });
  for (std::size_t i = 0; i < count; ++i) {
    if (epipolar[i]) index.epipolar_px.push_back(*epipolar[i]);
    if (near_m[i]) index.near_m.push_back(static_cast<float>(*near_m[i]));
    if (unreadable[i].empty()) continue;
    index.unreadable_frames.push_back(static_cast<int>(i));
    index.unreadable_images.insert(index.unreadable_images.end(), unreadable[i].begin(),
                                   unreadable[i].end());
  }
  ForgetOlderFrames(context.root, index.files);
  const FeatureStore all = OpenFeatures(context, index);  // of which none is the rig's yet
  index.rig_fixed = FindRigFixed(static_cast<int>(count), all.AsSource(), dataset.rig.left.camera);
  return index;
}

Report ReportFeatures(const FeatureIndex& index, const Dataset&, const DatasetContent&) {
  for (const std::string& path : index.unreadable_images) {
    spdlog::warn("{}: cannot be read as an image, its frame shows nothing", path);
  }
  return {{"health", {{"unreadable_images", index.unreadable_images}}}};
}

void PublishFeatures(Publication& publication, const StageContext&, const FeatureIndex& index,
                     const Dataset&, const DatasetContent&) {
  PublishJoinable(publication, kJoinableFeatures, CodeHere(), index);
}

bool AreFeaturesThere(const StageContext& context, const FeatureIndex& index) {
  return AreThere(context.root, index.files);
}

}  // namespace

void RequireMemoryForFeatures(const StereoRig& rig, int allowed_mb) {
  const double needed_mb = kProgramMegabytes + MegabytesOf(rig);
  if (needed_mb <= allowed_mb) return;
  throw UsageError(
      fmt::format("--memory: expected at least {:.0f} MB, for images as large as these, found {}",
                  std::ceil(needed_mb), allowed_mb));
}

FeaturesStage Features() {
  return {.name = "features",
          .about =
              "SIFT keypoints of the left image with aligned stereo matches in the right; glare, "
              "sky and what belongs to the rover left out",
          .code = CodeHere(),
          .make = MakeFeatures,
          .publishes = {kJoinableFeatures},
          .publish = PublishFeatures,
          .is_whole = AreFeaturesThere,
          .report = ReportFeatures};
}

FeatureIndex ReadJoinableFeatures(const std::filesystem::path& root) {
  return ReadJoinable<FeatureIndex>(root, kJoinableFeatures, CodeHere());
}

void WriteJoinableInput(const std::filesystem::path& root, JoinableInput input) {
  input.rig_file.rig.source.clear();
  std::filesystem::create_directories((root / kJoinableInput).parent_path());
  WriteArtefact(root / kJoinableInput, HashText(CodeHere()), StoredInput{std::move(input)});
}

JoinableInput ReadJoinableInput(const std::filesystem::path& root) {
  return ReadJoinable<StoredInput>(root, kJoinableInput, CodeHere()).input;
}

FeatureStore OpenFeatures(const StageContext& context, const FeatureIndex& index) {
  std::vector<FeatureFile> files;
  for (const FrameFile& file : index.files) files.push_back({file.In(context.root), file.key});
  return {std::move(files), index.rig_fixed};
}

}  // namespace rigmap

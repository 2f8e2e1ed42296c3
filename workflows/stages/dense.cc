#include "workflows/stages/dense.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <functional>
#include <mutex>

#include "core/artefact.h"
#include "core/freed_memory.h"
#include "core/job.h"
#include "core/memory_share.h"
#include "core/progress.h"
#include "core/statistics.h"
#include "correspondence/stereo_points.h"
#include "dense/frames_for_depth.h"
#include "dense/seen_depths.h"
#include "pipeline/code_identity.h"
#include "workflows/stages/dense_memory.h"
#include "workflows/stages/joinable.h"

namespace rigmap {
namespace {

constexpr const char* kJoinableDepths = "joining/depths.bin";

// Of the memory for dense matching, what may stay with the process from frame to frame; the rest is
// for one that needs more than those before.
constexpr double kKeptShare = 2.0 / 3.0;

std::optional<double> MedianOfKnown(const std::vector<std::optional<double>>& values) {
  std::vector<double> known;
  for (const auto& value : values) {
    if (value) known.push_back(*value);
  }
  return known.empty() ? std::nullopt : std::optional(Median(std::move(known)));
}

constexpr double kPair_mb = 1.0;  // of each pair of a part (docs/traverse.md)

// What dense matching may take, megabytes: of what is free now an even share but, beside other
// parts at work, no less than is left to a part that keeps to its share of the whole.
double RoomForDepth(std::size_t pairs, double allowed_mb) {
  const int sharing = Job::Current()->sharing();
  const double free_mb = MemoryShare(allowed_mb);
  if (sharing == 1) return free_mb;
  return std::max(free_mb,
                  allowed_mb / sharing - kProgramMegabytes - kPair_mb * static_cast<double>(pairs));
}

// Calls `match` for each of so many frames, as many at once as memory allows.
void MatchEach(std::size_t frames, int at_once, const std::function<void(std::size_t)>& match) {
  static std::mutex only_one;  // in the process: frames that do not fit beside each other
  Job::Current()->RunWithThreads(std::max(1, at_once), [&] {
    if (at_once > 0) {
      tbb::parallel_for(std::size_t{0}, frames, match);
      return;
    }
    for (std::size_t i = 0; i < frames; ++i) {
      const std::lock_guard lock(only_one);
      match(i);
    }
  });
}

// What is asked of the matcher, whatever the frames.
struct DenseRequest {
  const DenseOptions& options;
  const MaskOptions& masks;
  const VoxelOptions& voxel;
};

// An index without frames, of what was seen.
DepthIndex IndexFor(const StereoRig& rig, const SeenDepths& seen, const VoxelOptions& voxel) {
  DepthIndex index{.near_m = seen.near_m};
  index.voxel_m = voxel.voxel_m > 0.0 ? voxel.voxel_m : VoxelFor(rig, seen);
  return index;
}

// What of a rig depth depends on; masks by their pixels, not their names.
std::string DescribeForDepth(const PosedPart& part) {
  const StereoRig& rig = part.rig;
  StereoRig cameras;
  cameras.left = rig.left;
  cameras.right = rig.right;
  cameras.right_from_left = rig.right_from_left;
  std::string text = DescribeRig(cameras);
  for (const Eye eye : kEyes) {
    const std::string& path = rig.Of(eye).mask_path;
    text += path.empty() ? "no mask\n" : HashFile(path) + "\n";
    if (const auto& field = rig.Of(eye).lens_field) {
      for (const Eigen::Vector2d& moved : field->displacements) {
        text += fmt::format("{} {} ", moved.x(), moved.y());
      }
    }
  }
  for (const Eigen::Vector3d& turn : part.right_turns) {
    text += fmt::format("{} {} {} ", turn.x(), turn.y(), turn.z());
  }
  return text;
}

// The depth of the index's frames.
DepthIndex MatchFrames(const StageContext& context, const Dataset& dataset,
                       const DatasetContent& content, const RigFixedCells& fixed,
                       const PosedPart& part, double seen_nearest_m, const DenseRequest& request,
                       DepthIndex index, const KnownDepths& known = {}) {
  const auto& [options, masks, voxel] = request;
  const StereoRig& rig = part.rig;
  const double nearest_m = options.min_depth_m > 0.0 ? options.min_depth_m : seen_nearest_m;
  const Camera& camera = rig.left.camera;
  const DenseMatcher matcher(rig, nearest_m, options, masks,
                             fixed.Mask(camera.width, camera.height));
  index.view_mb = matcher.MegabytesPerView();
  index.how = HashText(std::string(CodeHere()) + DescribeForDepth(part) + OptionsText(options) +
                       OptionsText(masks));
  const std::string how =
      index.how + std::string(fixed.fixed.begin(), fixed.fixed.end()) + std::to_string(nearest_m);
  std::vector<FrameFile> own;  // not those of parts
  std::vector<char> is_own;    // per frame of the index
  for (const int frame : index.frames) {
    const std::optional<FrameFile> of_part = known.FileOf(frame, index.how);
    is_own.push_back(!of_part || !HasArtefact(of_part->In(context.root), of_part->key));
    if (is_own.back()) {
      own.push_back(FrameFileOf("dense", dataset.frames[frame].stamp_ns,
                                HashText(how + content.frames[frame])));
    }
    index.files.push_back(is_own.back() ? own.back() : *of_part);
  }
  std::vector<std::optional<double>> biases(index.frames.size());
  Progress progress("dense", index.frames.size());
  const int at_once = FramesAtOnce(
      matcher.MegabytesPerFrame(), nearest_m,
      {RoomForDepth(dataset.frames.size(), context.memory_mb), context.memory_mb, context.threads});
  MatchEach(index.frames.size(), at_once, [&](std::size_t i) {
    const int frame = index.frames[i];
    const FrameFile& file = index.files[i];
    const auto path = file.In(context.root);
    std::optional<DepthMap> depth;
    if (context.may_reuse || !is_own[i]) depth = LoadDepth(path, file.key);
    if (!depth) {
      depth = part.right_turns.empty()
                  ? matcher.Compute(dataset.frames[frame])
                  : matcher.Compute(dataset.frames[frame], part.right_turns[frame]);
      SaveDepth(path, file.key, *depth);
      ReturnFreedMemory(kKeptShare * context.memory_mb);
    }
    biases[i] = DisparityBiasPx(*depth, part.points_in_left[frame]);
    progress.Advance();
  });
  ForgetOlderFrames(context.root, own);
  index.bias_px = MedianOfKnown(biases);
  return index;
}

DepthIndex MakeJoinedDepths(const StageContext& context, const Dataset& dataset,
                            const DatasetContent& content, const FeatureIndex& features,
                            const PosedPart& part, const KnownDepths& known,
                            const DenseOptions& options, const MaskOptions& masks,
                            const VoxelOptions& voxel) {
  const SeenDepths seen = DepthsSeen(part.rig, part.points_in_left, features.near_m);
  DepthIndex index = IndexFor(part.rig, seen, voxel);
  index.frames = FramesForDepth(
      {part.trajectory, part.rig.left.camera, part.points_in_left, features.unreadable_frames},
      seen.near_m, index.voxel_m);
  return MatchFrames(context, dataset, content, features.rig_fixed, part, seen.nearest_m,
                     {options, masks, voxel}, std::move(index), known);
}

DepthIndex MakeDepths(const StageContext& context, const Dataset& dataset,
                      const DatasetContent& content, const FeatureIndex& features,
                      const PosedPart& part, const DenseOptions& options, const MaskOptions& masks,
                      const VoxelOptions& voxel) {
  return MakeJoinedDepths(context, dataset, content, features, part, {}, options, masks, voxel);
}

DepthIndex MakeFrameDepths(const StageContext& context, const Dataset& dataset,
                           const DatasetContent& content, const FeatureIndex& features,
                           const FeatureStore& store, const DenseOptions& options,
                           const MaskOptions& masks, const VoxelOptions& voxel) {
  constexpr double kAnyNoise_px = 0.1;  // for sigmas that nobody asks for
  DenseOptions of_single_frames = options;
  of_single_frames.keep_bends = false;  // no other frame averages the noise away
  PosedPart without_poses{.rig = dataset.rig};
  PointsInLeft& points_in_left = without_poses.points_in_left;
  points_in_left.resize(dataset.frames.size());
  for (std::size_t i = 0; i < points_in_left.size(); ++i) {
    const FrameFeatures frame = store.Get(static_cast<int>(i));
    for (const auto& point : TriangulateFeatures(frame.features, dataset.rig, kAnyNoise_px)) {
      if (point) points_in_left[i].push_back(point->x_in_left);
    }
  }
  const SeenDepths seen = DepthsSeen(dataset.rig, points_in_left, features.near_m);
  DepthIndex index = IndexFor(dataset.rig, seen, voxel);
  for (int frame = 0; frame < static_cast<int>(dataset.frames.size()); ++frame) {
    if (!std::ranges::binary_search(features.unreadable_frames, frame)) {
      index.frames.push_back(frame);
    }
  }
  return MatchFrames(context, dataset, content, features.rig_fixed, without_poses, seen.nearest_m,
                     {of_single_frames, masks, voxel}, std::move(index));
}

void PublishDepths(Publication& publication, const StageContext&, const DepthIndex& index,
                   const Dataset&, const DatasetContent&, const FeatureIndex&, const PosedPart&) {
  PublishJoinable(publication, kJoinableDepths, CodeHere(), index);
}

bool AreDepthsThere(const StageContext& context, const DepthIndex& index) {
  return AreThere(context.root, index.files);
}

}  // namespace

DenseStage DenseMatching() {
  return {.name = "dense",
          .about =
              "depth of keyframes, and of frames between them where more passes, by semi-global "
              "matching, refined below the pixel, each pixel with its sigma",
          .code = CodeHere(),
          .make = MakeDepths,
          .publishes = {kJoinableDepths},
          .publish = PublishDepths,
          .is_whole = AreDepthsThere};
}

std::optional<DepthIndex> ReadJoinableDepths(const std::filesystem::path& root) {
  if (!std::filesystem::exists(root / kJoinableDepths)) return std::nullopt;
  return ReadJoinable<DepthIndex>(root, kJoinableDepths, CodeHere());
}

std::optional<FrameFile> KnownDepths::FileOf(int frame, const std::string& how) const {
  if (of_frames.empty() || !of_frames[frame] || of_frames[frame]->how != how) return std::nullopt;
  return of_frames[frame]->file;
}

JoinedDenseStage JoinedDepths() {
  return {.name = "dense",
          .about =
              "depth of each frame of the map as its part has found it; anew where the rig was "
              "corrected since",
          .code = CodeHere(),
          .make = MakeJoinedDepths,
          .is_whole = AreDepthsThere};
}

FrameDepthStage FrameDepths() {
  return {.name = "dense",
          .about = "depth of each frame by semi-global matching, as for keyframes elsewhere",
          .code = CodeHere(),
          .make = MakeFrameDepths,
          .is_whole = AreDepthsThere};
}

}  // namespace rigmap

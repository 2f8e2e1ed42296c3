#include "workflows/stages/joined_parts.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <map>

#include "core/disjoint_sets.h"
#include "pipeline/code_identity.h"
#include "workflows/stages/database.h"
#include "workflows/stages/odometry.h"

namespace rigmap {
namespace {

FeatureIndex MakeFeatures(const StageContext& context, const Dataset& dataset,
                          const JoinedParts& parts) {
  FeatureIndex index{.files = parts.features,
                     .epipolar_px = parts.epipolar_px,
                     .near_m = parts.near_m,
                     .unreadable_frames = parts.unreadable_frames,
                     .unreadable_images = parts.unreadable_images};
  const FeatureStore all = OpenFeatures(context, index);  // of which none is the rig's yet
  index.rig_fixed = FindRigFixed(all.frame_count(), all.AsSource(), dataset.rig.left.camera);
  return index;
}

bool AreFeaturesThere(const StageContext& context, const FeatureIndex& index) {
  return AreThere(context.root, index.files);
}

// Where the names of the images in sparse/ lead to.
void PublishImages(Publication& publication, const StageContext&, const FeatureIndex&,
                   const Dataset& dataset, const JoinedParts&) {
  LinkImages(dataset, publication.Path("colmap/images"));
}

Report ReportFeatures(const FeatureIndex& index, const Dataset&, const JoinedParts&) {
  return {{"health", {{"unreadable_images", index.unreadable_images}}}};
}

// What parts have found between two frames that they have both.
ExpectedMotion MotionInParts(const JoinedParts& parts) {
  return [&parts](int from, int to) -> std::optional<Rigid3> {
    for (const JoinedParts::Part& part : parts.parts) {
      const auto find = [&](int frame) {
        const auto at = std::ranges::lower_bound(part.world_from_left, frame, {},
                                                 &std::pair<int, Rigid3>::first);
        return at != part.world_from_left.end() && at->first == frame ? &at->second : nullptr;
      };
      const Rigid3 *world_from_a = find(from), *world_from_b = find(to);
      if (world_from_a && world_from_b) return world_from_b->Inverse() * *world_from_a;
    }
    return std::nullopt;
  };
}

Odometry MakeOdometry(const StageContext&, const Dataset& dataset, const FeatureStore& features,
                      const JoinedParts& parts, const FeatureOptions& of_features,
                      const CornerOptions& corners, const MaskOptions& masks,
                      const OdometryOptions& options, const DeadReckoningOptions& rover,
                      const FilterOptions& filter) {
  Odometry odometry =
      Bridged(dataset, dataset.rig, features,
              TrackAll(dataset, features, options, MatchBy::kDescriptors, MotionInParts(parts)),
              {of_features, corners, masks, options, rover, filter});
  for (std::size_t i = 0; i < odometry.size(); ++i) {
    odometry[i].keyframe = parts.keyframes[i] != 0;
  }
  return odometry;
}

Report ReportOdometry(const Odometry& odometry, const Dataset&, const FeatureStore&,
                      const JoinedParts&) {
  return {
      {"frames", {{"keyframes", std::ranges::count(odometry, true, &OdometryFrame::keyframe)}}}};
}

// Parts whose frames hang together by measured motion; the world with most frames first.
std::vector<std::vector<int>> WorldsOf(const JoinedParts& parts, const AdjustedPart& whole) {
  DisjointSets frames(whole.odometry.size());
  const auto join = [&](int a, int b) {
    const int root = frames.Root(a), other = frames.Root(b);
    if (root != other) frames.Unite(root, other);
  };
  for (int i = 0; i < std::ssize(whole.odometry); ++i) {
    const OdometryFrame& frame = whole.odometry[i];
    if (whole.adjustment.world_from_left[i]) join(i, whole.adjustment.datum_frames[i]);
    if (frame.source != PoseSource::kPredicted) join(i, frame.reference);
  }
  // A part lies where most of its frames do.
  std::map<int, int> frame_counts;  // of each world
  std::vector<std::map<int, int>> of_parts(parts.parts.size());
  for (int i = 0; i < std::ssize(parts.first_part); ++i) {
    ++frame_counts[frames.Root(i)];
    ++of_parts[parts.first_part[i]][frames.Root(i)];
  }
  std::map<int, std::vector<int>> worlds;
  for (std::size_t p = 0; p < of_parts.size(); ++p) {
    // All frames of a part may be those of parts before it.
    if (of_parts[p].empty()) {
      for (const auto& [frame, pose] : parts.parts[p].world_from_left) {
        ++of_parts[p][frames.Root(frame)];
      }
    }
    if (of_parts[p].empty()) continue;
    const auto main =
        std::ranges::max_element(of_parts[p], {}, [](const auto& entry) { return entry.second; });
    worlds[main->first].push_back(static_cast<int>(p));
  }
  std::vector<std::pair<int, std::vector<int>>> ranked;
  for (auto& [root, members] : worlds) ranked.emplace_back(-frame_counts[root], members);
  std::ranges::stable_sort(ranked, {}, [](const auto& entry) { return entry.first; });
  std::vector<std::vector<int>> sorted;
  for (auto& [count, members] : ranked) sorted.push_back(std::move(members));
  return sorted;
}

// Where the part's world lies in that of the frames posed already.
Rigid3 WorldFromPart(const JoinedParts::Part& part, const Odometry& odometry,
                     const std::vector<std::optional<Rigid3>>& known) {
  std::vector<Rigid3> by_shared;
  for (const auto& [frame, own] : part.world_from_left) {
    if (known[frame]) by_shared.push_back(*known[frame] * own.Inverse());
  }
  // Both know the middle of what they share better than its ends.
  if (!by_shared.empty()) return by_shared[by_shared.size() / 2];
  const auto& [first, own] = part.world_from_left.front();
  int before = first;
  while (before > 0 && !known[before]) --before;
  const Rigid3 last = known[before] ? *known[before] : odometry[before].world_from_left;
  return last * OdometricStep(odometry, before, first) * own.Inverse();
}

// A part by itself, and the same frames as they are in the whole.
void AddPartSteps(const JoinedParts::Part& part, const Trajectory& whole, Steps& steps) {
  if (part.world_from_left.empty()) return;
  Trajectory alone, joined;
  for (const auto& [frame, own] : part.world_from_left) {
    joined.push_back(whole[frame]);
    alone.push_back(whole[frame]);
    alone.back().world_from_left = own;
  }
  steps.push_back({fmt::format("part-{}-alone", part.name), std::move(alone)});
  steps.push_back({fmt::format("part-{}-joined", part.name), std::move(joined)});
}

Steps MakeSteps(const StageContext&, const Odometry& odometry, const AdjustedPart& whole,
                const JoinedParts& parts) {
  std::vector<std::optional<Rigid3>> chained(odometry.size());
  for (const JoinedParts::Part& part : parts.parts) {
    if (part.world_from_left.empty()) continue;
    const Rigid3 world_from_part = WorldFromPart(part, odometry, chained);
    for (const auto& [frame, own] : part.world_from_left) {
      if (!chained[frame]) chained[frame] = world_from_part * own;
    }
  }
  const std::vector<std::optional<Rigid3>> none(odometry.size());
  Steps steps{{kStepNames[0], AssembleStep(odometry, none, whole.trajectory)},
              {kStepNames[2], AssembleStep(odometry, std::move(chained), whole.trajectory)},
              {kStepNames[3], whole.trajectory}};
  for (const JoinedParts::Part& part : parts.parts) AddPartSteps(part, whole.trajectory, steps);
  return steps;
}

void PublishJoinedSteps(Publication& publication, const StageContext&, const Steps& steps,
                        const Odometry&, const AdjustedPart&, const JoinedParts&) {
  PublishSteps(publication, steps);
}

Report JudgeJoin(const JoinedParts& parts, const AdjustedPart& whole) {
  Report worlds = Report::array();
  std::vector<std::string> groups;
  for (const auto& world : WorldsOf(parts, whole)) {
    std::vector<std::string> names;
    for (const int part : world) names.push_back(parts.parts[part].name);
    groups.push_back(fmt::format("{}", fmt::join(names, ", ")));
    worlds.push_back(names);
  }
  const auto gate = [](const char* name, std::size_t value, std::size_t limit, std::string why) {
    return Report{{"name", name},
                  {"value", value},
                  {"limit", limit},
                  {"passed", value <= limit},
                  {"why", std::move(why)}};
  };
  return {
      {"worlds", worlds},
      {"gates",
       {gate("worlds", groups.size(), 1,
             groups.size() > 1 ? fmt::format("nothing measured ties these parts to each other: {}",
                                             fmt::join(groups, " | "))
                               : "every part is tied to the others by what was measured"),
        gate("parts_missing", parts.missing.size(), 0,
             parts.missing.empty() ? "all parts are joined"
                                   : fmt::format("{}", fmt::join(parts.missing, "; ")))}}};
}

}  // namespace

JoinedStepsStage JoinedSteps() {
  return {
      .name = "steps",
      .about =
          "the trajectory after odometry, of the parts chained, and after the adjustment of all",
      .code = CodeHere(),
      .make = MakeSteps,
      .publishes = {"steps"},
      .publish = PublishJoinedSteps};
}

JoinGatesCheck JoinGates() {
  return {.name = "join_gates",
          .code = CodeHere(),
          .make = JudgeJoin,
          .about = "whether all parts are there, and tied to each other"};
}

JoinedFeaturesStage JoinedFeatures() {
  return {.name = "features",
          .about = "keypoints as the parts found them",
          .code = CodeHere(),
          .make = MakeFeatures,
          .publishes = {"colmap/images"},
          .publish = PublishImages,
          .is_whole = AreFeaturesThere,
          .report = ReportFeatures};
}

JoinedOdometryStage JoinedOdometry() {
  return {.name = "odometry",
          .about = "metric motion over all parts and across their seams; the parts' keyframes",
          .code = CodeHere(),
          .make = MakeOdometry,
          .report = ReportOdometry};
}

Report ReportParts(const JoinedParts& parts) {
  Report list = Report::array();
  for (const JoinedParts::Part& part : parts.parts) {
    list.push_back({{"name", part.name},
                    {"frames", part.frames},
                    {"shared_with_earlier", part.shared},
                    {"status", part.status.empty() ? Report(nullptr) : Report(part.status)}});
  }
  return {{"parts", std::move(list)}};
}

}  // namespace rigmap

#include "workflows/union_of_parts.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "dataset/rover_sensor_files.h"
#include "workflows/opened_part.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

// One frame of one part.
struct PartFrame {
  int part = 0, frame = 0;
};

// Puts the parts together frame by frame.
class Uniter {
 public:
  Uniter(const std::vector<OpenedPart>& parts, const fs::path& out)
      : parts_(parts), out_(fs::absolute(out)) {
    for (int p = 0; p < static_cast<int>(parts.size()); ++p) {
      for (int i = 0; i < std::ssize(parts[p].Stereo()); ++i) frames_.push_back({p, i});
    }
    std::ranges::stable_sort(frames_, {}, [&](const PartFrame& f) { return StampOf(f); });
  }

  UnionOfParts Unite() {
    result_.dataset.format = parts_.front().input.dataset.format;
    PooledRig rig_file = RigFileOfAll(parts_);
    result_.dataset.rig = std::move(rig_file.rig);
    result_.dataset.rig_pool = std::move(rig_file.pool);
    for (const OpenedPart& part : parts_) AddPart(part);
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      const bool is_new = i == 0 || StampOf(frames_[i]) != StampOf(frames_[i - 1]);
      is_new ? AddFrame(frames_[i]) : AddAgain(frames_[i]);
    }
    std::vector<std::pair<std::string, std::vector<std::string>>> remarks;
    for (const OpenedPart& part : parts_) {
      remarks.emplace_back(part.name, part.input.dataset.health.remarks);
    }
    result_.dataset.health.remarks = RemarksOfParts(remarks);
    CountImages();
    AddSensors();
    AddTrajectories();
    return std::move(result_);
  }

 private:
  StampNs StampOf(const PartFrame& f) const { return parts_[f.part].Stereo()[f.frame].stamp_ns; }
  const std::string& ContentOf(const PartFrame& f) const {
    return parts_[f.part].input.content.frames[f.frame];
  }
  const std::string& ImagesOf(const PartFrame& f) const {
    return parts_[f.part].input.content.images[f.frame];
  }
  FrameFile FromOut(const OpenedPart& part, const FrameFile& file) const {
    return {fs::relative(part.root / file.name, out_).string(), file.key};
  }

  void AddPart(const OpenedPart& part) {
    const Dataset& dataset = part.input.dataset;
    result_.parts.parts.push_back(
        {part.name, static_cast<int>(dataset.frames.size()), 0, part.status});
    const auto add = [](const std::vector<float>& of_frames, std::vector<float>& all) {
      all.insert(all.end(), of_frames.begin(), of_frames.end());
    };
    add(part.features.epipolar_px, result_.parts.epipolar_px);
    add(part.features.near_m, result_.parts.near_m);
    DatasetHealth& health = result_.dataset.health;
    const auto append = [](const auto& from, auto& to) {
      for (const auto& text : from) {
        if (!std::ranges::count(to, text)) to.push_back(text);
      }
    };
    append(dataset.health.lone_images, health.lone_images);
    append(dataset.health.unreadable_images, health.unreadable_images);
    append(part.features.unreadable_images, result_.parts.unreadable_images);
  }

  void AddFrame(const PartFrame& f) {
    const OpenedPart& part = parts_[f.part];
    const int index = static_cast<int>(result_.dataset.frames.size());
    result_.dataset.frames.push_back(part.Stereo()[f.frame]);
    result_.contents.push_back(ContentOf(f));
    last_ = f;
    result_.parts.first_part.push_back(f.part);
    result_.parts.features.push_back(FromOut(part, part.features.files[f.frame]));
    result_.parts.keyframes.push_back(part.odometry[f.frame].keyframe ? 1 : 0);
    if (std::ranges::binary_search(part.features.unreadable_frames, f.frame)) {
      result_.parts.unreadable_frames.push_back(index);
    }
    result_.depths.of_frames.emplace_back();
    AddDepth(f);
  }

  // Parts cut from one folder have all seen all of its images.
  void CountImages() {
    DatasetHealth& health = result_.dataset.health;
    health.images_read =
        static_cast<int>(2 * result_.dataset.frames.size() + health.lone_images.size() +
                         health.unreadable_images.size());
  }

  // The frame before it, which an earlier part has as well.
  void AddAgain(const PartFrame& f) {
    const OpenedPart& part = parts_[f.part];
    // By their bytes: how many bits of a value are used each part finds by its own images.
    if (ImagesOf(f) != ImagesOf(last_)) {
      throw DataError(fmt::format("{}: expected {} as other parts have it, found another image",
                                  part.root.string(), part.Stereo()[f.frame].left_path));
    }
    ++result_.parts.parts[f.part].shared;
    if (part.odometry[f.frame].keyframe) result_.parts.keyframes.back() = 1;
    AddDepth(f);
  }

  void AddDepth(const PartFrame& f) {
    const OpenedPart& part = parts_[f.part];
    auto& known = result_.depths.of_frames.back();
    if (known || !part.depths) return;
    const auto found = std::ranges::find(part.depths->frames, f.frame);
    if (found == part.depths->frames.end()) return;
    const auto& file =
        part.depths->files[static_cast<std::size_t>(found - part.depths->frames.begin())];
    if (!fs::exists(part.root / file.name)) return;  // made anew then
    known = KnownDepths::Known{FromOut(part, file), part.depths->how};
  }

  void AddTrajectories() {
    const auto& frames = result_.dataset.frames;
    for (std::size_t p = 0; p < parts_.size(); ++p) {
      for (const TumPose& pose : parts_[p].trajectory) {
        const auto at = std::ranges::lower_bound(frames, pose.stamp_ns, {}, &StereoFrame::stamp_ns);
        if (at == frames.end() || at->stamp_ns != pose.stamp_ns) continue;
        result_.parts.parts[p].world_from_left.emplace_back(static_cast<int>(at - frames.begin()),
                                                            pose.world_from_body);
      }
    }
  }

  // Parts cut from one drive repeat what was measured around their seams.
  void AddSensors() {
    Dataset& d = result_.dataset;
    for (const OpenedPart& part : parts_) {
      const Dataset& own = part.input.dataset;
      Append(own.lone_images, d.lone_images);
      Append(own.inclinometer, d.inclinometer);
      AppendRecord(own.wheels, d.wheels);
      AppendRecord(own.inertial, d.inertial);
      Append(own.fixes, d.fixes);
      if (d.surveyed_landmarks.empty()) d.surveyed_landmarks = own.surveyed_landmarks;
    }
    InOrder(d.lone_images);
    InOrder(d.inclinometer);
    InOrder(d.wheels.samples);
    UnwrapDriveAngles(d.wheels.samples);
    InOrder(d.inertial.samples);
    InOrder(d.fixes);
  }

  template <class Sample>
  static void Append(const std::vector<Sample>& from, std::vector<Sample>& to) {
    to.insert(to.end(), from.begin(), from.end());
  }
  template <class Sample>
  static void InOrder(std::vector<Sample>& samples) {
    std::ranges::stable_sort(samples, {}, &Sample::stamp_ns);
    const auto repeated = std::ranges::unique(samples, {}, &Sample::stamp_ns);
    samples.erase(repeated.begin(), repeated.end());
  }

  const std::vector<OpenedPart>& parts_;
  fs::path out_;
  std::vector<PartFrame> frames_;  // of all parts, in order of time
  PartFrame last_;                 // of these that was added, not again
  UnionOfParts result_;
};

}  // namespace

FolderMark UnionOfParts::Mark() const {
  DatasetContent content;
  content.frames = contents;
  return MarkOf(dataset, content);
}

UnionOfParts UniteParts(const std::vector<PartFolder>& folders, const fs::path& out) {
  std::vector<OpenedPart> parts = OpenAlike(folders);
  std::ranges::stable_sort(parts, {}, &OpenedPart::FirstStamp);
  // All parts of a stereo folder come with its truth.
  UnionOfParts whole = Uniter(parts, fs::weakly_canonical(out)).Unite();
  const std::string& truth = parts.front().input.dataset.truth_path;
  const bool same = std::ranges::all_of(
      parts, [&](const OpenedPart& part) { return part.input.dataset.truth_path == truth; });
  if (same) whole.dataset.truth_path = truth;
  return whole;
}

std::vector<std::string> RemarksOfParts(
    const std::vector<std::pair<std::string, std::vector<std::string>>>& parts) {
  std::vector<std::string> all;
  for (const auto& [name, remarks] : parts) {
    for (const std::string& remark : remarks) {
      const bool is_of_all = std::ranges::all_of(
          parts, [&](const auto& part) { return std::ranges::count(part.second, remark) > 0; });
      std::string text = is_of_all ? remark : fmt::format("part {}: {}", name, remark);
      if (!std::ranges::count(all, text)) all.push_back(std::move(text));
    }
  }
  return all;
}

}  // namespace rigmap

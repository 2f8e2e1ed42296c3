#include "dataset/open_dataset.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <set>
#include <vector>

#include "core/error.h"
#include "dataset/inclinometer.h"
#include "dataset/internal/gnss_file.h"
#include "dataset/internal/image_checks.h"
#include "dataset/internal/katwijk.h"
#include "dataset/internal/rock_file.h"
#include "dataset/internal/stereo_folder.h"
#include "dataset/rig_file.h"
#include "dataset/rover_sensor_files.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

// Absolute, without dots or a slash at its end, so that parent_path is the folder above.
fs::path AbsoluteFolder(const fs::path& folder) {
  std::error_code code;
  if (!fs::is_directory(folder, code)) {
    throw DataError(fmt::format("{}: expected a data set folder, found {}", folder.string(),
                                fs::exists(folder, code) ? "a file" : "nothing"));
  }
  const fs::path absolute = fs::absolute(folder).lexically_normal();
  return absolute.has_filename() ? absolute : absolute.parent_path();
}

// ", but PATH is one", for the first folder in it that is a data set; else nothing.
std::string DatasetBelow(const fs::path& folder) {
  std::set<fs::path> found;
  for (const auto& entry : fs::directory_iterator(folder)) {
    if (!entry.is_directory()) continue;
    if (IsStereoFolder(entry.path()) || !FindKatwijkParts(entry.path()).empty()) {
      found.insert(entry.path());
    }
  }
  return found.empty() ? "" : fmt::format(", but {} is one", found.begin()->string());
}

DatasetFormat FindFormat(const DatasetRequest& request, const fs::path& folder) {
  if (request.format) {
    for (const auto format : {DatasetFormat::kKatwijk, DatasetFormat::kStereoFolder}) {
      if (*request.format == Name(format)) return format;
    }
    throw UsageError(
        fmt::format("--format: expected katwijk or stereo, found '{}'", *request.format));
  }
  if (!FindKatwijkParts(folder).empty()) return DatasetFormat::kKatwijk;
  if (IsStereoFolder(folder)) return DatasetFormat::kStereoFolder;
  throw DataError(
      fmt::format("{}: expected a Katwijk root or part (Traverse<T>/Part<P>/LocCam, "
                  "LocCam) or a stereo folder (left, right, times.txt), found neither{}",
                  folder.string(), DatasetBelow(folder)));
}

std::optional<fs::path> RigFileIn(const fs::path& folder) {
  std::optional<fs::path> found;
  for (const char* name : {"calib.yaml", "rig.yaml"}) {
    std::error_code ignored;
    if (!fs::exists(folder / name, ignored)) continue;
    if (found) {
      spdlog::warn("{} is not used: {} is", (folder / name).string(), found->string());
    } else {
      found = folder / name;
    }
  }
  return found;
}

fs::path FindRigFile(const DatasetRequest& request, const std::vector<fs::path>& folders) {
  if (request.rig) return *request.rig;
  for (const auto& folder : folders) {
    if (const auto path = RigFileIn(folder)) return *path;
  }
  return {};
}

// Frames of the part or folder, and where its rig may lie.
struct Opened {
  Dataset dataset;
  std::vector<fs::path> rig_folders;
  fs::path sensors;      // the folder with the rover's files; empty: none
  fs::path default_rig;  // empty: none
};

// That rocks are surveyed in: the one that maps of the place are drawn in; Katwijk's where no fix
// tells the place.
UtmZone ZoneOf(const std::vector<GnssFix>& fixes) {
  if (fixes.empty()) return {};
  const auto good = std::ranges::find(fixes, std::string_view(kRtkFixed), &GnssFix::status);
  const GnssFix& fix = good != fixes.end() ? *good : fixes.front();
  const Geodetic position{fix.latitude_deg, fix.longitude_deg, fix.altitude_m};
  return HasUtmZone(position) ? UtmZoneOf(position) : UtmZone{};
}

// Fixes and surveyed rocks are for judging a result: it can be made without them.
void ReadSurvey(const KatwijkPart& part, Dataset& dataset) {
  auto& remarks = dataset.health.remarks;
  const auto try_to = [&](const auto& read) {
    try {
      read();
    } catch (const DataError& error) {
      remarks.push_back(fmt::format("{}; the result is not compared with it", error.what()));
    }
  };
  try_to([&] {
    if (auto reading = ReadGnss(part.folder)) {
      dataset.fixes = std::move(reading->fixes);
      remarks.insert(remarks.end(), reading->remarks.begin(), reading->remarks.end());
    }
  });
  try_to([&] { dataset.surveyed_landmarks = ReadRockSurvey(part, ZoneOf(dataset.fixes)); });
}

Opened OpenKatwijk(const DatasetRequest& request, const fs::path& folder) {
  const KatwijkPart part = SelectKatwijkPart(folder, request.traverse, request.part);
  const fs::path above = part.folder.parent_path();
  Dataset dataset = ReadKatwijkFrames(part);
  ReadSurvey(part, dataset);
  return {std::move(dataset),
          {folder, part.folder, above, above.parent_path()},
          part.folder,
          request.default_loccam_rig};
}

Opened OpenStereo(const DatasetRequest& request, const fs::path& folder) {
  if (request.traverse || request.part) {
    throw UsageError(
        fmt::format("{}: --traverse and --part choose a Katwijk part, found a stereo "
                    "folder",
                    folder.string()));
  }
  return {ReadStereoFolder(folder), {folder}, {}, {}};
}

PooledRig ReadRig(const DatasetRequest& request, const Opened& opened) {
  fs::path path = FindRigFile(request, opened.rig_folders);
  if (path.empty()) path = opened.default_rig;
  if (path.empty()) {
    throw DataError(fmt::format("{}: expected calib.yaml or rig.yaml, found neither",
                                opened.rig_folders.front().string()));
  }
  PooledRig rig = ReadPooledRigFile(path);
  spdlog::info("rig: {}, baseline {:.6f} m", path.string(), rig.rig.Baseline());
  return rig;
}

void KeepFrames(const std::pair<int, int>& range, std::vector<StereoFrame>& frames) {
  const auto [first, end] = range;
  if (first < 0 || first >= end || end > std::ssize(frames)) {
    throw UsageError(
        fmt::format("--frames {}:{}: expected 0 <= FIRST < END <= {}, the number of "
                    "pairs found",
                    first, end, frames.size()));
  }
  frames = std::vector<StereoFrame>(frames.begin() + first, frames.begin() + end);
}

void KeepLoneImagesBetweenFrames(Dataset& dataset) {
  std::erase_if(dataset.lone_images, [&](const LoneImage& image) {
    return image.stamp_ns < dataset.frames.front().stamp_ns ||
           image.stamp_ns > dataset.frames.back().stamp_ns;
  });
}

// Of the frames that are kept.
void ReadSensors(const fs::path& folder, Dataset& dataset) {
  if (folder.empty()) {
    dataset.wheels.problem = dataset.inertial.problem =
        "a stereo folder holds neither wheels nor an inertial unit; a Katwijk part does";
    return;
  }
  auto inclinometer = ReadInclinometer(folder / "imu.txt", dataset.frames);
  auto sensors = ReadRoverSensors(folder, dataset.frames);
  if (sensors.inclinometer_problem.empty()) {
    dataset.inclinometer = std::move(inclinometer.samples);
  } else if (!inclinometer.samples.empty()) {
    sensors.remarks.push_back(sensors.inclinometer_problem +
                              " The inclinometer is not used: the ground or the camera tells up");
  }
  dataset.wheels = std::move(sensors.wheels);
  dataset.inertial = std::move(sensors.inertial);
  auto& remarks = dataset.health.remarks;
  for (const auto& more : {inclinometer.remarks, sensors.remarks}) {
    remarks.insert(remarks.end(), more.begin(), more.end());
  }
}

void LogHealth(const Dataset& dataset) {
  const DatasetHealth& health = dataset.health;
  spdlog::info("{} pairs from {} images", dataset.frames.size(), health.images_read);
  if (!health.lone_images.empty()) {
    spdlog::warn("{} images without a partner left out, the first {}", health.lone_images.size(),
                 health.lone_images.front());
  }
  if (!health.unreadable_images.empty()) {
    spdlog::warn("{} images cannot be read, the first {}: their frames show nothing",
                 health.unreadable_images.size(), health.unreadable_images.front());
  }
  for (const auto& remark : health.remarks) spdlog::warn("{}", remark);
}

}  // namespace

std::vector<DatasetRequest> PartsOf(const DatasetRequest& request) {
  const fs::path folder = AbsoluteFolder(request.folder);
  if (FindFormat(request, folder) != DatasetFormat::kKatwijk) return {request};
  std::vector<DatasetRequest> parts;
  for (const KatwijkPart& part : KatwijkPartsThatFit(folder, request.traverse, request.part)) {
    parts.push_back(request);
    parts.back().traverse = part.traverse;
    parts.back().part = part.part;
  }
  return parts;
}

Dataset OpenDataset(const DatasetRequest& request) {
  const fs::path folder = AbsoluteFolder(request.folder);
  Opened opened = FindFormat(request, folder) == DatasetFormat::kKatwijk
                      ? OpenKatwijk(request, folder)
                      : OpenStereo(request, folder);
  Dataset& dataset = opened.dataset;
  PooledRig rig = ReadRig(request, opened);
  dataset.rig = std::move(rig.rig);
  dataset.rig_pool = std::move(rig.pool);
  LeaveOutRepeats(dataset);
  DecideSampleBits(dataset.rig, dataset.frames);  // of the part, whichever frames are asked for
  if (request.frames) KeepFrames(*request.frames, dataset.frames);
  KeepLoneImagesBetweenFrames(dataset);
  ReadSensors(opened.sensors, dataset);
  LogHealth(dataset);
  CheckSizes(dataset);
  return dataset;
}

}  // namespace rigmap

#include "dataset/internal/katwijk.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <string>
#include <string_view>
#include <tuple>

#include "core/error.h"
#include "dataset/internal/image_file.h"
#include "imaging/image.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kImagePrefix = "LocCam_";

// "Part12" with prefix "Part" -> 12.
std::optional<int> NumberAfter(std::string_view prefix, const std::string& name) {
  if (!name.starts_with(prefix)) return std::nullopt;
  int number = 0;
  const char* end = name.data() + name.size();
  const auto result = std::from_chars(name.data() + prefix.size(), end, number);
  if (result.ec != std::errc() || result.ptr != end || number < 0) return std::nullopt;
  return number;
}

std::optional<int> TraverseNumber(const fs::path& folder) {
  return NumberAfter("Traverse", folder.filename().string());
}

std::optional<int> PartNumber(const fs::path& folder) {
  return NumberAfter("Part", folder.filename().string());
}

bool HasLocCam(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_directory(folder / "LocCam", ignored);
}

std::vector<fs::path> ListFolders(const fs::path& folder) {
  std::error_code code;
  std::vector<fs::path> folders;
  auto entry = fs::directory_iterator(folder, code);
  for (; !code && entry != fs::directory_iterator(); entry.increment(code)) {
    std::error_code ignored;
    if (entry->is_directory(ignored)) folders.push_back(entry->path());
  }
  if (code) throw DataError(fmt::format("{}: cannot list: {}", folder.string(), code.message()));
  return folders;
}

void AddPartsOfTraverse(const fs::path& traverse_folder, std::vector<KatwijkPart>& parts) {
  for (const auto& folder : ListFolders(traverse_folder)) {
    const auto part = PartNumber(folder);
    if (part && HasLocCam(folder)) parts.push_back({folder, TraverseNumber(traverse_folder), part});
  }
}

std::string Describe(const std::vector<KatwijkPart>& parts) {
  std::vector<std::string> names;
  for (const auto& part : parts) {
    const auto traverse = part.traverse ? fmt::format("traverse {} ", *part.traverse) : "";
    names.push_back(part.part ? fmt::format("{}part {}", traverse, *part.part)
                              : part.folder.filename().string());
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string DescribeRequest(std::optional<int> traverse, std::optional<int> part) {
  return fmt::format("{}{}", traverse ? fmt::format(" --traverse {}", *traverse) : "",
                     part ? fmt::format(" --part {}", *part) : "");
}

// All images of one stamp, per eye, sorted by name.
using EyeImages = std::array<std::vector<fs::path>, 2>;

struct LocCamName {
  StampNs stamp_ns = 0;
  Eye eye = Eye::kLeft;
};

std::optional<LocCamName> ParseLocCamName(const fs::path& path) {
  const std::string stem = path.stem().string();
  const std::string_view rest = std::string_view(stem).substr(kImagePrefix.size());
  const auto mark = rest.rfind('_');
  const auto eye = mark == std::string_view::npos ? "" : rest.substr(mark + 1);
  if (eye != "0" && eye != "1") return std::nullopt;
  try {
    return LocCamName{ParseKatwijkStamp(rest.substr(0, mark)),
                      eye == "0" ? Eye::kLeft : Eye::kRight};
  } catch (const DataError&) {
    return std::nullopt;
  }
}

std::map<StampNs, EyeImages> GroupByStamp(const fs::path& folder, DatasetHealth& health) {
  std::map<StampNs, EyeImages> groups;
  for (const auto& path : ListImages(folder)) {
    if (!path.filename().string().starts_with(kImagePrefix)) continue;
    ++health.images_read;
    if (const auto name = ParseLocCamName(path)) {
      groups[name->stamp_ns][static_cast<std::size_t>(name->eye)].push_back(path);
    } else {
      health.lone_images.push_back(path.string());
      health.remarks.push_back(fmt::format(
          "{}: expected a name LocCam_YYYY_MM_DD_HH_MM_SS_mmm_{{0,1}}, left out", path.string()));
    }
  }
  return groups;
}

// The name without its eye: equal for the two images of a pair.
std::string PairName(const fs::path& path) {
  const std::string stem = path.stem().string();
  return stem.substr(0, stem.size() - 1) + path.extension().string();
}

// Of images with equal stamps, two with equal names if there are such, else the first of each eye.
StereoFrame ChoosePair(StampNs stamp_ns, const EyeImages& images, DatasetHealth& health) {
  StereoFrame frame{stamp_ns, images[0].front().string(), images[1].front().string()};
  for (const auto& left : images[0]) {
    const auto right = std::find_if(images[1].begin(), images[1].end(), [&](const auto& path) {
      return PairName(path) == PairName(left);
    });
    if (right == images[1].end()) continue;
    frame = {stamp_ns, left.string(), right->string()};
    break;
  }
  for (const Eye eye : kEyes) {
    for (const auto& path : images[static_cast<std::size_t>(eye)]) {
      if (path.string() == frame.PathOf(eye)) continue;
      health.remarks.push_back(
          fmt::format("{}: same stamp and eye as {}, left out", path.string(), frame.PathOf(eye)));
    }
  }
  return frame;
}

// The pair of one stamp, of whole images where there are such; what is missing or damaged goes to
// the health of `dataset`, a lone image also to its lone ones.
std::optional<StereoFrame> PairEyes(StampNs stamp_ns, const EyeImages& images, Dataset& dataset) {
  DatasetHealth& health = dataset.health;
  EyeImages whole, chosen;
  for (std::size_t eye = 0; eye < images.size(); ++eye) {
    for (const auto& path : images[eye]) {
      if (IsWholeImage(path)) {
        whole[eye].push_back(path);
      } else {
        health.unreadable_images.push_back(path.string());
      }
    }
  }
  for (std::size_t eye = 0; eye < images.size(); ++eye) {
    chosen[eye] = whole[eye].empty() ? images[eye] : whole[eye];
  }
  if (!chosen[0].empty() && !chosen[1].empty()) return ChoosePair(stamp_ns, chosen, health);
  for (const Eye eye : kEyes) {
    const auto& lone = whole[static_cast<std::size_t>(eye)];
    if (!lone.empty()) dataset.lone_images.push_back({stamp_ns, eye, lone.front().string()});
    for (const auto& path : lone) health.lone_images.push_back(path.string());
  }
  return std::nullopt;
}

std::vector<KatwijkPart> FittingKatwijkParts(const fs::path& folder, std::optional<int> traverse,
                                             std::optional<int> part) {
  const auto parts = FindKatwijkParts(folder);
  if (parts.empty()) {
    throw DataError(
        fmt::format("{}: expected Traverse<T>/Part<P>/LocCam, Part<P>/LocCam or "
                    "LocCam, found none of them",
                    folder.string()));
  }
  const auto fits = [](std::optional<int> wanted, std::optional<int> found) {
    return !wanted || !found || *wanted == *found;
  };
  std::vector<KatwijkPart> fitting;
  std::copy_if(parts.begin(), parts.end(), std::back_inserter(fitting),
               [&](const KatwijkPart& candidate) {
                 return fits(traverse, candidate.traverse) && fits(part, candidate.part);
               });
  if (!fitting.empty()) return fitting;
  throw UsageError(fmt::format("{}:{} fits no part, found {}", folder.string(),
                               DescribeRequest(traverse, part), Describe(parts)));
}

}  // namespace

std::vector<KatwijkPart> FindKatwijkParts(const fs::path& folder) {
  if (HasLocCam(folder)) {
    return {{folder, TraverseNumber(folder.parent_path()), PartNumber(folder)}};
  }
  std::vector<KatwijkPart> parts;
  AddPartsOfTraverse(folder, parts);
  for (const auto& inner : ListFolders(folder)) {
    if (TraverseNumber(inner)) AddPartsOfTraverse(inner, parts);
  }
  std::sort(parts.begin(), parts.end(), [](const KatwijkPart& a, const KatwijkPart& b) {
    return std::tie(a.traverse, a.part, a.folder) < std::tie(b.traverse, b.part, b.folder);
  });
  return parts;
}

std::vector<KatwijkPart> KatwijkPartsThatFit(const fs::path& folder, std::optional<int> traverse,
                                             std::optional<int> part) {
  auto fitting = FittingKatwijkParts(folder, traverse, part);
  const auto other = std::ranges::find_if(fitting, [&](const KatwijkPart& found) {
    return found.traverse != fitting.front().traverse;
  });
  if (other == fitting.end()) return fitting;
  throw UsageError(fmt::format("{}: expected --traverse to choose one traverse, found {}",
                               folder.string(), Describe(fitting)));
}

KatwijkPart SelectKatwijkPart(const fs::path& folder, std::optional<int> traverse,
                              std::optional<int> part) {
  const auto fitting = FittingKatwijkParts(folder, traverse, part);
  if (fitting.size() == 1) return fitting.front();
  throw UsageError(fmt::format("{}: expected --traverse and --part to choose one part, found {}",
                               folder.string(), Describe(fitting)));
}

Dataset ReadKatwijkFrames(const KatwijkPart& part) {
  Dataset dataset;
  dataset.format = DatasetFormat::kKatwijk;
  DatasetHealth& health = dataset.health;
  const fs::path folder = part.folder / "LocCam";
  for (const auto& [stamp_ns, images] : GroupByStamp(folder, health)) {
    if (auto frame = PairEyes(stamp_ns, images, dataset)) dataset.frames.push_back(*frame);
  }
  if (dataset.frames.empty()) {
    throw DataError(
        fmt::format("{}: expected pairs LocCam_<stamp>_0 and LocCam_<stamp>_1, found "
                    "none among {} images, {} of them lone and {} unreadable",
                    folder.string(), health.images_read, health.lone_images.size(),
                    health.unreadable_images.size()));
  }
  return dataset;
}

}  // namespace rigmap

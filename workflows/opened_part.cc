#include "workflows/opened_part.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "dataset/rig_file.h"
#include "workflows/rig_prior.h"

namespace rigmap {
namespace {

namespace fs = std::filesystem;

std::string StatusOf(const fs::path& root) {
  const fs::path path = root / "summary.json";
  if (!fs::exists(path)) return "";
  const auto summary = nlohmann::json::parse(ReadTextFile(path), nullptr, false);
  const bool has_status =
      summary.is_object() && summary.contains("status") && summary["status"].is_string();
  return has_status ? summary["status"].get<std::string>() : "";
}

OpenedPart Open(const PartFolder& folder) {
  const fs::path& root = folder.root;
  const fs::path tum = root / "trajectory.tum";
  OpenedPart part{root,
                  folder.name,
                  ReadJoinableInput(root),
                  ReadJoinableFeatures(root),
                  ReadJoinableOdometry(root),
                  ReadJoinableDepths(root),
                  StatusOf(root),
                  fs::exists(tum) ? ReadTum(tum) : std::vector<TumPose>()};
  Dataset& dataset = part.input.dataset;
  part.input.rig_file.rig.source = dataset.rig.source;
  // The whole has a prior of its own.
  if (const auto prior = WithoutPart(part.input.rig_file, part.input.content.images)) {
    std::erase(dataset.health.remarks, prior->remark);
  }
  return part;
}

// stages/ may have been deleted.
void RequireFeatures(const OpenedPart& part) {
  for (const FrameFile& file : part.features.files) {
    if (fs::exists(part.root / file.name)) continue;
    throw DataError(
        fmt::format("{}: expected the keypoints of its frames ({}), found none; run the part again",
                    part.root.string(), file.name));
  }
}

void RequireAlike(const OpenedPart& first, const OpenedPart& other) {
  const StereoRig rig = RigBeforePool(first.input.rig_file),
                  found = RigBeforePool(other.input.rig_file);
  if (DescribeRig(rig) != DescribeRig(found)) {
    throw DataError(fmt::format("{}: expected the rig of {} ({}), found another ({})",
                                other.root.string(), first.root.string(), rig.source,
                                found.source));
  }
  if (first.features.how != other.features.how) {
    throw DataError(fmt::format(
        "{}: expected keypoints found with the same options as those of {}, found others",
        other.root.string(), first.root.string()));
  }
}

std::string DescribeFile(const PooledRig& file) {
  return WritePooledRigFile({WithoutMasks(file.rig), file.pool});
}

}  // namespace

std::vector<OpenedPart> OpenAlike(const std::vector<PartFolder>& folders) {
  std::vector<OpenedPart> parts;
  for (const PartFolder& folder : folders) parts.push_back(Open(folder));
  for (const OpenedPart& part : parts) {
    RequireFeatures(part);
    RequireAlike(parts.front(), part);
  }
  return parts;
}

PooledRig RigFileOfAll(const std::vector<OpenedPart>& parts) {
  const PooledRig& first = parts.front().input.rig_file;
  const std::string described = DescribeFile(first);
  const bool same = std::ranges::all_of(parts, [&](const OpenedPart& part) {
    return DescribeFile(part.input.rig_file) == described;
  });
  return same ? first : PooledRig{RigBeforePool(first), {}};
}

}  // namespace rigmap

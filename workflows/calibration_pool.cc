#include "workflows/calibration_pool.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <tuple>

#include "core/error.h"
#include "core/file.h"
#include "gates/accuracy.h"
#include "workflows/part_options.h"
#include "workflows/rig_prior.h"

namespace rigmap {
namespace {

const StereoRig& StartOf(const PooledRig& given) {
  return given.pool ? given.pool->start : given.rig;
}

// Rotations are written to rounding.
constexpr double kRounding = 1e-9;

// In what no correction changes.
bool IsSameKind(const Camera& a, const Camera& b) {
  return a.width == b.width && a.height == b.height && a.k3 == b.k3;
}

bool DoStateTheSame(const RigSigmas& a, const RigSigmas& b) {
  const auto all = [](const RigSigmas& s) {
    return std::tie(s.rotation_deg, s.focal_pct, s.aspect_pct, s.principal_point_px,
                    s.distortion_px, s.board_px);
  };
  return all(a) == all(b);
}

bool IsSameRig(const StereoRig& a, const StereoRig& b) {
  const auto& known = a.calibration_covariance;
  return IsSameKind(a.left.camera, b.left.camera) && IsSameKind(a.right.camera, b.right.camera) &&
         CorrectionBetween(a, b).cwiseAbs().maxCoeff() < kRounding &&
         a.right_from_left.translation.isApprox(b.right_from_left.translation, kRounding) &&
         DoStateTheSame(a.stated_sigmas, b.stated_sigmas) &&
         known.has_value() == b.calibration_covariance.has_value() &&
         (!known || known->isApprox(*b.calibration_covariance, kRounding));
}

// Beside results that are only not as good as asked for: to make them better is what a pool is for.
std::string ContradictionIn(const std::filesystem::path& out) {
  const std::filesystem::path path = out / "summary.json";
  if (!std::filesystem::exists(path)) return "";
  try {
    const auto summary = nlohmann::json::parse(ReadTextFile(path));
    for (const auto& cause : summary.at("verdict").at("causes")) {
      const std::vector<std::string> gates = cause.at("gates");
      if (!std::ranges::all_of(gates, IsAboutAccuracy)) return cause.at("brief");
    }
    return "";
  } catch (const nlohmann::json::exception&) {
    throw DataError(fmt::format("{}: expected what rigmap part writes there, found other content",
                                path.string()));
  }
}

std::vector<GivenPart> ReadParts(const std::vector<std::filesystem::path>& outs) {
  std::vector<GivenPart> parts;
  for (const std::filesystem::path& out : outs) {
    auto part = ReadCalibration(out);
    if (!part) {
      spdlog::warn("{}: tells nothing of its rig: too short a way, or too few frames",
                   out.string());
      continue;
    }
    parts.push_back({out.string(), std::move(*part), ContradictionIn(out)});
  }
  if (parts.empty()) throw DataError("expected a part that tells something of its rig, found none");
  return parts;
}

// One rig at the root of all, and no image twice.
void RequireCommensurable(const std::vector<GivenPart>& parts) {
  for (const GivenPart& part : parts) {
    const GivenPart& first = parts.front();
    if (!IsSameRig(StartOf(part.calibration.given), StartOf(first.calibration.given))) {
      throw DataError(
          fmt::format("{}: expected a part made with the rig file of {} or one pooled "
                      "from it, found another",
                      part.name, first.name));
    }
    for (const GivenPart* other = &first; other != &part; ++other) {
      const int shared = SharedFrames(other->calibration.frames, part.calibration.frames);
      if (shared == 0) continue;
      throw DataError(
          fmt::format("{}: expected frames that no other part holds, found {} of {}: "
                      "they would count twice",
                      part.name, shared, other->name));
    }
  }
}

// Whether all parts began with the whole of one pool, which contains none of them.
bool AddToOnePool(const std::vector<GivenPart>& parts) {
  const PooledRig& first = parts.front().calibration.given;
  return first.pool && std::ranges::all_of(parts, [&](const GivenPart& part) {
           const PooledRig& given = part.calibration.given;
           return given.pool && IsSameRig(given.rig, first.rig) &&
                  given.pool->parts.size() == first.pool->parts.size() &&
                  !WithoutPart(given, part.calibration.frames);
         });
}

// What parts of earlier pools told is lost where not all that is given adds to one of them.
void SayWhatIsLost(const std::vector<GivenPart>& parts) {
  std::set<std::vector<std::string>> lost;
  for (const GivenPart& part : parts) {
    if (!part.calibration.given.pool) continue;
    for (const RigWithoutPart& earlier : part.calibration.given.pool->parts) {
      if (std::ranges::none_of(parts, [&](const GivenPart& given) {
            return SharedFrames(earlier.frames, given.calibration.frames) > 0;
          })) {
        lost.insert(earlier.frames);
      }
    }
  }
  if (lost.empty()) return;
  spdlog::warn(
      "the pool begins anew from the first rig file: what {} earlier parts told is not in "
      "it; name their folders as well",
      lost.size());
}

std::string TextOf(const AdjustmentOptions& options) {
  PartOptions text;
  text.adjustment = options;
  return WritePartOptions(text);
}

}  // namespace

CalibrationPool ReadPool(const std::vector<std::filesystem::path>& outs) {
  CalibrationPool pool;
  pool.parts = ReadParts(outs);
  RequireCommensurable(pool.parts);
  const PooledRig& first = pool.parts.front().calibration.given;
  pool.start = StartOf(first);
  pool.base = RigBeforePool(first);  // with the masks, antenna and the like of the file itself
  if (AddToOnePool(pool.parts)) {
    pool.base = first.rig;
    pool.earlier = first.pool->parts;
  } else {
    SayWhatIsLost(pool.parts);
  }
  if (pool.parts.size() + pool.earlier.size() == 1) {
    spdlog::warn(
        "{} alone tells of the rig: its file is for other parts, and helps this one nothing",
        pool.parts.front().name);
  }
  return pool;
}

AdjustmentOptions AdjustmentOptionsOf(const std::vector<std::filesystem::path>& outs) {
  std::optional<AdjustmentOptions> options;
  for (const std::filesystem::path& out : outs) {
    const auto config = out / "config.yaml";
    if (!std::filesystem::exists(config)) continue;  // a run is at work there, or was killed
    const AdjustmentOptions found = LoadPartOptions(config, {}).adjustment;
    if (!options) options = found;
    if (TextOf(found) == TextOf(*options)) continue;
    throw DataError(
        fmt::format("{}: expected the options of adjustment that {} was made with, found others",
                    config.string(), outs.front().string()));
  }
  return options.value_or(AdjustmentOptions{});
}

}  // namespace rigmap

#include "simulation/terrain.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "simulation/internal/noise.h"

namespace rigmap {
namespace {

constexpr double kBucket_m = 1.0;

double SmoothStep(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

// How much of a structure of this length a mesh with such cells keeps.
double Kept(double length_m, double cell_m) {
  return cell_m <= 0.0 ? 1.0 : SmoothStep(2.0 * cell_m, 4.0 * cell_m, length_m);
}

// A shoe's print: a trough with a rim, longer than wide.
struct Footprint {
  Eigen::Vector2d centre, along;
  double depth_m;

  static constexpr double kReach_m = 0.3;

  double Height(const Eigen::Vector2d& position, double cell_m) const {
    const Eigen::Vector2d offset = position - centre;
    const double forward = offset.dot(along) / 0.15,
                 aside = (along.x() * offset.y() - along.y() * offset.x()) / 0.065;
    const double distance2 = forward * forward + aside * aside;
    if (distance2 > 4.0) return 0.0;
    const double trough = -std::exp(-distance2 * distance2 * 0.7);
    const double rim =
        0.35 * std::exp(-6.0 * (std::sqrt(distance2) - 1.35) * (std::sqrt(distance2) - 1.35));
    return Kept(0.15, cell_m) * depth_m * (trough + rim);
  }
};

// A pair of ruts with the print of the tyres' lugs, along an arc.
struct TyreTrack {
  Eigen::Vector2d centre;  // of the arc
  double radius_m, first_rad, length_m;

  static constexpr double kGauge_m = 1.5, kWidth_m = 0.2, kDepth_m = 0.018, kLug_m = 0.11;
  static constexpr double kReach_m = 0.5 * kGauge_m + 0.4;

  double Height(const Eigen::Vector2d& position, double cell_m) const {
    const Eigen::Vector2d offset = position - centre;
    const double along_m = radius_m * std::remainder(std::atan2(offset.y(), offset.x()) - first_rad,
                                                     2.0 * std::numbers::pi);
    if (along_m < 0.0 || along_m > length_m) return 0.0;
    const double aside_m = std::abs(offset.norm() - radius_m) - 0.5 * kGauge_m;
    const double within = aside_m / (0.5 * kWidth_m);
    if (std::abs(within) > 2.0) return 0.0;
    const double ends = SmoothStep(0.0, 1.0, along_m) * SmoothStep(0.0, 1.0, length_m - along_m);
    const double flat = std::exp(-within * within * within * within * within * within);
    const double shape =
        -flat + 0.4 * std::exp(-14.0 * (std::abs(within) - 1.3) * (std::abs(within) - 1.3));
    const double lug = flat * 0.35 *
                       std::tanh(3.0 * std::sin(2.0 * std::numbers::pi *
                                                (along_m + 0.5 * std::abs(aside_m)) / kLug_m));
    return ends * kDepth_m * (Kept(kWidth_m, cell_m) * shape + Kept(0.5 * kLug_m, cell_m) * lug);
  }
};

// Things with a centre line, found by place.
template <class Thing>
class Buckets {
 public:
  void Add(const Thing& thing) { things_.push_back(thing); }
  // Notes the last thing added in all buckets within its reach of `position`.
  void Cover(const Eigen::Vector2d& position) {
    const auto low = Index(position.array() - Thing::kReach_m),
               high = Index(position.array() + Thing::kReach_m);
    const auto last = static_cast<std::uint32_t>(things_.size() - 1);
    for (int y = low.y(); y <= high.y(); ++y) {
      for (int x = low.x(); x <= high.x(); ++x) {
        if (!IsInside(x, y)) continue;
        auto& bucket = buckets_[y * kSide + x];
        if (bucket.empty() || bucket.back() != last) bucket.push_back(last);
      }
    }
  }
  double Height(const Eigen::Vector2d& position, double cell_m) const {
    const auto index = Index(position);
    if (!IsInside(index.x(), index.y())) return 0.0;
    double sum = 0.0;
    for (const std::uint32_t i : buckets_[index.y() * kSide + index.x()]) {
      sum += things_[i].Height(position, cell_m);
    }
    return sum;
  }

 private:
  static constexpr int kSide = static_cast<int>(2.0 * Terrain::kTrodden_m / kBucket_m);

  static Eigen::Vector2i Index(const Eigen::Array2d& position) {
    return ((position + Terrain::kTrodden_m) / kBucket_m).floor().cast<int>();
  }
  static bool IsInside(int x, int y) { return x >= 0 && y >= 0 && x < kSide && y < kSide; }

  std::vector<Thing> things_;
  std::vector<std::vector<std::uint32_t>> buckets_ =
      std::vector<std::vector<std::uint32_t>>(static_cast<std::size_t>(kSide) * kSide);
};

constexpr double kTroddenArea_m2 = 4.0 * Terrain::kTrodden_m * Terrain::kTrodden_m;

Buckets<Footprint> WalkTrails(const TerrainOptions& options) {
  constexpr int kSteps = 17;
  constexpr double kStride_m = 0.7, kHalfGait_m = 0.1;
  Buckets<Footprint> footprints;
  HashSequence random(options.seed, 11);
  const int trails = static_cast<int>(options.footprint_trails * kTroddenArea_m2 / 100.0);
  for (int i = 0; i < trails; ++i) {
    Eigen::Vector2d position(random.Between(-Terrain::kTrodden_m, Terrain::kTrodden_m),
                             random.Between(-Terrain::kTrodden_m, Terrain::kTrodden_m));
    double heading = random.Between(0.0, 2.0 * std::numbers::pi);
    const double depth_m = random.Between(0.012, 0.03);
    for (int step = 0; step < kSteps; ++step) {
      const Eigen::Vector2d along(std::cos(heading), std::sin(heading)),
          left(-along.y(), along.x());
      footprints.Add({position + (step % 2 ? kHalfGait_m : -kHalfGait_m) * left, along,
                      depth_m * random.Between(0.7, 1.2)});
      footprints.Cover(position);
      position += kStride_m * random.Between(0.9, 1.1) * along;
      heading += random.Between(-0.15, 0.15);
    }
  }
  return footprints;
}

Buckets<TyreTrack> DriveTracks(const TerrainOptions& options) {
  constexpr double kLength_m = 25.0;
  Buckets<TyreTrack> tracks;
  HashSequence random(options.seed, 12);
  const int count = static_cast<int>(options.tyre_tracks * kTroddenArea_m2 / 100.0);
  for (int i = 0; i < count; ++i) {
    const TyreTrack track{{random.Between(-1.2, 1.2) * Terrain::kTrodden_m,
                           random.Between(-1.2, 1.2) * Terrain::kTrodden_m},
                          random.Between(15.0, 60.0),
                          random.Between(-std::numbers::pi, std::numbers::pi),
                          kLength_m};
    tracks.Add(track);
    for (double along_m = 0.0; along_m <= kLength_m; along_m += 0.5 * kBucket_m) {
      const double angle = track.first_rad + along_m / track.radius_m;
      tracks.Cover(track.centre +
                   track.radius_m * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    }
  }
  return tracks;
}

// Octaves of noise between two lengths, each half as long and `fall` times as high as the last.
double Octaves(const Eigen::Vector2d& position, double longest_m, double shortest_m, double fall,
               double cell_m, std::uint32_t seed) {
  double sum = 0.0, height = 1.0;
  for (double length_m = longest_m; length_m >= shortest_m; length_m *= 0.5, height *= fall) {
    const double kept = Kept(length_m, cell_m);
    if (kept == 0.0) break;
    sum += kept * height *
           GradientNoise(position.x() / length_m, position.y() / length_m, seed++).value;
  }
  return sum;
}

}  // namespace

struct Terrain::Impl {
  TerrainOptions options;
  std::uint32_t seed;
  Buckets<Footprint> footprints;
  Buckets<TyreTrack> tracks;

  // Ridges with a steep lee side whose crests wander, in patches.
  double Ripples(const Eigen::Vector2d& position, double cell_m) const {
    constexpr double kLength_m = 0.085;
    const double kept = Kept(kLength_m, cell_m);
    if (kept == 0.0) return 0.0;
    const double wander =
        0.11 * GradientNoise(position.x() / 0.55, position.y() / 0.55, seed + 41).value +
        0.05 * GradientNoise(position.x() / 0.19, position.y() / 0.19, seed + 42).value;
    const double patch =
        0.55 + 0.45 * GradientNoise(position.x() / 1.3, position.y() / 1.3, seed + 43).value * 1.8;
    const double phase =
        2.0 * std::numbers::pi * (0.8 * position.x() + 0.6 * position.y() + wander) / kLength_m;
    return kept * std::clamp(patch, 0.0, 1.2) * (std::sin(phase + 0.45 * std::sin(phase)));
  }

  // What closes the horizon: nothing within the hinterland.
  double Shores(const Eigen::Vector2d& position) const {
    const double east_m = position.x() - options.hinterland_m,
                 west_m = -position.x() - options.hinterland_m;
    double height_m = 0.0;
    if (east_m > 0.0) {
      const double rise = SmoothStep(0.0, 45.0, east_m);
      height_m += rise * (7.0 + 5.0 * Octaves(position, 60.0, 7.0, 0.5, 0.0, seed + 70));
    }
    if (west_m > 0.0) height_m -= 3.0 * SmoothStep(0.0, 60.0, west_m);
    return height_m;
  }
};

Terrain::Terrain(const TerrainOptions& options)
    : impl_(new Impl{options, HashSequence(options.seed, 10).Next(), WalkTrails(options),
                     DriveTracks(options)}) {}
Terrain::~Terrain() = default;
Terrain::Terrain(Terrain&&) noexcept = default;

double Terrain::Height(double east_m, double north_m, double cell_m) const {
  const auto& [options, seed, footprints, tracks] = *impl_;
  const Eigen::Vector2d position(east_m, north_m);
  return options.undulation_m * Octaves(position, 7.0, 0.8, 0.45, cell_m, seed) +
         options.roughness_m * Octaves(position, 0.6, 0.035, 0.55, cell_m, seed + 20) +
         options.ripple_m * impl_->Ripples(position, cell_m) + footprints.Height(position, cell_m) +
         tracks.Height(position, cell_m) + impl_->Shores(position);
}

}  // namespace rigmap

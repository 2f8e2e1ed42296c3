#include "simulation/internal/rock_files.h"

#include <fmt/format.h>

#include <ostream>
#include <string>

#include "core/error.h"
#include "core/file.h"
#include "georeference/utm_grid.h"
#include "simulation/internal/noise.h"

namespace rigmap {
namespace {

constexpr std::uint32_t kSurveyPurpose = 61;

// Twelve uniform numbers added up: nearly normal, never beyond six sigma.
double Normal(HashSequence& random, double sigma) {
  double sum = -6.0;
  for (int i = 0; i < 12; ++i) sum += random.Unit();
  return sigma * sum;
}

std::string SurveyRow(const Boulder& boulder, const LocalFrame& local, HashSequence& random) {
  const UtmPoint utm = ToUtm(kUtm31, local.ToGeodetic(boulder.centre));
  const double easting_m = utm.easting_m + Normal(random, kRockSurveySigma_m);
  const double northing_m = utm.northing_m + Normal(random, kRockSurveySigma_m);
  return fmt::format("{:.3f} {:.3f}\n", easting_m, northing_m);
}

}  // namespace

void WriteRockFiles(const std::filesystem::path& root, int traverse,
                    std::span<const Boulder> boulders, const LocalFrame& local,
                    std::uint64_t seed) {
  if (traverse < 1 || traverse > 3) {
    throw UsageError(fmt::format("rock files: expected traverse 1, 2 or 3, found {}", traverse));
  }
  const bool third = traverse == 3;
  const auto folder = root / "Rock Data" /
                      (third ? "Rock Positions Traverse 3" : "Rock Positions Traverse 1 and 2");
  HashSequence random(seed, kSurveyPurpose);
  for (const std::string size : {"small", "medium", "large"}) {
    std::string rows;
    for (const Boulder& boulder : boulders) {
      if (boulder.size == size) rows += SurveyRow(boulder, local, random);
    }
    const auto name = fmt::format("{}-rocks-traverse{}.txt", size, third ? "3" : "12");
    WriteFileAtomically(folder / name, [&](std::ostream& stream) { stream << rows; });
  }
}

}  // namespace rigmap

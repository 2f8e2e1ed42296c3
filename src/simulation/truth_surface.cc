#include "simulation/internal/truth_surface.h"

#include <fmt/format.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <ostream>
#include <string>
#include <vector>

#include "core/file.h"

namespace rigmap {
namespace {

static_assert(std::endian::native == std::endian::little, "PLY rows are copied as they lie");

constexpr int kBatchesAtOnce = 128;

// Of the same length for every count: blanks at the end of a comment make up for missing digits.
std::string HeaderText(double sand_cell_m, std::uint64_t points) {
  const std::string digits = fmt::format("{}", points);
  constexpr std::size_t kMaxDigits = 20;
  return fmt::format(
      "ply\nformat binary_little_endian 1.0\n"
      "comment local ENU metres; kind 0 sand {:g} cm, 1 coarser sand, 2 rock, 3 debris{:{}}\n"
      "element vertex {}\nproperty float x\nproperty float y\nproperty float z\n"
      "property char nx\nproperty char ny\nproperty char nz\n"
      "property uchar visible\nproperty uchar kind\nend_header\n",
      100.0 * sand_cell_m, "", kMaxDigits - digits.size(), digits);
}

template <class Scalar>
void Append(std::string& bytes, Scalar value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

struct WrittenBatch {
  std::string bytes;
  TruthSurfaceSummary summary;
};

WrittenBatch WriteBatch(const std::vector<SurfaceSample>& samples,
                        const std::vector<bool>& visible) {
  WrittenBatch written;
  written.summary.points = samples.size();
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const SurfaceSample& sample = samples[i];
    for (int k = 0; k < 3; ++k) Append(written.bytes, static_cast<float>(sample.position(k)));
    for (int k = 0; k < 3; ++k) {
      Append(written.bytes, static_cast<std::int8_t>(std::lround(127.0 * sample.normal(k))));
    }
    Append(written.bytes, static_cast<std::uint8_t>(visible[i] ? 1 : 0));
    Append(written.bytes, static_cast<std::uint8_t>(sample.kind));
    if (visible[i]) ++written.summary.visible;
  }
  return written;
}

}  // namespace

TruthSurfaceSummary WriteTruthSurface(const std::filesystem::path& file,
                                      const SurfaceSampler& sampler,
                                      const SurfaceVisibility& visibility) {
  const double cell_m = sampler.world().options().sand_cell_m;
  TruthSurfaceSummary summary;
  WriteFileAtomically(file, [&](std::ostream& stream) {
    stream << HeaderText(cell_m, 0);
    for (int first = 0; first < sampler.batch_count(); first += kBatchesAtOnce) {
      std::vector<WrittenBatch> batches(
          static_cast<std::size_t>(std::min(kBatchesAtOnce, sampler.batch_count() - first)));
      tbb::parallel_for(std::size_t{0}, batches.size(), [&](std::size_t i) {
        const auto samples = sampler.Batch(first + static_cast<int>(i));
        batches[i] = WriteBatch(samples, visibility.AreVisible(samples));
      });
      for (const WrittenBatch& batch : batches) {
        stream.write(batch.bytes.data(), static_cast<std::streamsize>(batch.bytes.size()));
        summary.points += batch.summary.points;
        summary.visible += batch.summary.visible;
      }
    }
    stream.seekp(0);
    stream << HeaderText(cell_m, summary.points);
  });
  return summary;
}

}  // namespace rigmap

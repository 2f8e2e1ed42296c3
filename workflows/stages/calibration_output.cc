#include "workflows/stages/calibration_output.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "dataset/rig_file.h"

namespace rigmap {
namespace {

using Json = nlohmann::ordered_json;

template <class Matrix>
Json Numbers(const Matrix& matrix) {
  return std::vector<double>(matrix.data(), matrix.data() + matrix.size());
}

// Matrices are symmetric, so that the order of rows and columns does not matter.
template <class Matrix>
Matrix Read(const Json& numbers) {
  const auto values = numbers.get<std::vector<double>>();
  if (values.size() != static_cast<std::size_t>(Matrix::SizeAtCompileTime)) {
    throw DataError(fmt::format("expected {} numbers, found {}", int{Matrix::SizeAtCompileTime},
                                values.size()));
  }
  return Eigen::Map<const Matrix>(values.data());
}

Json WriteEquations(const CalibrationVector& score, const CalibrationMatrix& information,
                    double inflation) {
  return {{"score", Numbers((score / inflation).eval())},
          {"information", Numbers((information / inflation).eval())}};
}

CalibrationBlock ReadBlock(const Json& equations) {
  return {Read<CalibrationVector>(equations.at("score")),
          Read<CalibrationMatrix>(equations.at("information"))};
}

PartCalibration ReadPart(const Json& part, const std::filesystem::path& path) {
  PartCalibration read{ParsePooledRigFile(part.at("rig"), path),
                       part.at("frames"),
                       Read<CalibrationVector>(part.at("correction")),
                       {}};
  for (const Json& stretch : part.at("stretches")) {
    const CalibrationBlock block = ReadBlock(stretch);
    read.equations.score += block.score;
    read.equations.information += block.information;
    read.equations.blocks.push_back(block);
  }
  read.equations.score_covariance = read.equations.information;
  return read;
}

}  // namespace

void PublishCalibration(const Dataset& dataset, const DatasetContent& content,
                        const Adjustment& adjustment, Publication& publication) {
  std::vector<std::string> frames = content.images;
  std::erase(frames, "");
  Json part = {{"rig", WritePooledRigFile({WithoutMasks(dataset.rig), dataset.rig_pool})},
               {"frames", frames},
               {"correction", Numbers(adjustment.rig_correction)},
               {"stretches", Json::array()}};
  if (adjustment.calibration) {
    for (const CalibrationBlock& block : adjustment.calibration->blocks) {
      part["stretches"].push_back(
          WriteEquations(block.score, block.information, adjustment.calibration_inflation));
    }
  }
  publication.File("calibration.json",
                   [&](std::ostream& stream) { stream << part.dump() << "\n"; });
}

std::optional<PartCalibration> ReadCalibration(const std::filesystem::path& out) {
  const std::filesystem::path path = out / "calibration.json";
  const std::string text = ReadTextFile(path);
  try {
    PartCalibration part = ReadPart(Json::parse(text), path);
    return part.equations.blocks.empty() ? std::nullopt : std::optional(std::move(part));
  } catch (const Json::exception& error) {
    throw DataError(fmt::format("{}: expected what rigmap part writes there, found {}",
                                path.string(), error.what()));
  }
}

}  // namespace rigmap

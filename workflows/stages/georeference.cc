#include "workflows/stages/georeference.h"

#include <spdlog/spdlog.h>

#include <cereal/types/optional.hpp>
#include <cereal/types/string.hpp>
#include <nlohmann/json.hpp>

#include "georeference/route_files.h"
#include "pipeline/code_identity.h"

namespace rigmap {
namespace {

std::vector<RouteLandmark> RocksOnRoute(const std::filesystem::path& map_ply,
                                        const RockSegmentationOptions& options) {
  std::vector<RouteLandmark> rocks;
  if (map_ply.empty()) return rocks;
  for (const SegmentedRock& rock : SegmentRocksIn(map_ply, options).rocks) {
    rocks.push_back(
        {{rock.centre.x(), rock.centre.y(), rock.top_z_m}, rock.width_m, rock.height_m});
  }
  return rocks;
}

// The trajectory is the adjusted one whatever the fixes say: they have moved no pose against
// another.
std::string SidecarText(const EarthFit& fit, const GeoreferenceInputs& inputs) {
  auto json = ToJson(fit);
  json["world_up"] = Name(inputs.world_up);
  if (!inputs.warning.empty()) json["verdict"] = inputs.warning;
  return json.dump(1) + "\n";
}

Georeferenced MakeGeoreferenced(const StageContext& context, const Dataset& dataset,
                                const Fixes& fixes, const PosedPart& part, const FusedMap& map,
                                const Warning& warning, const RtkAlignmentOptions& alignment,
                                const EarthFitOptions& earth,
                                const RockSegmentationOptions& rocks) {
  const auto map_ply = map.points > 0 ? context.root / "dense.ply" : std::filesystem::path();
  return GeoreferenceOf({fixes.fixes, part.trajectory, dataset.rig.antenna_in_left, map_ply,
                         part.world_up, warning.text},
                        alignment, earth, rocks);
}

void PublishEarth(Publication& publication, const StageContext&, const Georeferenced& product,
                  const Dataset&, const Fixes&, const PosedPart&, const FusedMap&, const Warning&) {
  PublishGeoreferenced(publication, product);
}

}  // namespace

std::optional<GridFrame> Georeferenced::Grid() const {
  if (!frame) return std::nullopt;
  return EarthMap(*frame).GridAround(Eigen::Vector2d::Zero());
}

Georeferenced GeoreferenceOf(const GeoreferenceInputs& inputs, const RtkAlignmentOptions& alignment,
                             const EarthFitOptions& earth, const RockSegmentationOptions& rocks) {
  Georeferenced product;
  if (inputs.fixes.empty() || !inputs.antenna_in_left) return product;
  const EarthFit fit =
      FitToEarth(inputs.fixes, inputs.trajectory, *inputs.antenna_in_left, alignment, earth);
  product.json = SidecarText(fit, inputs);
  if (!fit.frame) {
    spdlog::warn("the fixes give the world no place on Earth: {}", fit.why);
    return product;
  }
  product.frame = fit.frame;
  const EarthMap map(*fit.frame);
  const auto landmarks = RocksOnRoute(inputs.map_ply, rocks);
  const Route route{inputs.trajectory,  map,
                    landmarks,          fit.horizontal->SigmaAt(fit.horizontal->world_centre),
                    fit.height_sigma_m, inputs.warning};
  product.utm_csv = WriteTrajectoryUtm(inputs.trajectory, map);
  product.geojson = WriteRouteGeoJson(route);
  product.kml = WriteRouteKml(route);
  return product;
}

void PublishGeoreferenced(Publication& publication, const Georeferenced& georeferenced) {
  const std::string* texts[] = {&georeferenced.json, &georeferenced.utm_csv, &georeferenced.geojson,
                                &georeferenced.kml};
  for (std::size_t i = 0; i < kGeoreferenceOutputs.size(); ++i) {
    if (texts[i]->empty()) continue;
    publication.File(kGeoreferenceOutputs[i], [&](std::ostream& stream) { stream << *texts[i]; });
  }
}

EarthStage GeoreferenceStage() {
  return {
      .name = "georeference",
      .about = "where the finished world lies on Earth, and the route there, by satellite fixes",
      .code = CodeHere(),
      .make = MakeGeoreferenced,
      .publishes = kGeoreferenceOutputs,
      .publish = PublishEarth};
}

}  // namespace rigmap

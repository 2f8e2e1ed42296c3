#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <numbers>

#include "evaluation/internal/rounded.h"
#include "evaluation/rock_survey.h"

namespace rigmap {
namespace {

nlohmann::ordered_json ToJson(const SurveyRow& row) {
  nlohmann::ordered_json json;
  json["size"] = row.surveyed.kind;
  json["easting_m"] = Rounded(row.surveyed.position.easting_m, 3);
  json["northing_m"] = Rounded(row.surveyed.position.northing_m, 3);
  json["x_m"] = Rounded(row.position_in_world.x(), 3);
  json["y_m"] = Rounded(row.position_in_world.y(), 3);
  json["limit_m"] = Rounded(row.limit_m, 3);
  json["found"] = row.found.has_value();
  if (!row.found) return json;
  json["east_m"] = Rounded(row.offset_m.x(), 3);
  json["north_m"] = Rounded(row.offset_m.y(), 3);
  json["distance_m"] = Rounded(row.offset_m.norm(), 3);
  json["height_m"] = Rounded(row.found->height_m, 3);
  json["width_m"] = Rounded(row.found->width_m, 3);
  return json;
}

}  // namespace

nlohmann::ordered_json ToJson(const RockSurvey& survey) {
  nlohmann::ordered_json json;
  json["expected"] = survey.rows.size();
  json["found"] = survey.found;
  json["segmented"] = survey.segmented;
  json["unknown"] = survey.unknown;
  json["each"] = nlohmann::ordered_json::array();
  for (const SurveyRow& row : survey.rows) json["each"].push_back(ToJson(row));
  return json;
}

nlohmann::ordered_json ToJson(const RtkAlignment& alignment) {
  nlohmann::ordered_json json;
  json["used"] = alignment.used;
  json["rejected"] = alignment.rejected;
  json["rms_residual_m"] = Rounded(alignment.rms_residual_m, 4);
  json["clock_offset_s"] = Rounded(alignment.clock_offset_s, 4);
  json["clock_offset_determined"] = alignment.clock_offset_sigma_s.has_value();
  if (alignment.clock_offset_sigma_s) {
    json["clock_offset_sigma_s"] = Rounded(*alignment.clock_offset_sigma_s, 4);
  }
  const Rigid2& motion = alignment.plane_from_world;
  json["heading_deg"] = Rounded(motion.angle_rad * 180.0 / std::numbers::pi, 4);
  json["east_m"] = Rounded(motion.translation.x(), 4);
  json["north_m"] = Rounded(motion.translation.y(), 4);
  json["origin_latitude_deg"] = alignment.plane_origin.latitude_deg;
  json["origin_longitude_deg"] = alignment.plane_origin.longitude_deg;
  return json;
}

std::string FormatTable(const RockSurvey& survey) {
  std::string table =
      fmt::format("{:<7} {:>11} {:>12}  {:<5} {:>7} {:>7} {:>8} {:>6} {:>5}\n", "rock", "easting m",
                  "northing m", "found", "east m", "north m", "distance", "height", "width");
  for (const SurveyRow& row : survey.rows) {
    table += fmt::format("{:<7} {:>11.2f} {:>12.2f}  {:<5}", row.surveyed.kind,
                         row.surveyed.position.easting_m, row.surveyed.position.northing_m,
                         row.found ? "yes" : "no");
    if (row.found) {
      table += fmt::format(" {:>7.2f} {:>7.2f} {:>8.2f} {:>6.2f} {:>5.2f}", row.offset_m.x(),
                           row.offset_m.y(), row.offset_m.norm(), row.found->height_m,
                           row.found->width_m);
    }
    table += '\n';
  }
  return table + fmt::format("{} of {} surveyed rocks found; {} in the map, {} of them unknown\n",
                             survey.found, survey.rows.size(), survey.segmented, survey.unknown);
}

}  // namespace rigmap

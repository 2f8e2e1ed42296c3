// Metrics as text for people.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace rigmap {

// A line for each value, those of an inner object under its name and a point; a table for each
// array of objects, with a column for each of their keys. `steps` are one table, a row each, of
// what tells them apart.
std::string FormatMetrics(const nlohmann::ordered_json& metrics);

}  // namespace rigmap

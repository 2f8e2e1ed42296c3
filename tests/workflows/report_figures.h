// The figures of a report, as a reader and as a program sees them.
#pragma once

#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

namespace rigmap {

struct ReportFigure {
  std::string value;    // the exact number, as text
  std::string source;   // summary, evaluation, comparison, map
  std::string pointer;  // in it
  std::string shown;    // "73.6 cm"
};

// All of a page, in its order.
std::vector<ReportFigure> FiguresOf(const std::string& page);

// What is wrong with a figure, beside the number that it is to show; empty: nothing. The value has
// to be that number, and what is shown a rounding of it in its unit.
std::string Complaint(const ReportFigure& figure, const nlohmann::ordered_json& document);

// The pointers of all numbers in a document.
std::set<std::string> NumbersIn(const nlohmann::ordered_json& document);

}  // namespace rigmap

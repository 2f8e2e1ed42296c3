// A whole page: style, content, data and scripts in one file.
#pragma once

#include <string>
#include <vector>

#include "report/figures.h"

namespace rigmap {

struct Page {
  std::string title;                  // plain text
  std::vector<std::string> sections;  // HTML
  Json data;                          // for the scripts
  std::vector<std::string> points;    // texts of the levels points-0, points-1, ...
};

// The page refers to nothing outside but files beside it, by links.
std::string WritePage(const Page& page);

// What follows for a part, a traverse and a comparison.
struct PartContent;
struct ResultFolder;
Page PartPage(const PartContent& content);
Page ComparisonPage(const ResultFolder& folder);

}  // namespace rigmap

#include <fmt/format.h>

#include "report/page.h"
#include "report/part_content.h"

namespace rigmap {

Page PartPage(const PartContent& content) {
  Page page{.title = fmt::format("{} \u00b7 rigmap", content.folder.name)};
  for (const auto section :
       {VerdictSection, ViewSection, PartsSection, RouteSection, EvaluationSection, MapSection,
        CalibrationSection, TracksSection, FramesSection, GatesSection, RunSection}) {
    if (std::string text = section(content); !text.empty()) {
      page.sections.push_back(std::move(text));
    }
  }
  page.data = PageData(content);
  for (const PackedLevel& level : content.points.levels) page.points.push_back(level.text);
  return page;
}

}  // namespace rigmap

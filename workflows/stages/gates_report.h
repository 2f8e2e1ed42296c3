// Gates and what a verdict is told from as summary.json has them, and read back.
#pragma once

#include "gates/findings.h"
#include "gates/gates.h"
#include "pipeline/stage.h"

namespace rigmap {

// `gates`: a list with name, value (null where it does not apply), limit, passed and why of each.
Report ReportGates(const Gates& gates);
Gates ReadGates(const Report& report);

// `verdict` without its sentence.
Report ReportFindings(const PartFindings& findings);

// What the checks of a part reported, `gates` and `verdict`.
struct JudgedPart {
  Gates gates;
  PartFindings findings;
};
JudgedPart ReadJudged(const Report& merged);

}  // namespace rigmap

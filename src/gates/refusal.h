// Why a part is not to be trusted, as a person needs it.
#pragma once

#include <string>
#include <vector>

#include "gates/findings.h"

namespace rigmap {

// One thing that is wrong, whichever gates it made fail.
struct Cause {
  std::string brief;   // for a band over a picture: 70 characters at most
  std::string found;   // what was found, and in brackets what was expected
  std::string advice;  // what helps against it
  Gates gates;         // that speak of it
};

struct Refusal {
  std::vector<Cause> causes;  // in the order in which they arise on the way of a part
  std::string usable;         // what is usable all the same, and how good it is
};

// Causes of the gates that failed, without those that follow from another: a wrong rig explains a
// bent map, and both explain large sigmas. No cause where all passed. Frames are numbered as in the
// data, where this part's first is `first_frame`. Nothing is advised that would silence a gate
// without mending its cause.
Refusal RefusalOf(const Gates& gates, const PartFindings& findings, int first_frame = 0);

// "FOUND (gate A, gate B)"
std::string SentenceOf(const Cause& cause);

// "not trusted: BRIEF", with how many more causes there are; empty where there is none.
std::string WarningOf(const Refusal& refusal);

// "1.2 % and positions to 80.3 cm (95 %)", of a scale that is known.
std::string HowGood(const Accuracy& accuracy);

// Metres as people read them: "4.2 mm", "80.3 cm", "1.20 m".
std::string LengthText(double metres);

}  // namespace rigmap

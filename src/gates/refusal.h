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

// What people call the frames.
struct FrameNames {
  struct Part {
    std::string name;
    int first = 0;   // number, in this part, of the first frame that no part before it has
    int frames = 0;  // such frames
  };
  int first = 0;                 // number of the first frame in the data
  std::vector<Part> parts = {};  // that were joined, in order of time; none: a part by itself

  // "9"; "9 of part 2".
  std::string Of(int frame) const;
  // "3:9"; "3:9 of part 2"; "3 of part 2 to 9 of part 3".
  std::string Of(const FrameRun& range) const;
};

// Causes of the gates that failed, without those that follow from another: a wrong rig explains a
// bent map, and both explain large sigmas. No cause where all passed. Nothing is advised that would
// silence a gate without mending its cause.
Refusal RefusalOf(const Gates& gates, const PartFindings& findings, const FrameNames& names = {});

// "FOUND (gate A, gate B)"
std::string SentenceOf(const Cause& cause);

// "not trusted: BRIEF", with how many more causes there are; empty where there is none.
std::string WarningOf(const Refusal& refusal);

// "1.2 % and positions to 80.3 cm (95 %)", of a scale that is known; with as many digits as tell it
// from what was asked for.
std::string HowGood(const PartFindings& findings);

// Metres as people read them: "4.2 mm", "80.3 cm", "1.20 m".
std::string LengthText(double metres);

}  // namespace rigmap

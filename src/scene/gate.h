// A measured quality with its limit. One that fails makes a part's result untrusted.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace rigmap {

struct Gate {
  std::string name;
  std::optional<double> value;  // nothing: does not apply, and passes
  double limit = 0.0;
  bool passed = true;
  std::string why;  // what was found, for the reader of summary.json
};

using Gates = std::vector<Gate>;

}  // namespace rigmap

// Numbers of a result as people read them, each bound to the file that it stands in.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace rigmap {

using Json = nlohmann::ordered_json;

// What a number is, and so how it is shown.
enum class Quantity {
  kCount,
  kMetres,  // as m, cm or mm
  kMillimetres,
  kPercent,  // the number is in per cent
  kShare,    // the number is a share, shown in per cent
  kPixels,
  kDegrees,
  kSeconds,
  kMegabytes,
  kRatio,
  kCalibration,  // a parameter of a camera, six digits
  kExact         // as the file has it
};

// A JSON document by the name that the report knows it by: summary, evaluation, comparison, map.
struct FigureSource {
  const char* name;
  const Json& json;
};

// The number at a JSON pointer as <data value="EXACT" data-from="NAME/POINTER">SHOWN</data>, with
// three significant digits (counts whole); null, missing or no number: a dash. A test compares all
// of them with the files.
std::string Figure(const FigureSource& source, const std::string& pointer, Quantity quantity);
// "\u00b1 SHOWN", as a sigma or a bound is shown: two significant digits.
std::string PlusMinus(const FigureSource& source, const std::string& pointer, Quantity quantity);
// Whether there is a number.
bool HasFigure(const FigureSource& source, const std::string& pointer);

// The same text without the binding, for numbers that stand in no file.
std::string ShownNumber(double value, Quantity quantity, int digits = 3);

// The text at a pointer, escaped; empty where there is none.
std::string TextAt(const Json& json, const std::string& pointer);

// What stands at a pointer; null where nothing does.
const Json& At(const Json& json, const std::string& pointer);

}  // namespace rigmap

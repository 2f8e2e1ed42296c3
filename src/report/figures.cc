#include "report/figures.h"

#include <fmt/format.h>

#include <cmath>

#include "report/html.h"

namespace rigmap {
namespace {

constexpr const char* kDash = "<span class=\"none\">\u2013</span>";

struct ShownAs {
  double factor;
  const char* unit;
};

ShownAs LengthUnit(double metres) {
  const double size = std::abs(metres);
  if (size == 0.0 || size >= 1.0) return {1.0, "m"};
  return size < 0.01 ? ShownAs{1000.0, "mm"} : ShownAs{100.0, "cm"};
}

ShownAs UnitOf(double value, Quantity quantity) {
  switch (quantity) {
    case Quantity::kMetres:
      return LengthUnit(value);
    case Quantity::kMillimetres:
      return {1.0, "mm"};
    case Quantity::kPercent:
      return {1.0, "%"};
    case Quantity::kShare:
      return {100.0, "%"};
    case Quantity::kPixels:
      return {1.0, "px"};
    case Quantity::kDegrees:
      return {1.0, "\u00b0"};
    case Quantity::kSeconds:
      return {1.0, "s"};
    case Quantity::kMegabytes:
      return {1.0, "MB"};
    case Quantity::kCount:
    case Quantity::kRatio:
    case Quantity::kCalibration:
    case Quantity::kExact:
      break;
  }
  return {1.0, ""};
}

// Never an exponent; thousands apart.
std::string Digits(double value, int digits) {
  if (value == 0.0) return "0";
  const int before_point = static_cast<int>(std::floor(std::log10(std::abs(value)))) + 1;
  std::string text = fmt::format("{:.{}f}", value, std::clamp(digits - before_point, 0, 9));
  for (int end = before_point + (value < 0.0 ? 1 : 0) - 3; end > (value < 0.0 ? 1 : 0); end -= 3) {
    if (before_point > 4) text.insert(static_cast<std::size_t>(end), "\u202f");
  }
  return text;
}

const nlohmann::ordered_json* Find(const Json& json, const std::string& pointer) {
  const Json::json_pointer path(pointer);
  return json.contains(path) ? &json.at(path) : nullptr;
}

std::string BoundFigure(const FigureSource& source, const std::string& pointer, Quantity quantity,
                        int digits) {
  const Json* found = Find(source.json, pointer);
  if (!found || !found->is_number()) return kDash;
  return fmt::format("<data value=\"{}\" data-from=\"{}{}\">{}</data>", found->dump(),
                     Escaped(source.name), Escaped(pointer),
                     ShownNumber(found->get<double>(), quantity, digits));
}

}  // namespace

std::string ShownNumber(double value, Quantity quantity, int digits) {
  if (!std::isfinite(value)) return kDash;
  if (quantity == Quantity::kCount) return Digits(std::round(value), 0);
  if (quantity == Quantity::kExact) return fmt::format("{}", value);
  const ShownAs as = UnitOf(value, quantity);
  return fmt::format("{}{}{}", Digits(as.factor * value, digits), *as.unit ? "\u00a0" : "",
                     as.unit);
}

bool HasFigure(const FigureSource& source, const std::string& pointer) {
  const Json* found = Find(source.json, pointer);
  return found && found->is_number();
}

std::string Figure(const FigureSource& source, const std::string& pointer, Quantity quantity) {
  return BoundFigure(source, pointer, quantity, quantity == Quantity::kCalibration ? 6 : 3);
}

std::string PlusMinus(const FigureSource& source, const std::string& pointer, Quantity quantity) {
  return "\u00b1\u00a0" + BoundFigure(source, pointer, quantity, 2);
}

std::string TextAt(const Json& json, const std::string& pointer) {
  const Json* found = Find(json, pointer);
  return found && found->is_string() ? Escaped(found->get<std::string>()) : "";
}

const Json& At(const Json& json, const std::string& pointer) {
  static const Json kNothing;
  const Json* found = Find(json, pointer);
  return found ? *found : kNothing;
}

}  // namespace rigmap

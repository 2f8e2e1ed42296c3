#include "tests/workflows/report_figures.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <functional>
#include <regex>

namespace rigmap {
namespace {

using Json = nlohmann::ordered_json;

std::string Without(std::string text, const std::string& part) {
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part)) {
    text.erase(at, part.size());
  }
  return text;
}

// What a shown number has to be multiplied by to be the file's.
double FactorOf(const std::string& unit, double value, double shown) {
  if (unit == "cm") return 0.01;
  // Of metres, or of a number that the file has in millimetres.
  if (unit == "mm") return std::abs(value - shown) <= 0.01 * std::abs(value) ? 1.0 : 0.001;
  // Of per cent, or of a share.
  if (unit == "%") return std::abs(value - shown) <= 0.01 * std::abs(value) ? 1.0 : 0.01;
  return 1.0;
}

}  // namespace

std::vector<ReportFigure> FiguresOf(const std::string& page) {
  static const std::regex kFigure(
      "<data value=\"([^\"]*)\" data-from=\"([^\"/]*)([^\"]*)\">([^<]*)</data>");
  std::vector<ReportFigure> figures;
  for (std::sregex_iterator it(page.begin(), page.end(), kFigure), end; it != end; ++it) {
    figures.push_back({(*it)[1], (*it)[2], (*it)[3], (*it)[4]});
  }
  return figures;
}

std::string Complaint(const ReportFigure& figure, const Json& document) {
  const auto says = [&](const std::string& wrong) {
    return fmt::format("{}{} = {}, shown as {}: {}", figure.source, figure.pointer, figure.value,
                       figure.shown, wrong);
  };
  const Json::json_pointer pointer(figure.pointer);
  if (!document.contains(pointer)) return says("not in the file");
  const Json& number = document.at(pointer);
  if (!number.is_number() || number.dump() != figure.value) {
    return says(fmt::format("the file has {}", number.dump()));
  }
  const std::string text = Without(figure.shown, "\u202f");
  std::size_t used = 0;
  const double shown = std::stod(text, &used);
  const std::string unit = Without(text.substr(used), "\u00a0");
  const double value = number.get<double>();
  const double factor = FactorOf(unit, value, shown);
  const auto point = text.substr(0, used).find('.');
  const double decimals = point == std::string::npos ? 0.0 : static_cast<double>(used - point - 1);
  const double half_digit = 0.5 * std::pow(10.0, -decimals) * factor;
  if (std::abs(shown * factor - value) > half_digit * (1.0 + 1e-9) + 1e-15) {
    return says("is no rounding of it");
  }
  return "";
}

std::set<std::string> NumbersIn(const Json& document) {
  std::set<std::string> pointers;
  for (const auto& [pointer, value] : document.flatten().items()) {
    if (value.is_number()) pointers.insert(pointer);
  }
  return pointers;
}

}  // namespace rigmap

#include "tests/workflows/report_figures.h"

#include <fmt/format.h>

#include <cmath>

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
  if (unit == "mm") return std::abs(value - shown) <= 0.06 * std::abs(value) ? 1.0 : 0.001;
  // Of per cent, or of a share.
  if (unit == "%") return std::abs(value - shown) <= 0.06 * std::abs(value) ? 1.0 : 0.01;
  return 1.0;
}

}  // namespace

std::vector<ReportFigure> FiguresOf(const std::string& page) {
  const std::string start = "<data value=\"", middle = "\" data-from=\"", end = "</data>";
  std::vector<ReportFigure> figures;
  for (auto at = page.find(start); at != std::string::npos; at = page.find(start, at)) {
    at += start.size();
    const auto from = page.find(middle, at), close = page.find("\">", from + middle.size());
    const std::string name = page.substr(from + middle.size(), close - from - middle.size());
    const auto slash = name.find('/');
    figures.push_back({page.substr(at, from - at), name.substr(0, slash), name.substr(slash),
                       page.substr(close + 2, page.find(end, close) - close - 2)});
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
  const Json flat = document.flatten();
  for (const auto& [pointer, value] : flat.items()) {
    if (value.is_number()) pointers.insert(pointer);
  }
  return pointers;
}

}  // namespace rigmap

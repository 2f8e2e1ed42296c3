#include "report/figures.h"

#include <gmock/gmock.h>

namespace rigmap {
namespace {

using testing::HasSubstr;

std::string Shown(double value, Quantity quantity, int digits = 3) {
  return ShownNumber(value, quantity, digits);
}

TEST(FiguresTest, AreShownWithThreeDigitsAndAUnit) {
  EXPECT_EQ(Shown(4.17684, Quantity::kMetres), "4.18\u00a0m");
  EXPECT_EQ(Shown(0.7364, Quantity::kMetres), "73.6\u00a0cm");
  EXPECT_EQ(Shown(0.00012, Quantity::kMetres), "0.120\u00a0mm");
  EXPECT_EQ(Shown(-0.5, Quantity::kMetres), "-50.0\u00a0cm");
  EXPECT_EQ(Shown(0.0, Quantity::kPixels), "0\u00a0px");
  EXPECT_EQ(Shown(0.935, Quantity::kShare), "93.5\u00a0%");
  EXPECT_EQ(Shown(0.0736, Quantity::kPercent, 2), "0.074\u00a0%");
  EXPECT_EQ(Shown(1234.5, Quantity::kRatio), "1234");
}

TEST(FiguresTest, CountsAreWhole) {
  EXPECT_EQ(Shown(7, Quantity::kCount), "7");
  EXPECT_EQ(Shown(9447, Quantity::kCount), "9447");
  EXPECT_EQ(Shown(876895, Quantity::kCount), "876\u202f895");
  EXPECT_EQ(Shown(12345678, Quantity::kCount), "12\u202f345\u202f678");
}

TEST(FiguresTest, AreBoundToWhatTheyShow) {
  const Json summary = {{"verdict", {{"scale_95_pct", 0.3074684517416307}, {"text", nullptr}}}};
  const FigureSource source{"summary", summary};
  const std::string figure = Figure(source, "/verdict/scale_95_pct", Quantity::kPercent);
  EXPECT_EQ(figure,
            "<data value=\"0.3074684517416307\" "
            "data-from=\"summary/verdict/scale_95_pct\">0.307\u00a0%</data>");
  EXPECT_THAT(PlusMinus(source, "/verdict/scale_95_pct", Quantity::kPercent), HasSubstr("0.31"));
}

TEST(FiguresTest, ThatAreNotThereAreADash) {
  const Json summary = {{"text", "x"}, {"none", nullptr}};
  const FigureSource source{"summary", summary};
  for (const char* pointer : {"/text", "/none", "/other", "/other/0/deep"}) {
    EXPECT_THAT(Figure(source, pointer, Quantity::kCount), HasSubstr("\u2013")) << pointer;
    EXPECT_FALSE(HasFigure(source, pointer)) << pointer;
  }
  EXPECT_TRUE(At(summary, "/other/0").is_null());
  EXPECT_EQ(TextAt(summary, "/text"), "x");
  EXPECT_EQ(TextAt(summary, "/none"), "");
}

}  // namespace
}  // namespace rigmap

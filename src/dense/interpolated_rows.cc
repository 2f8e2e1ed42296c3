#include "dense/internal/interpolated_rows.h"

namespace rigmap {

InterpolatedRows::InterpolatedRows(const cv::Mat& view)
    : last_column_(static_cast<float>(view.cols - 1)) {
  view.convertTo(padded_, CV_32F);
  cv::copyMakeBorder(padded_, padded_, 0, 0, kBefore, kBehind, cv::BORDER_REPLICATE);
}

}  // namespace rigmap

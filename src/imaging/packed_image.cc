#include "imaging/internal/packed_image.h"

#include <zstd.h>

#include <cstddef>
#include <memory>

namespace rigmap {
namespace {

constexpr int kLevel = 1;  // higher ones take longer and gain a few per cent

// Value less the one before it in the row, of the same channel; modulo the type's range.
template <class Value>
void SplitDifferences(const cv::Mat& image, std::uint8_t* bytes) {
  const int channels = image.channels(), values = image.cols * channels;
  const std::size_t count = image.total() * channels;
  for (int row = 0; row < image.rows; ++row) {
    const auto* line = image.ptr<Value>(row);
    for (int channel = 0; channel < channels; ++channel) {
      std::uint8_t* to =
          bytes + (static_cast<std::size_t>(channel) * image.rows + row) * image.cols;
      Value last = 0;
      for (int i = channel; i < values; i += channels, ++to) {
        const auto difference = static_cast<Value>(line[i] - last);
        last = line[i];
        for (std::size_t byte = 0; byte < sizeof(Value); ++byte) {
          to[byte * count] = static_cast<std::uint8_t>(difference >> (8 * byte));
        }
      }
    }
  }
}

template <class Value>
void SumDifferences(const std::uint8_t* bytes, cv::Mat& image) {
  const int channels = image.channels(), values = image.cols * channels;
  const std::size_t count = image.total() * channels;
  for (int row = 0; row < image.rows; ++row) {
    auto* line = image.ptr<Value>(row);
    for (int channel = 0; channel < channels; ++channel) {
      const std::uint8_t* from =
          bytes + (static_cast<std::size_t>(channel) * image.rows + row) * image.cols;
      Value last = 0;
      for (int i = channel; i < values; i += channels, ++from) {
        unsigned difference = 0;
        for (std::size_t byte = 0; byte < sizeof(Value); ++byte) {
          difference |= static_cast<unsigned>(from[byte * count]) << (8 * byte);
        }
        line[i] = last = static_cast<Value>(last + difference);
      }
    }
  }
}

}  // namespace

std::vector<std::uint8_t> Pack(const cv::Mat& image) {
  CV_Assert(image.depth() == CV_8U || image.depth() == CV_16U);
  std::vector<std::uint8_t> bytes(image.total() * image.elemSize());
  if (image.depth() == CV_8U) {
    SplitDifferences<std::uint8_t>(image, bytes.data());
  } else {
    SplitDifferences<std::uint16_t>(image, bytes.data());
  }
  const std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context(ZSTD_createCCtx(),
                                                                     ZSTD_freeCCtx);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, kLevel);
  ZSTD_CCtx_setParameter(context.get(), ZSTD_c_checksumFlag, 1);  // a byte that changed is noticed
  std::vector<std::uint8_t> packed(ZSTD_compressBound(bytes.size()));
  packed.resize(
      ZSTD_compress2(context.get(), packed.data(), packed.size(), bytes.data(), bytes.size()));
  return packed;
}

cv::Mat Unpack(const std::vector<std::uint8_t>& packed, cv::Size size, int type) {
  cv::Mat image(size, type);
  std::vector<std::uint8_t> bytes(image.total() * image.elemSize());
  const std::size_t found =
      ZSTD_decompress(bytes.data(), bytes.size(), packed.data(), packed.size());
  if (found != bytes.size()) return {};  // or an error
  if (image.depth() == CV_8U) {
    SumDifferences<std::uint8_t>(bytes.data(), image);
  } else {
    SumDifferences<std::uint16_t>(bytes.data(), image);
  }
  return image;
}

}  // namespace rigmap

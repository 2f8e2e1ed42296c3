// How long matching takes: by hand, build/release/tests/dense/dense_benchmark.
#include <benchmark/benchmark.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "core/freed_memory.h"
#include "dense/internal/coarse_to_fine.h"
#include "dense/internal/semi_global.h"

namespace rigmap {
namespace {

struct Views {
  cv::Mat left, right;
};

// Ground, whose disparity grows from 5 px by 0.1 px a row.
Views RenderGround(cv::Size size) {
  cv::Mat texture(size.height, 2 * size.width, CV_8U);
  cv::theRNG().state = 1;
  cv::randu(texture, 0, 256);
  cv::GaussianBlur(texture, texture, {}, 1.5);
  texture.convertTo(texture, CV_8U, 3.0, -256.0);
  Views views{cv::Mat(size, CV_8U), texture(cv::Rect({size.width / 2, 0}, size)).clone()};
  for (int row = 0; row < size.height; ++row) {
    const int from = size.width / 2 - static_cast<int>(5.0 + 0.1 * row);
    texture.row(row).colRange(from, from + size.width).copyTo(views.left.row(row));
  }
  return views;
}

// Arguments: width, height, disparities searched at each pixel.
void BM_SemiGlobal(benchmark::State& state) {
  const cv::Size size(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  const Views views = RenderGround(size);
  const TileWindows windows = WholeRange(size, static_cast<int>(state.range(2)) - 1);
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        MatchSemiGlobal(views.left, views.right, windows, {}, std::size_t{1} << 32));
  }
  state.SetItemsProcessed(state.iterations() * size.area() * state.range(2));
}
BENCHMARK(BM_SemiGlobal)->Args({1024, 768, 32})->Args({1024, 768, 128});

// Arguments: width, height, range in px.
void BM_CoarseToFine(benchmark::State& state) {
  const cv::Size size(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  const Views views = RenderGround(size);
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        MatchCoarseToFine(views.left, views.right, static_cast<double>(state.range(2)), {}));
  }
  state.SetItemsProcessed(state.iterations() * size.area());
}
BENCHMARK(BM_CoarseToFine)->Args({1024, 768, 250})->Args({2448, 2048, 1500});

}  // namespace
}  // namespace rigmap

int main(int argc, char** argv) {
  rigmap::KeepFreedMemory();
  cv::setNumThreads(1);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}

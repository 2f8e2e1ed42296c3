// How depth is got from a pair of rectified images.
#pragma once

#include "core/options.h"

namespace rigmap {

enum class DenseMethod { kSgm, kBm };
constexpr auto NamesOf(DenseMethod) { return std::array{"sgm", "bm"}; }

// What each option does and why it has its default: the declaration in dense_options.cc.
struct DenseOptions {
  static constexpr const char* kSection = "dense";

  DenseMethod method = DenseMethod::kSgm;
  int block_px = 5;
  double small_step_cost = 8.0;
  double large_step_cost = 32.0;
  int uniqueness_pct = 10;
  int left_right_px = 1;
  int speckle_size_px = 400;
  int speckle_step_px = 1;
  int refinement_px = 9;
  int smoothing_px = 7;
  bool keep_bends = true;
  double refined_sigma_factor = 2.0;
  double least_sigma_px = 0.05;
  double min_depth_m = 0.0;
  double max_range_m = 0.0;
  double max_depth_sigma_pct = 20.0;

  OptionFields Fields();
  void RequireRelations() const;  // throws UsageError
};

}  // namespace rigmap

// The stage `evaluation`: leaves evaluation.json and reference.json where there is a truth or there
// are satellite fixes.
#pragma once

#include <string>

#include "evaluation/rock_segmentation.h"
#include "evaluation/rock_survey.h"
#include "evaluation/trajectory_metrics.h"
#include "georeference/rtk_alignment.h"
#include "workflows/stages/fusion.h"
#include "workflows/stages/inputs.h"
#include "workflows/stages/steps.h"

namespace rigmap {

// Whole files; empty where there is nothing to compare with.
struct EvaluationTexts {
  std::string metrics, reference;

  template <class Archive>
  void serialize(Archive& archive) {
    archive(metrics, reference);
  }
};

using EvaluationStage = Stage<
    EvaluationTexts, Takes<Dataset, Truth, PosedPart, Steps, FusedMap>,
    Reads<EvaluationOptions, RtkAlignmentOptions, RockSegmentationOptions, RockSurveyOptions>>;
EvaluationStage Evaluation();

}  // namespace rigmap

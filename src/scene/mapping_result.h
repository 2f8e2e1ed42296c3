// What mapping made of a part's keyframes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "scene/mapping_method.h"
#include "scene/sparse_model.h"

namespace rigmap {

struct MappingResult {
  std::vector<SparseModel> models;  // largest first, as in the folders
  // That gave them: kNone where none were wanted, nothing where what was wanted led to none.
  std::optional<MappingMethod> method;
  std::vector<std::string> remarks;  // what went otherwise than planned, a sentence each

  template <class Archive>
  void serialize(Archive& archive) {
    archive(models, method, remarks);
  }
};

}  // namespace rigmap

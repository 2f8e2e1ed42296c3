#include "export/las_options.h"

namespace rigmap {

OptionFields LasOptions::Fields() {
  return {
      {"las",
       &las,
       "",
       {},
       "Whether dense.las is written, the cloud for programs that read no PLY: seven eighths of "
       "dense.ply's size."},
  };
}

}  // namespace rigmap

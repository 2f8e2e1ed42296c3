// write_simulated_part FOLDER: the stereo folder that the end-to-end tests run on.
#include <cstdio>
#include <exception>

#include "tests/support/simulated_part.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: write_simulated_part FOLDER\n", stderr);
    return 2;
  }
  try {
    rigmap::SimulatedPart().WriteStereoFolder(argv[1]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "write_simulated_part: %s\n", error.what());
    return 1;
  }
}

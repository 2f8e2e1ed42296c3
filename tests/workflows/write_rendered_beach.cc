// write_rendered_beach FOLDER: the stereo folder that the end-to-end tests run on.
#include <cstdio>
#include <exception>

#include "tests/support/rendered_beach.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: write_rendered_beach FOLDER\n", stderr);
    return 2;
  }
  try {
    rigmap::WriteRenderedBeach(argv[1]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "write_rendered_beach: %s\n", error.what());
    return 1;
  }
}

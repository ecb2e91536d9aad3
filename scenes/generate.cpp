// SPDX-License-Identifier: Apache-2.0
// tessera_generate FOLDER: writes the demo scenes into FOLDER.
#include <cstdio>
#include <exception>

#include "scenes/courtyard.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr,
                 "usage: tessera_generate FOLDER\nwrites courtyard.json and what it refers to into FOLDER\n");
    return 2;
  }
  try {
    tessera::scenes::write_courtyard(argv[1]);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "tessera_generate: %s\n", e.what());
    return 1;
  }
}

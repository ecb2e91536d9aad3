// SPDX-License-Identifier: Apache-2.0
// tessera_generate FOLDER: writes the demo scenes into FOLDER, and those on which filters are judged into
// FOLDER/trials.
#include <cstdio>
#include <exception>

#include "scenes/courtyard.h"
#include "scenes/trials.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr,
                 "usage: tessera_generate FOLDER\nwrites courtyard.json and what it refers to into FOLDER, "
                 "and the scenes on which\n"
                 "filters are judged into FOLDER/trials\n");
    return 2;
  }
  try {
    tessera::scenes::write_courtyard(argv[1]);
    tessera::scenes::write_trials(std::filesystem::path(argv[1]) / "trials");
  } catch (const std::exception& e) {
    std::fprintf(stderr, "tessera_generate: %s\n", e.what());
    return 1;
  }
}

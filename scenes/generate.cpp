// SPDX-License-Identifier: Apache-2.0
// tessera_generate FOLDER: writes the demo scenes into FOLDER, those on which filters are judged into
// FOLDER/trials, and those in motion into FOLDER/shots.
#include <cstdio>
#include <exception>

#include "scenes/courtyard.h"
#include "scenes/shots.h"
#include "scenes/trials.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr,
                 "usage: tessera_generate FOLDER\nwrites courtyard.json and what it refers to into FOLDER, "
                 "the scenes on which\n"
                 "filters are judged into FOLDER/trials, and those in motion into FOLDER/shots\n");
    return 2;
  }
  try {
    tessera::scenes::write_courtyard(argv[1]);
    tessera::scenes::write_trials(std::filesystem::path(argv[1]) / "trials");
    tessera::scenes::write_shots(std::filesystem::path(argv[1]) / "shots");
  } catch (const std::exception& e) {
    std::fprintf(stderr, "tessera_generate: %s\n", e.what());
    return 1;
  }
}

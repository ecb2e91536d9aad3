// SPDX-License-Identifier: Apache-2.0
// The command line of `tessera denoise`.
#include <CLI/CLI.hpp>

#include "cli/denoise.h"
#include "cli/farm_link.h"
#include "cli/picture_options.h"

namespace tessera {
namespace {

void add_frame_options(CLI::App& app, DenoiseOptions& o) {
  app.add_option("--frames", o.frames, "Of a sequence: 1-60, 1-100x2,150 [all that are there]");
  app.add_option(
         "--handles", o.handles,
         "With history=on: frames before and behind these that are read, not written, if they are there")
      ->check(CLI::Range(0, 10000))
      ->capture_default_str();
  app.add_option("--cuts", o.cuts, "With history=on: frames that go by none before, as in --frames [none]");
  app.add_flag("--both-ways", o.both_ways, "With history=on: go by the frames that follow, too");
}

void add_source_options(CLI::App& app, DenoiseOptions& o) {
  app.add_option("--guide", o.guides,
                 "LAYER=FILE: a layer in a file of its own, e.g. albedo=shot.albedo.exr");
  app.add_option("--motion-scale", o.motion_scale,
                 "X,Y: makes motion vectors pixels per frame to the right and down [as their names say]");
  app.add_flag("--static", o.resting,
               "Nothing moves, neither camera nor objects: no motion vectors are needed");
  app.add_option("--samples", o.samples, "Per pixel, where the file does not say");
}

// Where a farm is set for all commands, this one still works here unless it is told to: its files are here,
// and scripts that filter a picture are not to depend on who else is at work.
void add_farm_options(CLI::App& app, DenoiseOptions& o) {
  add_link_options(app, o.farm);
  app.get_option("--coordinator")
      ->envname("")
      ->description("Through a farm: HOST:PORT of its coordinator, or ipc://PATH [on this machine]");
}

void add_tile_options(CLI::App& app, DenoiseOptions& o) {
  app.add_option(
         "--tile-size", o.tile_size,
         "N or WxH pixels; does not change the image [as --memory allows; through a farm 256 at most]")
      ->envname("TESSERA_TILE_SIZE");
  app.add_option("--memory", o.memory, "MiB that a tile may take; the image itself is held besides")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 24))
      ->capture_default_str();
  app.add_option("--device", o.device,
                 "OpenCL device of this machine: number or part of its name [first CPU]")
      ->envname("TESSERA_DEVICE");
}

}  // namespace

void describe(CLI::App& app, DenoiseOptions& o) {
  app.add_option("input", o.input,
                 "EXR with the noisy image and its guides, of any renderer; with #### or %04d a sequence")
      ->required();
  app.add_option("-o,--output", o.output,
                 "EXR to write, with all other layers of the input; a PNG preview goes beside it")
      ->required();
  add_frame_options(app, o);
  app.add_option("--filter", o.filter, "Denoiser, e.g. nlm, svgf:sigma_l=2 (see tessera filters)")
      ->envname("TESSERA_FILTER")
      ->capture_default_str();
  add_source_options(app, o);
  add_tile_options(app, o);
  add_farm_options(app, o);
  add_picture_options(app, o.compression, o.exposure);
  app.add_flag("--quiet", o.quiet, "Only problems");
}

}  // namespace tessera

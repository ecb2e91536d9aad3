// SPDX-License-Identifier: Apache-2.0
// tessera fetch: the images of a farm's job.
#include <memory>

#include "cli/fetching.h"
#include "cli/subcommand.h"

namespace tessera {

std::function<int()> describe_fetch(CLI::App& app) {
  struct Fetch {
    LinkOptions link;
    Fetching what;
  };
  auto c = std::make_shared<Fetch>();
  app.add_option("job", c->what.job, "Which job")->required();
  app.add_option("-o,--output", c->what.output, "name.exr, of a shot name.####.exr; previews go beside")
      ->required()
      ->envname("TESSERA_OUTPUT");
  app.add_option("--frames", c->what.frames, "Only these: 1-60, 1-100x2,150 [all that are there]");
  app.add_flag("--wait", c->what.wait,
               "Until the job ends, and end with its exit code; frames come as they are done");
  app.add_flag("--preview", c->what.growing,
               "Previews of frames under way, too; with --wait again and again as they grow");
  app.add_flag("--quiet", c->what.quiet, "Say nothing");
  add_link_options(app, c->link);
  return [c] {
    FarmLink farm(c->link);
    return static_cast<int>(fetch_job(farm, c->what));
  };
}

}  // namespace tessera

// SPDX-License-Identifier: Apache-2.0
// tessera: one binary, one table of subcommands.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <exception>
#include <iostream>
#include <new>
#include <vector>

#include "cli/config_file.h"
#include "cli/log_options.h"
#include "cli/subcommand.h"
#include "cli/version.h"
#include "core/error.h"
#include "core/nearest.h"

namespace tessera {
namespace {

constexpr std::array kCommands{
    Subcommand{"render", "Render a scene on this machine until the image is good enough", describe_render},
    Subcommand{"denoise", "Filter images of any renderer", describe_denoise},
    Subcommand{"compare", "Measure the error of an image against a reference", describe_compare},
    Subcommand{"scene", "Check, describe or convert a scene", describe_scene},
    Subcommand{"keygen", "Make a pair of keys for a farm beyond this machine", describe_keygen},
    Subcommand{"coordinator", "Be a farm's centre: take jobs, give work to workers", describe_coordinator},
    Subcommand{"worker", "Work for a farm", describe_worker},
    Subcommand{"submit", "Hand a scene in to a farm", describe_submit},
    Subcommand{"jobs", "List a farm's jobs, or what became of one", describe_jobs},
    Subcommand{"watch", "Watch a job: its cells, errors and progress, live", describe_watch},
    Subcommand{"fetch", "Fetch the images of a job", describe_fetch},
    Subcommand{"cancel", "End jobs, and drop what is under way", describe_cancel},
    Subcommand{"pause", "Give out no more work of jobs", describe_pause},
    Subcommand{"resume", "Go on with paused jobs", describe_resume},
    Subcommand{"priority", "Change a job's priority", describe_priority},
    Subcommand{"verify", "Have work of a job done again elsewhere, and compare the bits", describe_verify},
    Subcommand{"remove", "Forget jobs that are over, and their images", describe_remove},
    Subcommand{"workers", "List a farm's workers", describe_workers},
    Subcommand{"release", "Let a worker that was set aside work again", describe_release},
    Subcommand{"devices", "List the OpenCL devices that can filter", describe_devices},
    Subcommand{"filters", "List the filters, their parameters and halos", describe_filters},
    Subcommand{"schema", "Print the JSON Schema of the native scene format", describe_schema},
};

void require_known(std::string_view word) {
  std::vector<std::string_view> names;
  for (const Subcommand& command : kCommands) names.push_back(command.name);
  if (word.starts_with('-') || std::find(names.begin(), names.end(), word) != names.end()) return;
  throw Error(ExitCode::bad_usage,
              fmt::format("{}; accepted: {}", unknown("subcommand", word, names), listed(names)));
}

int run(int argc, char** argv) {
  if (argc > 1) require_known(argv[1]);
  CLI::App app{
      "Renders a frame on many machines, denoises it tile by tile without a seam, and stops when the image "
      "you get is good enough.",
      "tessera"};
  app.set_version_flag("--version", std::string(kVersion));
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 done, 1 internal error, 2 bad usage, 3 bad scene or input, 4 out of memory, 5 no "
      "usable\n"
      "device, 6 coordinator unreachable, 7 job failed, 8 stopped at a limit before it was acceptable "
      "(image\n"
      "written), 130 interrupted (image written).");
  std::function<int()> chosen;
  for (const Subcommand& command : kCommands) {
    CLI::App* sub = app.add_subcommand(std::string(command.name), std::string(command.summary));
    sub->add_option("--config", "TOML file with options by their long names; --threads 4 is threads = 4")
        ->envname("TESSERA_CONFIG");
    sub->callback([&chosen, run = command.describe(*sub)] { chosen = run; });
  }
  if (const auto file = config_file(argc, argv); !file.empty() && argc > 1 && *argv[1] != '-')
    read_config(file, *app.get_subcommand(argv[1]));
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& e) {
    return app.exit(e) == 0 ? 0 : static_cast<int>(ExitCode::bad_usage);
  }
  return chosen();
}

}  // namespace
}  // namespace tessera

int main(int argc, char** argv) {
  using tessera::ExitCode;
  const auto fail = [](ExitCode code, const char* what) {
    std::cerr << "tessera: " << what << '\n';
    return static_cast<int>(code);
  };
  try {
    // Commands without options of their own for it warn on stderr too: stdout is for what was asked.
    tessera::set_up_log({});
    return tessera::run(argc, argv);
  } catch (const tessera::Error& e) {
    return fail(e.code(), e.what());
  } catch (const std::bad_alloc&) {
    return fail(ExitCode::out_of_memory, "out of memory");
  } catch (const std::exception& e) {
    return fail(ExitCode::internal_error, e.what());
  }
}

// SPDX-License-Identifier: Apache-2.0
// tessera scene: check, info and convert. Results go to stdout, warnings to stderr.
#include <fmt/format.h>

#include <iostream>
#include <memory>

#include "cli/limit_options.h"
#include "cli/scene_info.h"
#include "cli/subcommand.h"
#include "core/scene/convert.h"
#include "core/scene/load.h"

namespace tessera {
namespace {

struct SceneOptions {
  std::string file, output;
  bool json = false;
  ImportLimits limits;
};

void print_warnings(const Scene& scene) {
  for (const std::string& warning : scene.warnings) std::cerr << "warning: " << warning << '\n';
}

int check(const SceneOptions& o) {
  const Scene scene = load_scene(o.file, o.limits);
  print_warnings(scene);
  fmt::print("{}: good, {} warning{}\n", o.file, scene.warnings.size(),
             scene.warnings.size() == 1 ? "" : "s");
  return 0;
}

int info(const SceneOptions& o) {
  const Scene scene = load_scene(o.file, o.limits);
  std::cout << (o.json ? info_json(scene) : info_table(scene));
  if (!o.json) print_warnings(scene);
  return 0;
}

int convert(const SceneOptions& o) {
  const Conversion done = convert_scene(o.file, o.output, o.limits);
  print_warnings(done.scene);
  if (done.whole)
    fmt::print("{}: the same scene, whole\n", o.output);
  else
    fmt::print("{}: the same scene, imports {}, because {}\n", o.output, o.file, done.why_not);
  return 0;
}

}  // namespace

std::function<int()> describe_scene(CLI::App& app) {
  auto options = std::make_shared<SceneOptions>();
  auto chosen = std::make_shared<std::function<int()>>();
  app.require_subcommand(1);
  const auto add = [&](const char* name, const char* summary, int (*run)(const SceneOptions&)) {
    CLI::App* sub = app.add_subcommand(name, summary);
    sub->add_option("file", options->file, "A .json, .gltf, .glb, .obj, .fbx or .ply file")->required();
    add_limit_option(*sub, options->limits);
    sub->callback([chosen, options, run] { *chosen = [options, run] { return run(*options); }; });
    return sub;
  };
  add("check", "Load a scene, and say what is wrong with it", check);
  add("info", "What is in a scene", info)->add_flag("--json", options->json, "Print a JSON object");
  add("convert", "Write a scene in the native format, the same to the bit", convert)
      ->add_option("output", options->output, "The .json file to write")
      ->required();
  return [chosen] { return (*chosen)(); };
}

}  // namespace tessera

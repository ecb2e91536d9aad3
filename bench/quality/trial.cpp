// SPDX-License-Identifier: Apache-2.0
#include "bench/quality/trial.h"

#include <fmt/format.h>

#include <atomic>
#include <mutex>
#include <thread>

#include "core/exr.h"
#include "core/scene/facts.h"
#include "core/scene/load.h"

namespace tessera::quality {
namespace {

constexpr std::uint64_t kTrialSeed = 1, kReferenceSeed = 0x5eed;
constexpr int kLargestTask = 64;  // samples: bounds what a cell's block holds before it is folded

// Renders [samples) of the whole frame on all processors, cell by cell.
void render_into(Film& film, const RenderScene& scene, const RenderSettings& settings, SampleRange samples) {
  const std::vector<Region> cells = grid_cells(film.region(), {kCellEdge, kCellEdge});
  std::atomic<std::size_t> next = 0;
  std::mutex folding;
  std::vector<std::jthread> team;
  for (unsigned t = 0; t < std::thread::hardware_concurrency(); ++t)
    team.emplace_back([&] {
      for (std::size_t i; (i = next++) < cells.size();)
        for (int begin = samples.begin; begin < samples.end; begin += kLargestTask) {
          Block block =
              render(scene, settings, 0, cells[i], {begin, std::min(samples.end, begin + kLargestTask)});
          const std::lock_guard lock(folding);
          film.fold(std::move(block));
        }
    });
}

void render_up_to(Film& film, const RenderScene& scene, const RenderSettings& settings, int samples) {
  for (int have = film.samples(film.region().x0, film.region().y0); have < samples;) {
    const int next = have == 0 ? 1 : 2 * have;
    render_into(film, scene, settings, {have, next});
    have = next;
  }
}

ExrImage file_of(const Reference& r) {
  ExrImage file;
  file.display = r.mean.region();
  std::vector<float> data(r.mean.data().begin(), r.mean.data().end());
  data.insert(data.end(), r.variance.data().begin(), r.variance.data().end());
  for (const char* layer : {"", "variance."})
    for (const char letter : std::string_view("RGB"))
      file.channels.push_back({std::string(layer) + letter, false});
  file.pixels = Image(file.display, 6, std::move(data));
  return file;
}

Image layer_of(const ExrImage& file, const std::string& layer) {
  Image image(file.pixels.region(), 3);
  for (int c = 0; c < 3; ++c)
    std::ranges::copy(file.pixels.plane(file.plane(layer + "RGB"[c])), image.plane(c).begin());
  return image;
}

}  // namespace

Trial::Trial(const std::filesystem::path& scene, Size size, AovSet aovs)
    : scene_(std::make_shared<const Scene>(load_scene(scene))),
      ready_(prepare(scene_)),
      frame_{0, 0, size.width, size.height},
      settings_{.size = size, .seed = kTrialSeed, .aovs = aovs},
      facts_(facts_of(*scene_)),
      film_(frame_, aovs) {}

void Trial::render_to(int samples) { render_up_to(film_, *ready_, settings_, samples); }

Image Trial::input(const FilterPlan& plan) const {
  return developed(film_.sums(), film_.layout(), plan.inputs(), Part::all);
}

Image Trial::noisy() const {
  return developed(film_.sums(), film_.layout(), channels_of(Aov::color), Part::all);
}

Reference reference_of(const Trial& trial, int samples, const std::filesystem::path& folder) {
  const Size size = trial.settings_.size;
  const auto file = folder / fmt::format("{}_{}x{}_{}.exr", content_hash(*trial.scene_).substr(0, 16),
                                         size.width, size.height, samples);
  if (std::filesystem::exists(file)) {
    const ExrImage there = read_exr(file);
    return {layer_of(there, ""), layer_of(there, "variance.")};
  }
  RenderSettings settings = trial.settings_;
  settings.seed = kReferenceSeed;
  settings.aovs = AovSet{Aov::color};
  Film film(trial.frame_, settings.aovs);
  render_up_to(film, *trial.ready_, settings, samples);
  const auto image = [&](Statistic s) {
    return developed(film.sums(), film.layout(), channels_of(Aov::color, s), Part::all);
  };
  Reference reference{image(Statistic::mean), image(Statistic::variance_of_mean)};
  std::filesystem::create_directories(folder);
  write_exr(file, file_of(reference));
  return reference;
}

}  // namespace tessera::quality

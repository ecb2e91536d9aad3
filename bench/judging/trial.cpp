// SPDX-License-Identifier: Apache-2.0
#include "bench/judging/trial.h"

#include <fmt/format.h>

#include <atomic>
#include <mutex>
#include <optional>
#include <thread>

#include "core/error.h"
#include "core/exr.h"
#include "core/scene/facts.h"
#include "core/scene/load.h"

namespace tessera::judging {
namespace {

constexpr std::uint64_t kTrialSeed = 1, kReferenceSeed = 0x5eed;
constexpr int kLargestTask = 64;  // samples: bounds what a cell's block holds before it is folded

// Renders [samples) of the whole frame on all processors, of small frames too: cell by cell, part by part.
void render_into(Film& film, const RenderScene& scene, const RenderSettings& settings, int number,
                 SampleRange samples) {
  const std::vector<Region> cells = grid_cells(film.region(), {kCellEdge, kCellEdge});
  const int parts = (samples.count() + kLargestTask - 1) / kLargestTask;
  std::atomic<int> next = 0;
  std::mutex folding;
  std::vector<std::jthread> team;
  for (unsigned t = 0; t < std::thread::hardware_concurrency(); ++t)
    team.emplace_back([&] {
      for (int i; (i = next++) < parts * static_cast<int>(cells.size());) {
        const int begin = samples.begin + i % parts * kLargestTask;
        Block block = render(scene, settings, number, cells[static_cast<std::size_t>(i / parts)],
                             {begin, std::min(samples.end, begin + kLargestTask)});
        const std::lock_guard lock(folding);
        film.fold(std::move(block));
      }
    });
}

void render_up_to(Film& film, const RenderScene& scene, const RenderSettings& settings, int number,
                  int samples) {
  for (int have = film.samples(film.region().x0, film.region().y0); have < samples;) {
    const int next = have == 0 ? 1 : 2 * have;
    render_into(film, scene, settings, number, {have, next});
    have = next;
  }
}

constexpr const char* kLayers[] = {"", "variance.", "a.", "b."};

ExrImage file_of(const Reference& r) {
  ExrImage file;
  file.display = r.mean.region();
  Floats data;
  for (const Image* image : {&r.mean, &r.variance, &r.a, &r.b})
    data.insert(data.end(), image->data().begin(), image->data().end());
  for (const char* layer : kLayers)
    for (const char letter : std::string_view("RGB"))
      file.channels.push_back({std::string(layer) + letter, ExrType::float32});
  file.pixels = Image(file.display, 3 * static_cast<int>(std::size(kLayers)), std::move(data));
  return file;
}

Image layer_of(const ExrImage& file, const std::string& layer) {
  Image image(file.pixels.region(), 3);
  for (int c = 0; c < 3; ++c)
    std::ranges::copy(file.pixels.plane(file.plane(layer + "RGB"[c])), image.plane(c).begin());
  return image;
}

// None if it is not there, or not whole: it is made again.
std::optional<Reference> reference_in(const std::filesystem::path& file, const Region& frame) {
  if (!std::filesystem::exists(file)) return std::nullopt;
  try {
    const ExrImage there = read_exr(file);
    if (there.pixels.region() != frame) return std::nullopt;
    return Reference{layer_of(there, kLayers[0]), layer_of(there, kLayers[1]), layer_of(there, kLayers[2]),
                     layer_of(there, kLayers[3])};
  } catch (const Error& e) {
    fmt::print(stderr, "{}; it is rendered again\n", e.what());
    return std::nullopt;
  }
}

}  // namespace

Trial::Trial(Scenery scenery, Size size, AovSet aovs, int number)
    : scenery_(std::move(scenery)),
      frame_{0, 0, size.width, size.height},
      number_(number),
      settings_{.size = size, .seed = kTrialSeed, .aovs = aovs},
      facts_(facts_of(*scenery_.scene)),
      film_(frame_, aovs) {
  facts_.frame = number;
}

void Trial::render_to(int samples) { render_up_to(film_, *scenery_.ready, settings_, number_, samples); }

Image Trial::input(const FilterPlan& plan) const {
  return developed(film_.sums(), film_.layout(), plan.inputs(), Part::all);
}

Image Trial::noisy() const {
  return developed(film_.sums(), film_.layout(), channels_of(Aov::color), Part::all);
}

AovSet aovs_for(const std::vector<std::string>& filters) {
  AovSet all{Aov::color};
  for (const std::string& text : filters) all = all | aovs_of(parse_filter(text).inputs());
  return all;
}

Shot::Shot(const std::filesystem::path& scene, Size size) : size_(size) {
  scenery_.scene = std::make_shared<const Scene>(load_scene(scene));
  scenery_.hash = content_hash(*scenery_.scene).substr(0, 16);
}

Trial Shot::trial(AovSet aovs, int number) {
  const std::string wanted = preparation(*scenery_.scene, {}, number);
  if (!scenery_.ready || wanted != prepared_) scenery_.ready = prepare(scenery_.scene, {}, number);
  prepared_ = wanted;
  return {scenery_, size_, aovs, number};
}

Reference reference_of(const Trial& trial, int samples, const std::filesystem::path& folder) {
  const Size size = trial.settings_.size;
  const int number = trial.scenery_.scene->tracks.empty() ? 0 : trial.number_;  // nothing moves: all are one
  const auto file = folder / fmt::format("{}_{:04}_{}x{}_{}.exr", trial.scenery_.hash, number, size.width,
                                         size.height, samples);
  if (auto there = reference_in(file, trial.frame_)) return *std::move(there);
  RenderSettings settings = trial.settings_;
  settings.seed = kReferenceSeed;
  settings.aovs = AovSet{Aov::color};
  Film film(trial.frame_, settings.aovs);
  render_up_to(film, *trial.scenery_.ready, settings, number, samples);
  const auto image = [&](Statistic s, Part part) {
    return developed(film.sums(), film.layout(), channels_of(Aov::color, s), part);
  };
  Reference reference{image(Statistic::mean, Part::all), image(Statistic::variance_of_mean, Part::all),
                      image(Statistic::mean, Part::a), image(Statistic::mean, Part::b)};
  std::filesystem::create_directories(folder);
  write_exr(file, file_of(reference));
  return reference;
}

}  // namespace tessera::judging

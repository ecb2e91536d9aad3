// SPDX-License-Identifier: Apache-2.0
#include "tests/core/quality/simulation.h"

#include <algorithm>
#include <cmath>

namespace tessera::simulation {
namespace {

constexpr int kBilateralRadius = 4;
constexpr int kAtrousLevels = 4;

float luminance(const Image& image, int x, int y) {
  return (image.at(0, x, y) + image.at(1, x, y) + image.at(2, x, y)) / 3;
}

float variance(const Image& half, int x, int y) {
  return (half.at(3, x, y) + half.at(4, x, y) + half.at(5, x, y)) / 9;
}

float albedo_distance(const Image& albedo, int x, int y, int u, int v) {
  float sum = 0;
  for (int c = 0; c < 3; ++c) sum += std::abs(albedo.at(c, x, y) - albedo.at(c, u, v));
  return sum;
}

// Variances smoothed over 3x3 pixels, plane 0.
Image smooth_variance(const Image& half) {
  const Region r = half.region();
  Image out(r, 1);
  for (int y = r.y0; y < r.y1; ++y)
    for (int x = r.x0; x < r.x1; ++x) {
      const Region window = intersect({x - 1, y - 1, x + 2, y + 2}, r);
      float sum = 0;
      for (int v = window.y0; v < window.y1; ++v)
        for (int u = window.x0; u < window.x1; ++u) sum += variance(half, u, v);
      out.at(0, x, y) = sum / static_cast<float>(window.area());
    }
  return out;
}

// One pass over a window of (2 radius + 1)^2 taps `step` apart; `sharpness` scales the tolerated difference.
void pass(Image& image, Image& var, const Image& albedo, int radius, int step, float tolerance) {
  const Region r = image.region();
  Image out(r, 3), out_var(r, 1);
  for (int y = r.y0; y < r.y1; ++y)
    for (int x = r.x0; x < r.x1; ++x) {
      const float here = luminance(image, x, y);
      const float scale = 1.0f / (tolerance * std::sqrt(var.at(0, x, y)) + 1e-3f);
      float total = 0, sum[3] = {}, sum_var = 0;
      for (int j = -radius; j <= radius; ++j)
        for (int i = -radius; i <= radius; ++i) {
          const int u = x + i * step, v = y + j * step;
          if (!r.contains(u, v)) continue;
          const float d = std::abs(luminance(image, u, v) - here) * scale;
          const float spread = static_cast<float>(i * i + j * j) / static_cast<float>(radius * radius);
          const float w = std::exp(-d - 10.0f * albedo_distance(albedo, x, y, u, v) - spread);
          total += w;
          for (int c = 0; c < 3; ++c) sum[c] += w * image.at(c, u, v);
          sum_var += w * w * var.at(0, u, v);
        }
      for (int c = 0; c < 3; ++c) out.at(c, x, y) = sum[c] / total;
      out_var.at(0, x, y) = sum_var / (total * total);
    }
  image = std::move(out);
  var = std::move(out_var);
}

}  // namespace

World make_world(Size size, unsigned seed, const Fireflies& fireflies) {
  const Region frame{0, 0, size.width, size.height};
  World world{Image(frame, 3), {}, Image(frame, 3), Image(frame, 1), fireflies};
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  const float phase = 6.28f * unit(random), lamp_x = unit(random), lamp_y = unit(random);
  const float disc_x = unit(random), disc_y = unit(random), stripes = 0.2f + unit(random);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const float s = (static_cast<float>(x) + 0.5f) / static_cast<float>(size.width);
      const float t = (static_cast<float>(y) + 0.5f) / static_cast<float>(size.height);
      const bool checker = ((x / 7) + (y / 11)) % 2 == 0 && s < 0.5f;
      const bool disc = std::hypot(s - disc_x, t - disc_y) < 0.2f;
      const float hidden = 1.0f + 0.4f * std::sin(stripes * static_cast<float>(x + y) + phase);
      const float shadow = 1.0f / (1.0f + std::exp(-12.0f * (s - t + 0.3f * std::sin(phase))));
      const float light = (0.02f + 1.2f * shadow) * (t > 0.5f ? hidden : 1.0f);
      const bool lamp = std::hypot(s - lamp_x, t - lamp_y) < 0.03f;
      const float base[3] = {checker ? 0.9f : 0.15f, disc ? 0.8f : 0.3f, 0.2f + 0.6f * s};
      for (int c = 0; c < 3; ++c) {
        world.albedo.at(c, x, y) = lamp ? 1.0f : base[c];
        world.truth.at(c, x, y) = lamp ? 20.0f : base[c] * light;
      }
      world.hit_rate.at(0, x, y) = lamp ? 1.0f : std::clamp(0.02f + 0.6f * shadow * t, 0.02f, 0.6f);
    }
  world.expected = world.truth;
  for (float& v : world.expected.data()) v += static_cast<float>(fireflies.rate * fireflies.value);
  return world;
}

Renderer::Renderer(World world, unsigned seed)
    : world_(std::move(world)),
      layout_({Aov::color}),
      sums_(world_.truth.region(), layout_.planes()),
      random_(seed) {}

void Renderer::render(const Region& region, int samples) {
  std::exponential_distribution<float> exponential(1.0f);
  std::uniform_real_distribution<double> unit(0, 1);
  const Fireflies& fireflies = world_.fireflies;
  for (int y = region.y0; y < region.y1; ++y)
    for (int x = region.x0; x < region.x1; ++x)
      for (const Half h : {Half::a, Half::b}) {
        const int n = samples / 2;
        const float rate = world_.hit_rate.at(0, x, y);
        double sum = 0, square = 0;  // of the hits, in units of truth / rate
        const int hits = rate >= 1.0f ? n : std::binomial_distribution<int>(n, rate)(random_);
        for (int i = 0; i < hits; ++i) {
          const double v = rate >= 1.0f ? 1.0 : exponential(random_);
          sum += v, square += v * v;
        }
        const double flash = fireflies.rate > 0 && unit(random_) < n * fireflies.rate ? fireflies.value : 0;
        sums_.at(FilmLayout::count(h), x, y) += static_cast<float>(n);
        sums_.at(FilmLayout::hits(h), x, y) += static_cast<float>(n);
        for (int c = 0; c < 3; ++c) {
          const double scale = world_.truth.at(c, x, y) / rate;
          sums_.at(layout_.sum(Aov::color, c, h), x, y) += static_cast<float>(sum * scale + flash);
          sums_.at(layout_.square(Aov::color, c, h), x, y) +=
              static_cast<float>(square * scale * scale + flash * flash);
        }
      }
}

Image half_of(const Image& sums, const FilmLayout& layout, Part part) {
  std::vector<Channel> channels = channels_of(Aov::color);
  for (const Channel& c : channels_of(Aov::color, Statistic::variance_of_mean)) channels.push_back(c);
  return developed(sums, layout, channels, part);
}

Image denoised(Denoiser denoiser, const Image& half, const Image& albedo) {
  Image image(half.region(), 3);
  for (int c = 0; c < 3; ++c) std::ranges::copy(half.plane(c), image.plane(c).begin());
  if (denoiser == Denoiser::none) return image;
  Image var = smooth_variance(half);
  if (denoiser == Denoiser::bilateral) pass(image, var, albedo, kBilateralRadius, 1, 2.0f);
  if (denoiser == Denoiser::atrous)
    for (int level = 0; level < kAtrousLevels; ++level) pass(image, var, albedo, 2, 1 << level, 4.0f);
  return image;
}

Look::Look(const Renderer& renderer, Denoiser denoiser)
    : a(half_of(renderer.sums(), renderer.layout(), Part::a)),
      b(half_of(renderer.sums(), renderer.layout(), Part::b)),
      x_a(denoised(denoiser, a, renderer.world().albedo)),
      x_b(denoised(denoiser, b, renderer.world().albedo)),
      y(x_a) {
  for (std::size_t i = 0; i < y.data().size(); ++i) y.data()[i] = 0.5f * (x_a.data()[i] + x_b.data()[i]);
}

double true_error(const Image& x, const Image& truth, const Region& region) {
  return rel_mse(cropped(x, region), cropped(truth, region));
}

namespace {

// Means of one half of the samples that came between two states of the film.
Image fresh_half(const Image& before, const Image& after, const FilmLayout& layout, Part part) {
  Image difference = after;
  for (std::size_t i = 0; i < difference.data().size(); ++i) difference.data()[i] -= before.data()[i];
  return developed(difference, layout, channels_of(Aov::color), part);
}

double oracle_samples(Size size, unsigned seed, Denoiser denoiser, const AcceptanceRule& rule,
                      const Fireflies& fireflies) {
  Renderer renderer(make_world(size, seed, fireflies), 5000 + seed);
  const Region frame = renderer.sums().region();
  const std::vector<Region> cells = grid_cells(frame, {kCellEdge, kCellEdge});
  std::vector<int> needed(cells.size(), 0);
  for (int n = rule.first_samples, have = 0; n <= rule.max_samples; n *= 2) {
    renderer.render(frame, n - have);
    have = n;
    const Look look(renderer, denoiser);
    for (std::size_t i = 0; i < cells.size(); ++i)
      if (needed[i] == 0 &&
          (n == rule.max_samples || true_error(look.y, renderer.world().expected, cells[i]) < *rule.relmse))
        needed[i] = n;
  }
  double sum = 0;
  for (int n : needed) sum += n;
  return sum;
}

// The looks at all cells. `delivered` and `before` are of the round before, empty at first.
std::vector<CellLook> looks_at(const Renderer& renderer, const Look& look, const std::vector<Region>& cells,
                               const std::vector<int>& have, const Image& delivered, const Image& before,
                               double target, RuleVariant variant) {
  std::vector<CellLook> looks;
  Image c1, c2;
  if (!before.empty()) {
    c1 = fresh_half(before, renderer.sums(), renderer.layout(), Part::a);
    c2 = fresh_half(before, renderer.sums(), renderer.layout(), Part::b);
  }
  for (std::size_t i = 0; i < cells.size(); ++i) {
    CellLook cell{have[i], {}, {}, Guard::none};
    const Image weight = relative_weight(look.y, cells[i]);
    cell.error = estimate_from_halves(look.halves(), weight, cells[i]);
    const bool fresh = !before.empty() && before.at(0, cells[i].x0, cells[i].y0) <
                                              renderer.sums().at(0, cells[i].x0, cells[i].y0);
    if (variant != RuleVariant::naive && fresh)
      cell.hold_out = estimate_from_hold_out(delivered, c1, c2, weight, cells[i]);
    if (variant == RuleVariant::naive) cell.error.standard_error = 0;
    if (variant == RuleVariant::full)
      cell.guard = guard_of(renderer.sums(), renderer.layout(), cells[i], target);
    looks.push_back(cell);
  }
  return looks;
}

}  // namespace

Outcome& Outcome::operator+=(const Outcome& o) {
  cells += o.cells, accepted += o.accepted;
  violations += o.violations, violations_of_y += o.violations_of_y, error += o.error;
  samples += o.samples, samples_alone += o.samples_alone, oracle_samples += o.oracle_samples;
  return *this;
}

Outcome run_rule(Size size, unsigned seed, Denoiser denoiser, double target, const Fireflies& fireflies,
                 RuleVariant variant) {
  const AcceptanceRule rule{.relmse = target, .first_samples = 16, .max_samples = 4096};
  Renderer renderer(make_world(size, seed, fireflies), 9000 + seed);
  const Region frame = renderer.sums().region();
  const std::vector<Region> cells = grid_cells(frame, {kCellEdge, kCellEdge});
  const int columns = (size.width + kCellEdge - 1) / kCellEdge;
  std::vector<std::int64_t> areas;
  for (const Region& cell : cells) areas.push_back(cell.area());
  std::vector<int> have(cells.size(), 0), want = first_round(rule, cells.size()), alone = want;
  std::vector<CellState> states;
  Image delivered, before;
  for (;;) {
    for (std::size_t i = 0; i < cells.size(); ++i)
      if (want[i] > have[i]) renderer.render(cells[i], want[i] - have[i]);
    have = want;
    const Look look(renderer, denoiser);
    const auto looks = looks_at(renderer, look, cells, have, delivered, before, target, variant);
    const Decision decision = decide(rule, columns, areas, states, looks, {});
    states = decision.cells;
    for (std::size_t i = 0; i < cells.size(); ++i)
      if (states[i].status == CellStatus::open) alone[i] = decision.want[i];
    delivered =
        denoised(denoiser, half_of(renderer.sums(), renderer.layout(), Part::all), renderer.world().albedo);
    before = renderer.sums();
    want = decision.want;
    if (!decision.stop) continue;
    Outcome outcome;
    outcome.oracle_samples = oracle_samples(size, seed, denoiser, rule, fireflies);
    for (std::size_t i = 0; i < cells.size(); ++i) {
      ++outcome.cells;
      outcome.samples += have[i];
      outcome.samples_alone += alone[i];
      if (states[i].status != CellStatus::accepted) continue;
      const double error = true_error(delivered, renderer.world().expected, cells[i]);
      ++outcome.accepted;
      outcome.error += error;
      outcome.violations += error > target;
      outcome.violations_of_y += true_error(look.y, renderer.world().expected, cells[i]) > target;
    }
    return outcome;
  }
}

}  // namespace tessera::simulation

// SPDX-License-Identifier: Apache-2.0
#include "proto/wire_values.h"

#include <cmath>
#include <cstring>

#include "proto/codec.h"

namespace tessera {
namespace {

constexpr int kMaxParameters = 64;

void to_wire(const Region& r, wire::Region& w) {
  w.set_x0(r.x0);
  w.set_y0(r.y0);
  w.set_x1(r.x1);
  w.set_y1(r.y1);
}

void to_wire(const Size& s, wire::Size& w) {
  w.set_width(s.width);
  w.set_height(s.height);
}

Size size_from(const wire::Size& w) { return {w.width(), w.height()}; }

RenderSettings render_from(const wire::RenderSettings& w) {
  require((w.aovs() & ~AovSet::all().bits()) == 0, "aovs", "unknown channel group");
  return {.size = size_from(w.size()),
          .seed = w.seed(),
          .max_bounces = w.max_bounces(),
          .sure_bounces = w.sure_bounces(),
          .camera = text_from(w.camera(), kMaxName, "camera"),
          .variant = text_from(w.variant(), kMaxName, "variant"),
          .clamp_direct = w.clamp_direct(),
          .clamp_indirect = w.clamp_indirect(),
          .regularise = w.regularise(),
          .aovs = AovSet::from_bits(w.aovs())};
}

void to_wire(const RenderSettings& s, wire::RenderSettings& w) {
  to_wire(s.size, *w.mutable_size());
  w.set_seed(s.seed);
  w.set_max_bounces(s.max_bounces);
  w.set_sure_bounces(s.sure_bounces);
  w.set_camera(s.camera);
  w.set_variant(s.variant);
  w.set_clamp_direct(s.clamp_direct);
  w.set_clamp_indirect(s.clamp_indirect);
  w.set_regularise(s.regularise);
  w.set_aovs(s.aovs.bits());
}

FilterPlan filter_from(const wire::FilterPlan& w) {
  FilterPlan plan{.name = text_from(w.name(), kMaxName, "filter"), .parameters = {}};
  require(w.parameters_size() <= kMaxParameters, "filter", "too many parameters");
  for (const wire::Parameter& p : w.parameters()) {
    require(std::isfinite(p.value()), "filter", "a parameter is not finite");
    const bool fresh = plan.parameters.emplace(text_from(p.name(), kMaxName, "filter"), p.value()).second;
    require(fresh, "filter", "a parameter is given twice");
  }
  return plan;
}

AcceptanceRule acceptance_from(const wire::AcceptanceRule& w) {
  AcceptanceRule rule{.first_samples = w.first_samples(), .max_samples = w.max_samples()};
  if (w.has_relmse()) rule.relmse = w.relmse();
  if (w.has_max_seconds()) rule.max_seconds = w.max_seconds();
  return rule;
}

}  // namespace

void require(bool good, std::string_view field, std::string_view what) {
  if (!good) throw ProtocolError(field, what);
}

void to_wire(const SampleRange& s, wire::SampleRange& w) {
  w.set_begin(s.begin);
  w.set_end(s.end);
}

void to_wire(const RenderTask& t, wire::RenderTask& w) {
  to_wire(t.region, *w.mutable_region());
  to_wire(t.samples, *w.mutable_samples());
}

void to_wire(const FilterTask& t, wire::FilterTask& w) {
  to_wire(t.tile.inner, *w.mutable_inner());
  to_wire(t.tile.outer, *w.mutable_outer());
  w.set_round(t.round);
}

void to_wire(const Job& job, wire::Job& w) {
  w.mutable_scene()->set_path(job.scene.path);
  w.mutable_scene()->set_hash(job.scene.hash);
  w.mutable_scene()->set_bundle(job.scene.bundle);
  to_wire(job.render, *w.mutable_render());
  w.set_frame(job.frame);
  if (job.crop) to_wire(*job.crop, *w.mutable_crop());
  w.mutable_filter()->set_name(job.filter.name);
  for (const auto& [name, value] : job.filter.parameters) {
    wire::Parameter& p = *w.mutable_filter()->add_parameters();
    p.set_name(name);
    p.set_value(value);
  }
  wire::AcceptanceRule& rule = *w.mutable_acceptance();
  if (job.acceptance.relmse) rule.set_relmse(*job.acceptance.relmse);
  rule.set_first_samples(job.acceptance.first_samples);
  rule.set_max_samples(job.acceptance.max_samples);
  if (job.acceptance.max_seconds) rule.set_max_seconds(*job.acceptance.max_seconds);
  to_wire(job.tile, *w.mutable_tile());
  w.set_task_samples(job.task_samples);
  if (!job.given) return;
  w.mutable_given()->set_planes(job.given->planes);
  to_wire(job.given->display, *w.mutable_given()->mutable_display());
  w.mutable_given()->set_goes_on(job.given->goes_on);
}

void shape_to_wire(const Image& image, wire::Planes& w) {
  to_wire(image.region(), *w.mutable_region());
  w.set_planes(image.planes());
}

void to_wire(Image&& image, wire::Planes& w, Floats& pixels) {
  shape_to_wire(image, w);
  Floats more = std::move(image).release();
  if (pixels.empty())
    pixels = std::move(more);
  else
    pixels.insert(pixels.end(), more.begin(), more.end());
}

std::string text_from(const std::string& text, std::size_t most, std::string_view field) {
  require(text.size() <= most, field, "too long");
  return text;
}

int whole_from(std::int64_t value, int low, int high, std::string_view field) {
  require(value >= low && value <= high, field, "out of range");
  return static_cast<int>(value);
}

double seconds_from(double seconds, std::string_view field) {
  require(std::isfinite(seconds) && seconds >= 0, field, "is not a time");
  return seconds;
}

Region region_from(const wire::Region& w, std::string_view field) {
  const Region r{w.x0(), w.y0(), w.x1(), w.y1()};
  require(is_window(r), field, "is not a region of 1 to 65536 pixels an edge");
  return r;
}

SampleRange samples_from(const wire::SampleRange& w, std::string_view field) {
  require(0 <= w.begin() && w.begin() < w.end() && w.end() <= kMaxSamples, field, "out of range");
  const SampleRange samples{w.begin(), w.end()};
  require(is_dyadic(samples), field, "is not a dyadic range of at least 8 samples");
  return samples;
}

RenderTask task_from(const wire::RenderTask& w) {
  const Region region = region_from(w.region(), "region");
  require(Region{0, 0, kMaxEdge, kMaxEdge}.contains(region), "region", "is not inside 0 to 65536");
  return {region, samples_from(w.samples(), "samples")};
}

FilterTask task_from(const wire::FilterTask& w) {
  const Tile tile{region_from(w.inner(), "inner"), region_from(w.outer(), "outer")};
  require(tile.outer.contains(tile.inner), "outer", "does not contain inner");
  return {tile, whole_from(w.round(), 0, 1 << 20, "round")};
}

Job job_from(const wire::Job& w) {
  require(w.scene().bundle().empty() || is_digest(w.scene().bundle()), "bundle", "is no digest");
  Job job{.scene = {text_from(w.scene().path(), kMaxText, "path"),
                    text_from(w.scene().hash(), kMaxName, "hash"), w.scene().bundle()},
          .render = render_from(w.render()),
          .frame = w.frame(),
          .crop = {},
          .given = {},
          .filter = filter_from(w.filter()),
          .acceptance = acceptance_from(w.acceptance()),
          .tile = size_from(w.tile()),
          .task_samples = w.task_samples()};
  if (w.has_crop()) job.crop = region_from(w.crop(), "crop");
  if (w.has_given())
    job.given = {w.given().planes(), region_from(w.given().display(), "display"), w.given().goes_on()};
  try {
    validate(job);
  } catch (const Error& error) {
    throw ProtocolError("job", error.what());
  }
  return job;
}

std::size_t bytes_of(const wire::Planes& w, std::string_view field) {
  const Region region = region_from(w.region(), field);
  const auto planes = static_cast<std::uint64_t>(whole_from(w.planes(), 1, kMaxPlanes, field));
  const std::uint64_t bytes = static_cast<std::uint64_t>(region.area()) * planes * sizeof(float);
  require(bytes <= kMaxPixelBytes, field, "its pixels have the wrong size");
  return bytes;
}

Image image_from(const wire::Planes& w, std::span<const std::byte> bytes, std::string_view field) {
  require(bytes.size() == bytes_of(w, field), field, "its pixels have the wrong size");
  Floats data(bytes.size() / sizeof(float));
  std::memcpy(data.data(), bytes.data(), bytes.size());
  return Image(region_from(w.region(), field), w.planes(), std::move(data));
}

}  // namespace tessera

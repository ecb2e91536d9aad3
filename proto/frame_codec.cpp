// SPDX-License-Identifier: Apache-2.0
#include "proto/frame_codec.h"

#include <algorithm>

#include "proto/codec.h"
#include "proto/store.pb.h"
#include "proto/wire_values.h"

namespace tessera {
namespace {

constexpr int kMaxRound = 1 << 20, kMaxLooks = 1 << 16, kMaxClasses = 1 << 16;

// --- To Protobuf. ---

void to_wire(const ErrorEstimate& e, wire::Estimate& w) {
  w.set_mean(e.mean);
  w.set_standard_error(e.standard_error);
}

void to_wire(const CellLook& look, const CellState& state, wire::KeptCell& w) {
  w.set_look_samples(look.samples);
  to_wire(look.error, *w.mutable_look_error());
  if (look.hold_out) to_wire(*look.hold_out, *w.mutable_hold_out());
  w.set_look_guard(static_cast<std::uint32_t>(look.guard));
  w.set_status(static_cast<std::uint32_t>(state.status));
  w.set_samples(state.samples);
  w.set_good_looks(state.good_looks);
  to_wire(state.error, *w.mutable_error());
  w.set_guard(static_cast<std::uint32_t>(state.guard));
}

struct EventEncoder {
  const Image& pixels;
  wire::KeptEvent& out;

  void operator()(const Accepted& a) {
    wire::KeptResult& w = *out.mutable_accepted();
    if (const auto* render = std::get_if<RenderTask>(&a.work)) to_wire(*render, *w.mutable_render());
    if (const auto* filter = std::get_if<FilterTask>(&a.work)) to_wire(*filter, *w.mutable_filter());
    w.set_round(a.round);
    w.set_digest(a.digest);
    w.set_worker(a.worker);
    w.set_device_class(a.device_class);
    w.set_seconds(a.seconds);
    w.set_dropped(a.dropped);
    if (!pixels.empty()) shape_to_wire(pixels, *w.mutable_pixels());
  }
  void operator()(const Remembered& r) { out.set_remembered(r.history); }
  void operator()(const Looked& l) { out.set_looked(l.seconds); }
};

// --- From Protobuf. ---

template <class Message>
Message parsed(std::string_view header) {
  Message message;
  require(header.size() < (std::size_t{1} << 31) &&
              message.ParseFromArray(header.data(), static_cast<int>(header.size())),
          "header", "is not what is kept");
  return message;
}

// The image that `w` speaks of; its bytes are taken from `left`.
Image blank_image(const wire::Planes& w, std::uint64_t& left, std::string_view field) {
  const Region region = region_from(w.region(), field);
  const int planes = whole_from(w.planes(), 1, kMaxPlanes, field);
  const std::uint64_t bytes = static_cast<std::uint64_t>(region.area()) * planes * sizeof(float);
  require(bytes <= left, field, "its pixels are missing");
  left -= bytes;
  return Image::unset(region, planes);
}

Digest digest_from(const std::string& text, std::string_view field) {
  require(is_digest(text), field, "is not a digest");
  return text;
}

template <class Enum>
Enum enum_from(std::uint32_t value, Enum last, std::string_view field) {
  require(value <= static_cast<std::uint32_t>(last), field, "out of range");
  return static_cast<Enum>(value);
}

ErrorEstimate estimate_from(const wire::Estimate& w) { return {w.mean(), w.standard_error()}; }

CellLook look_from(const wire::KeptCell& w) {
  CellLook look{.samples = whole_from(w.look_samples(), 0, kMaxSamples, "look_samples"),
                .error = estimate_from(w.look_error()),
                .hold_out = {},
                .guard = enum_from(w.look_guard(), Guard::too_dark, "look_guard")};
  if (w.has_hold_out()) look.hold_out = estimate_from(w.hold_out());
  return look;
}

CellState state_from(const wire::KeptCell& w) {
  return {.status = enum_from(w.status(), CellStatus::exhausted, "status"),
          .samples = whole_from(w.samples(), 0, kMaxSamples, "samples"),
          .good_looks = whole_from(w.good_looks(), 0, kMaxLooks, "good_looks"),
          .error = estimate_from(w.error()),
          .guard = enum_from(w.guard(), Guard::too_dark, "guard")};
}

Accepted accepted_from(const wire::KeptResult& w) {
  Accepted a{.work = {},
             .round = whole_from(w.round(), 1, kMaxRound, "round"),
             .digest = digest_from(w.digest(), "digest"),
             .worker = w.worker(),
             .device_class = text_from(w.device_class(), kMaxName, "device_class"),
             .seconds = seconds_from(w.seconds(), "seconds"),
             .dropped = w.dropped()};
  require(is_worker_id(a.worker), "worker", "is not the name of a worker");
  require(w.work_case() != wire::KeptResult::WORK_NOT_SET, "work", "is neither render nor filter");
  if (w.work_case() == wire::KeptResult::kRender)
    a.work = task_from(w.render());
  else
    a.work = task_from(w.filter());
  return a;
}

FrameEvent event_from(const wire::KeptEvent& w) {
  switch (w.kind_case()) {
    case wire::KeptEvent::kAccepted:
      return accepted_from(w.accepted());
    case wire::KeptEvent::kRemembered:
      require(w.remembered().empty() || is_digest(w.remembered()), "remembered", "is not a digest");
      return Remembered{w.remembered()};
    case wire::KeptEvent::kLooked:
      return Looked{seconds_from(w.looked(), "looked")};
    default:
      throw ProtocolError("kind", "no such event");
  }
}

FrameSnapshot snapshot_from(const wire::KeptCheckpoint& w, std::uint64_t& left) {
  FrameSnapshot s;
  s.round = whole_from(w.round(), 1, kMaxRound, "round");
  for (const wire::KeptCell& cell : w.cells()) {
    s.have.push_back(whole_from(cell.have(), 0, kMaxSamples, "have"));
    s.want.push_back(whole_from(cell.want(), 0, kMaxSamples, "want"));
    if (s.round == 1) continue;
    s.looks.push_back(look_from(cell));
    s.states.push_back(state_from(cell));
  }
  s.error = estimate_from(w.error());
  s.acceptable_share = w.acceptable_share();
  require(s.acceptable_share >= 0 && s.acceptable_share <= 1, "acceptable_share", "out of range");
  if (w.has_sums()) s.sums = blank_image(w.sums(), left, "sums");
  if (w.has_stitched()) s.stitched = blank_image(w.stitched(), left, "stitched");
  return s;
}

}  // namespace

std::string header_of(const FrameEvent& event, const Image& pixels) {
  wire::KeptEvent w;
  std::visit(EventEncoder{pixels, w}, event);
  return w.SerializeAsString();
}

FrameEvent event_of(std::string_view header) { return event_from(parsed<wire::KeptEvent>(header)); }

LoggedEvent event_from(std::string_view header, std::uint64_t plane_bytes) {
  const auto w = parsed<wire::KeptEvent>(header);
  LoggedEvent logged{event_from(w), {}};
  if (w.accepted().has_pixels()) logged.pixels = blank_image(w.accepted().pixels(), plane_bytes, "pixels");
  require(plane_bytes == 0, "pixels", "too many");
  return logged;
}

std::string header_of(const Checkpoint& checkpoint) {
  const FrameSnapshot& s = checkpoint.frame;
  wire::KeptCheckpoint w;
  w.set_round(s.round);
  for (std::size_t c = 0; c < s.have.size(); ++c) {
    wire::KeptCell& cell = *w.add_cells();
    cell.set_have(s.have[c]);
    cell.set_want(s.want[c]);
    if (!s.looks.empty()) to_wire(s.looks[c], s.states[c], cell);
  }
  to_wire(s.error, *w.mutable_error());
  w.set_acceptable_share(s.acceptable_share);
  if (!s.sums.empty()) shape_to_wire(s.sums, *w.mutable_sums());
  if (!s.stitched.empty()) shape_to_wire(s.stitched, *w.mutable_stitched());
  w.set_seconds(checkpoint.seconds);
  w.set_dropped(checkpoint.dropped);
  for (const std::string& device : checkpoint.device_classes) w.add_device_classes(device);
  for (const float error : checkpoint.errors) w.add_errors(error);
  return w.SerializeAsString();
}

Checkpoint checkpoint_from(std::string_view header, std::uint64_t plane_bytes) {
  const auto w = parsed<wire::KeptCheckpoint>(header);
  require(w.device_classes_size() <= kMaxClasses && w.errors_size() <= kMaxLooks, "device_classes",
          "too many");
  Checkpoint c;
  c.frame = snapshot_from(w, plane_bytes);
  c.seconds = seconds_from(w.seconds(), "seconds");
  c.dropped = w.dropped();
  for (const std::string& device : w.device_classes())
    c.device_classes.insert(text_from(device, kMaxName, "device_classes"));
  c.errors.assign(w.errors().begin(), w.errors().end());
  require(plane_bytes == 0, "pixels", "too many");
  return c;
}

std::string header_of(const Image& image) {
  wire::Planes w;
  shape_to_wire(image, w);
  return w.SerializeAsString();
}

Image image_from(std::string_view header, std::uint64_t plane_bytes) {
  Image image = blank_image(parsed<wire::Planes>(header), plane_bytes, "image");
  require(plane_bytes == 0, "pixels", "too many");
  return image;
}

}  // namespace tessera

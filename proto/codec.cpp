// SPDX-License-Identifier: Apache-2.0
#include "proto/codec.h"

#include <algorithm>
#include <array>
#include <bit>

#include "proto/wire_answers.h"
#include "proto/wire_questions.h"
#include "proto/wire_values.h"

namespace tessera {
namespace {

static_assert(std::endian::native == std::endian::little, "pixels travel as they lie in memory");

using Parts = std::span<const std::span<const std::byte>>;

// Each overload writes one message and moves its pixels out.
struct Encoder {
  wire::Envelope& out;
  Floats& pixels;

  void operator()(Hello& m) {
    wire::Hello& w = *out.mutable_hello();
    w.set_protocol(m.protocol);
    w.set_version(std::move(m.version));
    w.set_device_class(std::move(m.device_class));
    w.set_slots(m.slots);
    w.set_name(std::move(m.name));
  }
  void operator()(Heartbeat& m) {
    wire::Heartbeat& w = *out.mutable_heartbeat();
    for (const Held& h : m.held) {
      wire::Held& held = *w.add_held();
      held.set_task(h.task);
      held.set_attempt(h.attempt);
    }
  }
  void operator()(RenderDone& m) {
    wire::RenderDone& w = *out.mutable_render_done();
    w.set_task(m.task);
    w.set_attempt(m.attempt);
    to_wire(m.block.samples, *w.mutable_samples());
    to_wire(std::move(m.block.sums), *w.mutable_sums(), pixels);
    w.set_seconds(m.seconds);
    w.set_dropped(m.dropped);
  }
  void operator()(FilterDone& m) {
    wire::FilterDone& w = *out.mutable_filter_done();
    w.set_task(m.task);
    w.set_attempt(m.attempt);
    to_wire(std::move(m.filtered), *w.mutable_filtered(), pixels);
    w.set_seconds(m.seconds);
  }
  void operator()(TaskFailed& m) {
    wire::TaskFailed& w = *out.mutable_task_failed();
    w.set_task(m.task);
    w.set_attempt(m.attempt);
    w.set_reason(m.reason.substr(0, kMaxText));
    w.set_bad_input(m.bad_input);
  }
  void operator()(Goodbye&) { out.mutable_goodbye(); }
  void operator()(NeedJob& m) { out.mutable_need_job()->set_id(m.id); }
  void operator()(Welcome& m) {
    wire::Welcome& w = *out.mutable_welcome();
    w.set_protocol(m.protocol);
    w.set_heartbeat_ms(m.heartbeat.count());
    w.set_idle_heartbeat_ms(m.idle_heartbeat.count());
  }
  void operator()(Refused& m) { out.mutable_refused()->set_reason(m.reason.substr(0, kMaxText)); }
  void operator()(JobOffer& m) {
    wire::JobOffer& w = *out.mutable_job_offer();
    w.set_id(m.id);
    to_wire(m.job, *w.mutable_job());
  }
  void operator()(Assign& m) {
    wire::Assign& w = *out.mutable_assign();
    w.set_task(m.task.id);
    w.set_job(m.task.job);
    w.set_attempt(m.attempt);
    if (const auto* render = std::get_if<RenderTask>(&m.task.work)) to_wire(*render, *w.mutable_render());
    if (const auto* filter = std::get_if<FilterTask>(&m.task.work)) to_wire(*filter, *w.mutable_filter());
    if (!m.input.film.empty()) to_wire(std::move(m.input.film), *w.mutable_input(), pixels);
    if (!m.input.history.empty()) to_wire(std::move(m.input.history), *w.mutable_history(), pixels);
  }
  void operator()(Revoke& m) {
    wire::Revoke& w = *out.mutable_revoke();
    w.set_task(m.task);
    w.set_attempt(m.attempt);
  }
  void operator()(JobOver& m) { out.mutable_job_over()->set_id(m.id); }
  void operator()(Unknown&) { out.mutable_unknown(); }
  void operator()(Ask& m) { to_wire(std::move(m), *out.mutable_ask()); }
  void operator()(Answer& m) { to_wire(std::move(m), *out.mutable_answer()); }
};

void require_no_pixels(Parts parts) { require(parts.size() == 1, "pixels", "a part too many"); }

Image pixels_of(const wire::Planes& planes, Parts parts, std::string_view field) {
  require(parts.size() == 2, field, "its pixels are missing");
  return image_from(planes, parts[1], field);
}

Message hello(const wire::Hello& w) {
  return Hello{.protocol = w.protocol(),
               .version = text_from(w.version(), kMaxName, "version"),
               .device_class = text_from(w.device_class(), kMaxName, "device_class"),
               .slots = whole_from(w.slots(), 1, kMaxSlots, "slots"),
               .name = text_from(w.name(), kMaxName, "name")};
}

Message heartbeat(const wire::Heartbeat& w) {
  require(w.held_size() <= kMaxHeld, "held", "too many entries");
  Heartbeat m;
  m.held.reserve(w.held_size());
  for (const wire::Held& h : w.held()) m.held.push_back({h.task(), h.attempt()});
  return m;
}

Message render_done(const wire::RenderDone& w, Parts parts) {
  RenderDone m{.task = w.task(), .attempt = w.attempt(), .block = {}};
  m.block.samples = samples_from(w.samples(), "samples");
  m.seconds = seconds_from(w.seconds(), "seconds");
  m.dropped = w.dropped();
  m.block.sums = pixels_of(w.sums(), parts, "sums");
  return m;
}

Message filter_done(const wire::FilterDone& w, Parts parts) {
  FilterDone m{.task = w.task(), .attempt = w.attempt(), .filtered = {}};
  m.seconds = seconds_from(w.seconds(), "seconds");
  require(w.filtered().planes() >= 3, "filtered", "has not as many planes as a filter returns");
  m.filtered = pixels_of(w.filtered(), parts, "filtered");
  return m;
}

Message task_failed(const wire::TaskFailed& w) {
  return TaskFailed{w.task(), w.attempt(), text_from(w.reason(), kMaxText, "reason"), w.bad_input()};
}

Message welcome(const wire::Welcome& w) {
  constexpr int hour = 3600 * 1000;
  const auto heartbeat = whole_from(w.heartbeat_ms(), 1, hour, "heartbeat_ms");
  const auto idle = w.idle_heartbeat_ms() == 0 ? heartbeat : w.idle_heartbeat_ms();
  return Welcome{w.protocol(), Millis(heartbeat),
                 Millis(whole_from(idle, heartbeat, hour, "idle_heartbeat_ms"))};
}

// The film's pixels, and behind them those of the history.
FilterInput input_of(const wire::Assign& w, Parts parts) {
  if (!w.has_history()) return {pixels_of(w.input(), parts, "input"), {}};
  require(parts.size() == 2, "input", "its pixels are missing");
  const std::size_t history = bytes_of(w.history(), "history");
  require(history <= parts[1].size(), "history", "its pixels are missing");
  const auto film = parts[1].first(parts[1].size() - history);
  return {image_from(w.input(), film, "input"), image_from(w.history(), parts[1].last(history), "history")};
}

Message assign(const wire::Assign& w, Parts parts) {
  Assign m{.task = {w.task(), w.job(), {}}, .attempt = w.attempt(), .input = {}};
  if (w.work_case() == wire::Assign::kFilter) {
    const FilterTask task = task_from(w.filter());
    m.task.work = task;
    m.input = input_of(w, parts);
    require(m.input.film.region() == task.tile.outer, "input", "does not cover the tile's outer region");
    return m;
  }
  require(w.work_case() == wire::Assign::kRender, "work", "is neither render nor filter");
  require(!w.has_input() && !w.has_history(), "input", "a render task takes none");
  require_no_pixels(parts);
  m.task.work = task_from(w.render());
  return m;
}

Message without_pixels(wire::Envelope& e) {
  switch (e.kind_case()) {
    case wire::Envelope::kHello:
      return hello(e.hello());
    case wire::Envelope::kHeartbeat:
      return heartbeat(e.heartbeat());
    case wire::Envelope::kTaskFailed:
      return task_failed(e.task_failed());
    case wire::Envelope::kGoodbye:
      return Goodbye{};
    case wire::Envelope::kNeedJob:
      return NeedJob{e.need_job().id()};
    case wire::Envelope::kWelcome:
      return welcome(e.welcome());
    case wire::Envelope::kRefused:
      return Refused{text_from(e.refused().reason(), kMaxText, "reason")};
    case wire::Envelope::kJobOffer:
      return JobOffer{e.job_offer().id(), job_from(e.job_offer().job())};
    case wire::Envelope::kRevoke:
      return Revoke{e.revoke().task(), e.revoke().attempt()};
    case wire::Envelope::kJobOver:
      return JobOver{e.job_over().id()};
    case wire::Envelope::kUnknown:
      return Unknown{};
    case wire::Envelope::kAsk:
      return ask_from(*e.mutable_ask());
    case wire::Envelope::kAnswer:
      return answer_from(*e.mutable_answer());
    default:
      throw ProtocolError("kind", "no such message");
  }
}

}  // namespace

Packet encode(Message message) {
  Packet packet;
  wire::Envelope envelope;
  std::visit(Encoder{envelope, packet.pixels}, message);
  envelope.SerializeToString(&packet.header);
  return packet;
}

std::span<const std::byte> bytes_of(const Floats& pixels) { return std::as_bytes(std::span(pixels)); }

Message decode(Parts parts) {
  require(!parts.empty() && parts.size() <= kMaxParts, "parts", "neither one nor two");
  require(parts[0].size() <= kMaxHeaderBytes, "header", "too long");
  wire::Envelope envelope;
  require(envelope.ParseFromArray(parts[0].data(), static_cast<int>(parts[0].size())), "header",
          "is not a message");
  switch (envelope.kind_case()) {
    case wire::Envelope::kRenderDone:
      return render_done(envelope.render_done(), parts);
    case wire::Envelope::kFilterDone:
      return filter_done(envelope.filter_done(), parts);
    case wire::Envelope::kAssign:
      return assign(envelope.assign(), parts);
    default:
      require_no_pixels(parts);
      return without_pixels(envelope);
  }
}

Message decode(const Packet& packet) {
  const std::array<std::span<const std::byte>, 2> parts{std::as_bytes(std::span(packet.header)),
                                                        bytes_of(packet.pixels)};
  return decode(std::span(parts).first(packet.pixels.empty() ? 1 : 2));
}

namespace {

bool is_word(std::string_view text, std::size_t longest) {
  return !text.empty() && text.size() <= longest &&
         std::ranges::all_of(text, [](char c) { return c > ' ' && c < 0x7f; });
}

}  // namespace

bool is_worker_id(std::string_view id) { return is_word(id, kMaxWorkerId); }
bool is_peer(std::string_view peer) { return is_word(peer, kMaxKeyName + 1 + kMaxWorkerId); }

}  // namespace tessera

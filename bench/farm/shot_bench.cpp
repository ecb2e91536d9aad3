// SPDX-License-Identifier: Apache-2.0
// What a farm makes of a shot whose filter goes by the frame before: the time on two workers of one slot each
// against one such worker, whether the frames are the same, what travels, and how much of it is history
// beside what the tiles' pixels were seen by.
//   shot_bench [scene file, or a name of scenes/shots.h [FRAMES [SAMPLES [FILTER [WxH [TILE]]]]]]
#include <fmt/format.h>

#include <chrono>
#include <ctime>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "cli/version.h"
#include "coordinator/coordinator.h"
#include "core/error.h"
#include "core/plan.h"
#include "core/scene/load.h"
#include "proto/zmq_transport.h"
#include "scenes/shots.h"
#include "worker/denoise/device.h"
#include "worker/task_runner.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

// Bytes of pixels that went over a road.
struct Load {
  std::uint64_t films = 0;       // to filter tasks
  std::uint64_t histories = 0;   // beside them
  std::uint64_t footprints = 0;  // of those histories: what their tiles' pixels may take from
  std::uint64_t blocks = 0;      // from render tasks
  std::uint64_t filtered = 0;    // from filter tasks, with what is kept for the next frame
  std::uint64_t all() const { return films + histories + blocks + filtered; }
};

std::uint64_t bytes(const Image& image) { return sizeof(float) * image.data().size(); }

// A road on which what passes is weighed.
class Weighed : public Transport {
 public:
  Weighed(Transport& road, const Job& job) : road_(road), job_(job), layout_(filter_aovs(job)) {}

  void send(const Peer& to, Message message) override {
    if (const Assign* assign = std::get_if<Assign>(&message)) {
      load_.films += bytes(assign->input.film);
      load_.histories += bytes(assign->input.history);
      if (!assign->input.history.empty()) load_.footprints += footprint_of(*assign);
    }
    road_.send(to, std::move(message));
  }
  std::optional<Mail> receive(Instant until) override {
    std::optional<Mail> mail = road_.receive(until);
    if (!mail) return mail;
    if (const RenderDone* done = std::get_if<RenderDone>(&mail->message))
      load_.blocks += bytes(done->block.sums);
    if (const FilterDone* done = std::get_if<FilterDone>(&mail->message))
      load_.filtered += bytes(done->filtered);
    return mail;
  }
  void wake() override { road_.wake(); }
  const Load& load() const { return load_; }

 private:
  std::uint64_t footprint_of(const Assign& assign) const {
    const Image motion = developed(assign.input.film, layout_, channels_of(Aov::motion), Part::all);
    const Region seen = footprint(motion, motion.region(), job_.region());
    return sizeof(float) * static_cast<std::uint64_t>(seen.area()) *
           static_cast<std::uint64_t>(history_planes(job_.filter));
  }

  Transport& road_;
  Job job_;
  FilmLayout layout_;
  Load load_;
};

struct Outcome {
  double seconds = 0, processor = 0;  // processor: seconds of all threads
  Load load;
  std::vector<Image> frames;
};

// The shot on `workers` of one slot each, all over inproc.
Outcome run_shot(const std::shared_ptr<const Scene>& scene, const Shot& shot, int workers) {
  constexpr const char* kEndpoint = "inproc://farm";
  ZmqContext context;
  ZmqRouter router(context, {kEndpoint});
  Weighed road(router, shot.frames.front());
  Coordinator coordinator(road, {});
  struct Hand {
    std::unique_ptr<TaskRunner> runner;
    std::unique_ptr<ZmqDealer> dealer;
    std::unique_ptr<Worker> worker;
    std::jthread thread;
    ~Hand() {
      if (worker) worker->stop();
    }
  };
  std::vector<Hand> hands(static_cast<std::size_t>(workers));
  for (std::size_t i = 0; i < hands.size(); ++i) {
    Hand& hand = hands[i];
    DevicePool devices = DevicePool::open({});
    const std::string version(kVersion), device_class_here = device_class(version, devices.infos());
    hand.runner = make_task_runner(scene_in_hand(scene), std::move(devices));
    hand.dealer = std::make_unique<ZmqDealer>(context, kEndpoint, fmt::format("worker{}", i));
    hand.worker = std::make_unique<Worker>(
        AgentOptions{.slots = 1, .version = version, .device_class = device_class_here}, *hand.dealer,
        *hand.runner);
    hand.thread = std::jthread([&hand] { hand.worker->run(); });
  }
  Outcome outcome;
  outcome.frames.resize(shot.frames.size());
  JobWatcher watcher;
  watcher.finished = [&](std::size_t frame, const JobReport& report) {
    if (report.failure) throw Error(ExitCode::internal_error, *report.failure);
    outcome.frames[frame] = report.image.filtered;
  };
  const auto begin = std::chrono::steady_clock::now();
  const std::clock_t processor = std::clock();
  coordinator.run(shot, watcher);
  outcome.processor = static_cast<double>(std::clock() - processor) / CLOCKS_PER_SEC;
  outcome.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  outcome.load = road.load();
  return outcome;
}

struct Options {
  std::string scene = "light";
  int frames = 24, samples = 32;
  std::string filter = "svgf:history=on";
  Size size{480, 270};
  int tile = 256;
};

fs::path file_of(const std::string& scene) {
  if (std::ranges::find(scenes::kShots, scene) == std::end(scenes::kShots)) return scene;
  const fs::path folder = "out/shots";
  scenes::write_shots(folder);
  return folder / (scene + ".json");
}

int run(const Options& o) {
  const auto scene = std::make_shared<const Scene>(load_scene(file_of(o.scene)));
  Shot shot;
  for (int frame = 0; frame < o.frames; ++frame) {
    Job job;
    job.scene.hash = content_hash(*scene);
    job.render.size = o.size;
    job.frame = frame;
    job.filter = parse_filter(o.filter);
    job.tile = {o.tile, o.tile};
    job.acceptance.first_samples = std::min(job.acceptance.first_samples, o.samples);
    job.acceptance.max_samples = o.samples;
    shot.frames.push_back(job);
  }
  fmt::print("{} {}x{}, {} frames of {} samples, {}, tiles of {}\n", o.scene, o.size.width, o.size.height,
             o.frames, o.samples, o.filter, o.tile);
  Shot few = shot;
  few.frames.resize(2);
  run_shot(scene, few, 1);  // builds kernels, warms caches
  const Outcome one = run_shot(scene, shot, 1), two = run_shot(scene, shot, 2);
  bool same = true;
  for (std::size_t i = 0; i < one.frames.size(); ++i) same &= same_bits(one.frames[i], two.frames[i]);
  constexpr double kMega = 1e-6;
  const double frames = o.frames;
  const auto each = [&](std::uint64_t n) { return kMega * static_cast<double>(n) / frames; };
  // Two workers that get no more of the machine than one does, since others want it, tell nothing.
  const auto tell = [](const char* who, const Outcome& x) {
    fmt::print("{:<20} {:8.3f} s   on {:.2f} cores\n", who, x.seconds, x.processor / x.seconds);
  };
  tell("1 worker, 1 slot", one);
  tell("2 workers, 1 slot", two);
  fmt::print("ratio                {:8.3f}   goal: at least 1.8\nsame bits: {}\n", one.seconds / two.seconds,
             same ? "yes" : "NO");
  const Load& l = two.load;
  fmt::print(
      "MB a frame           {:8.3f}   films to filter {:.3f}, histories {:.3f}, blocks {:.3f}, filtered "
      "{:.3f}\n",
      each(l.all()), each(l.films), each(l.histories), each(l.blocks), each(l.filtered));
  if (l.footprints > 0)
    fmt::print("history / footprint  {:8.3f}\n",
               static_cast<double>(l.histories) / static_cast<double>(l.footprints));
  return same ? 0 : 1;
}

}  // namespace
}  // namespace tessera

int main(int argc, char** argv) {
  tessera::Options o;
  try {
    if (argc > 1) o.scene = argv[1];
    if (argc > 2) o.frames = std::max(2, std::stoi(argv[2]));
    if (argc > 3) o.samples = std::stoi(argv[3]);
    if (argc > 4) o.filter = argv[4];
    if (argc > 5 && std::sscanf(argv[5], "%dx%d", &o.size.width, &o.size.height) != 2) return 2;
    if (argc > 6) o.tile = std::stoi(argv[6]);
    return tessera::run(o);
  } catch (const std::exception& e) {
    fmt::print(stderr, "shot_bench: {}\n", e.what());
    return 1;
  }
}

// SPDX-License-Identifier: Apache-2.0
#include "coordinator/farm/clerk.h"

#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <utility>

#include "core/png.h"

namespace tessera {

namespace {

std::filesystem::path emptied(std::filesystem::path folder) {
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

}  // namespace

Clerk::Clerk(std::filesystem::path folder, bool sync, std::function<void()> rung)
    : folder_(emptied(std::move(folder))),
      sync_(sync),
      rung_(std::move(rung)),
      thread_([this](const std::stop_token& token) { live(token); }) {}

Clerk::~Clerk() = default;

void Clerk::write(Paperwork work) { add(std::move(work)); }

void Clerk::draw(Sketch sketch) { add(std::move(sketch)); }

void Clerk::add(std::variant<Paperwork, Sketch> work) {
  const std::lock_guard lock(mutex_);
  waiting_.push_back(std::move(work));
  bell_.notify_one();
}

std::vector<Written> Clerk::done() {
  const std::lock_guard lock(mutex_);
  return std::exchange(done_, {});
}

std::vector<Drawn> Clerk::drawn() {
  const std::lock_guard lock(mutex_);
  return std::exchange(drawn_, {});
}

void Clerk::live(const std::stop_token& token) {
  for (;;) {
    std::variant<Paperwork, Sketch> work;
    {
      std::unique_lock lock(mutex_);
      if (!bell_.wait(lock, token, [this] { return !waiting_.empty(); })) return;
      work = std::move(waiting_.front());
      waiting_.pop_front();
    }
    if (auto* paperwork = std::get_if<Paperwork>(&work)) {
      Written written = attempt(std::move(*paperwork));
      const std::lock_guard lock(mutex_);
      done_.push_back(std::move(written));
    } else {
      Drawn drawn = attempt(std::get<Sketch>(work));
      const std::lock_guard lock(mutex_);
      drawn_.push_back(std::move(drawn));
    }
    rung_();
  }
}

Written Clerk::attempt(Paperwork work) const {
  const auto file = [&](const char* extension) {
    return folder_ / fmt::format("{}.{}.{}", work.job, work.place, extension);
  };
  Written written{.exr = {file("exr"), {}}, .png = {file("png"), {}}};
  try {
    write_frame(written.exr.path, written.png.path, work.frame, work.report, work.style, work.key);
    for (Written::File* made : {&written.exr, &written.png}) made->seal = sealed(made->path, sync_);
  } catch (const std::exception& e) {
    written.trouble = e.what();
  }
  written.of = std::move(work);
  return written;
}

// Nobody misses a preview of which there is none.
Drawn Clerk::attempt(const Sketch& sketch) const {
  Drawn drawn{sketch.job, sketch.place, {}};
  const std::filesystem::path file = folder_ / "preview.png";
  try {
    write_png(file, sketch.rgb, static_cast<float>(sketch.exposure));
    std::ifstream in(file, std::ios::binary);
    drawn.png.assign(std::istreambuf_iterator<char>(in), {});
    std::filesystem::remove(file);
  } catch (const std::exception&) {
    drawn.png.clear();
  }
  return drawn;
}

}  // namespace tessera

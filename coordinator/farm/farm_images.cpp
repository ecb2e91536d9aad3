// SPDX-License-Identifier: Apache-2.0
// What becomes of frames that have ended: their images in the store, or why there are none.
#include <fmt/format.h>

#include <algorithm>

#include "coordinator/farm/farm.h"
#include "coordinator/output.h"

namespace tessera {
namespace {

// The names of blobs that a sentence holds.
std::vector<Digest> digests_in(std::string_view text) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::vector<Digest> found;
  for (std::size_t end = 0, at; (at = text.find_first_of(kDigits, end)) != text.npos;) {
    end = std::min(text.find_first_not_of(kDigits, at), text.size());
    if (is_digest(text.substr(at, end - at))) found.emplace_back(text.substr(at, end - at));
  }
  return found;
}

}  // namespace

void Farm::file_failed(OpenJob& job, std::size_t place, const JobReport& report) {
  FrameRecord& frame = job.frames[place];
  frame.state = FrameState::failed;
  frame.reason = *report.failure;
  previews_.forget(Previews::Key{job.record.job, place});
  note(job, fmt::format("frame {} failed: {}", frame.frame, frame.reason));
  look_at_files(job, frame.reason);
  try {
    settle(job, place);
  } catch (const Error& e) {
    have_trouble(e.what());  // after a crash it is done again, and fails again
  }
}

// Nobody here reads a scene's files whole; workers do, and say the names of those that are not what they
// were. One that is damaged here is set aside, so that submitting the scene again brings it again.
void Farm::look_at_files(const OpenJob& job, const std::string& reason) {
  for (const Digest& blob : digests_in(reason)) try {
      if (store_.blobs().has(blob)) store_.blobs().check(blob);
    } catch (const Error& e) {
      note(job, e.what());
    }
}

void Farm::file_as(Digest& blob, const Written::File& file) {
  if (!blob.empty()) return;  // an earlier try came so far
  store_.blobs().put_file(file.path, file.seal);
  blob = file.seal;
}

// What the clerk has written becomes the frame's image; kept for another try if the disk is full.
void Farm::file_next() {
  Written& written = unfiled_.front();
  const auto found = open_.find(written.of.job);
  if (found == open_.end()) return unfiled_.pop_front();  // cancelled meanwhile
  OpenJob& job = found->second;
  if (written.trouble) {
    have_trouble(*written.trouble);
    clerk_.write(std::move(written.of));
    return unfiled_.pop_front();
  }
  FrameRecord& frame = job.frames[written.of.place];
  try {
    file_as(frame.image, written.exr);
    file_as(frame.preview, written.png);
    frame.kept = job.keeper->keep(written.of.report.kept);
    const FrameImage& image = written.of.report.image;
    frame.state = fell_short(written.of.frame, image) ? FrameState::limited : FrameState::completed;
    settle(job, written.of.place);
    previews_.forget(Previews::Key{written.of.job, written.of.place});
    note(job, fmt::format("frame {}: {}", frame.frame, verdict(written.of.frame, image)));
  } catch (const Error& e) {
    return have_trouble(e.what());
  }
  --job.writing;
  changed_ = true;
  unfiled_.pop_front();
}

// The frame's row says how it ended: from here on it is not done again. Throws StoreError.
void Farm::settle(OpenJob& job, std::size_t place) {
  const auto i = static_cast<std::size_t>(std::ranges::find(job.places, place) - job.places.begin());
  job.keeper->end(i);
  job.record.pixel_samples = job.samples_before;
  job.record.seconds = seconds_of(job);
  save(job);
}

}  // namespace tessera

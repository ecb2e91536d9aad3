// SPDX-License-Identifier: Apache-2.0
// One message of every kind, with no field at its default.
#pragma once

#include <utility>
#include <vector>

#include "proto/message.h"
#include "tests/proto/question_samples.h"

namespace tessera {

inline Image counting_image(const Region& region, int planes) {
  Image image(region, planes);
  float value = 0.25f;
  for (float& v : image.data()) v = value += 1.0f;
  return image;
}

inline Job sample_job() {
  Job job;
  job.scene = {"/scenes/caf\xc3\xa9\xff.json", "0123456789abcdef", sha256("bundle")};
  job.render.size = {640, 360};
  job.render.seed = 0xfedcba9876543210u;
  job.render.max_bounces = 5;
  job.render.camera = "left";
  job.render.aovs = AovSet{Aov::color, Aov::normal, Aov::depth};
  job.frame = -7;
  job.crop = Region{10, 20, 300, 200};
  job.acceptance = {.relmse = 0.0025, .first_samples = 32, .max_samples = 1024, .max_seconds = 12.5};
  job.tile = {37, 53};
  job.task_samples = 12345;
  return job;
}

// Of a frame that is given, and reaches beyond its picture.
inline Job sample_given_job() {
  Job job;
  job.frame = 9;
  job.given = Given{.planes = sha256("planes"), .display = {0, 0, 40, 30}, .goes_on = true};
  job.crop = Region{-8, -8, 48, 38};
  return job;
}

inline std::vector<Message> sample_messages() {
  const Region region{64, 128, 67, 133}, outer{60, 120, 72, 140};
  std::vector<Message> all;
  all.push_back(Hello{1, "0.1.0", "avx512 pocl-3.1", 12, "host"});
  all.push_back(Heartbeat{{{7, 1}, {1ull << 60, 4'000'000'000u}}});
  all.push_back(RenderDone{7, 3, {{16, 32}, counting_image(region, 5)}, 1.5, 9});
  all.push_back(FilterDone{8, 2, counting_image(region, kFilteredPlanes), 0.25});
  all.push_back(TaskFailed{9, 1, "out of memory", true});
  all.push_back(Goodbye{});
  all.push_back(NeedJob{77});
  all.push_back(Welcome{1, Millis{1500}, Millis{4000}});
  all.push_back(Refused{"too old"});
  all.push_back(JobOffer{77, sample_job()});
  all.push_back(JobOffer{78, sample_given_job()});
  all.push_back(Assign{{5, 77, RenderTask{region, {0, 8}}}, 2, {}});
  all.push_back(Assign{{6, 77, FilterTask{{region, outer}, 3}}, 1, counting_image(outer, 4)});
  all.push_back(Assign{
      {7, 77, FilterTask{{region, outer}, 3}}, 1, {counting_image(outer, 4), counting_image(region, 6)}});
  all.push_back(Revoke{5, 2});
  all.push_back(JobOver{77});
  all.push_back(Unknown{});
  std::uint64_t number = 100;
  for (const Question& q : sample_questions()) all.push_back(Ask{++number, q});
  for (const Reply& r : sample_replies()) all.push_back(Answer{++number, r});
  return all;
}

}  // namespace tessera

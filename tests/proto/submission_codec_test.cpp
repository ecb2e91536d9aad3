// SPDX-License-Identifier: Apache-2.0
#include "proto/submission_codec.h"

#include <gmock/gmock.h>

#include <random>

#include "core/sequence.h"
#include "proto/codec.h"
#include "tests/proto/question_samples.h"

namespace tessera {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

template <class Spoil>
std::string complaint(Spoil spoil) {
  Submission s = sample_submission();
  spoil(s);
  try {
    decode_submission(encode(s));
  } catch (const ProtocolError& error) {
    return error.what();
  }
  return "none";
}

TEST(SubmissionCodec, EveryFieldComesBack) {
  EXPECT_EQ(decode_submission(encode(sample_submission())), sample_submission());
  Submission plain;
  plain.name = "a";
  plain.frames = {0};
  EXPECT_EQ(decode_submission(encode(plain)), plain);
}

// Frames that are not rendered, one of which reaches beyond its picture.
Submission given() {
  Submission s;
  s.name = "given";
  s.job.filter = parse_filter("svgf:history=on,sigma_l=2");
  s.frames = {7, 6};
  s.cuts = {7};
  const Region picture{0, 0, 40, 30};
  s.given = {{{sha256("7"), picture, false}, {-8, -8, 48, 38}, 12.5, 0.25},
             {{sha256("6"), picture, true}, picture, 0, 0}};
  return s;
}

TEST(SubmissionCodec, FramesThatAreGivenComeBack) {
  EXPECT_EQ(decode_submission(encode(given())), given());
  const std::vector<Job> jobs = jobs_of(given());
  EXPECT_EQ(jobs[0].region(), (Region{-8, -8, 48, 38}));
  EXPECT_EQ(jobs[1].given->planes, sha256("6"));
  EXPECT_TRUE(jobs[1].given->goes_on);
  EXPECT_EQ(jobs[0].frame, 7);
}

TEST(SubmissionCodec, EachFrameThatIsGivenHasItsOwnFacts) {
  Submission s = given();
  s.job.filter = parse_filter("sbf");
  for (const FilterDescription& d : filters())
    for (const Parameter& p : d.parameters)
      if (p.fact == SceneFact::diameter) {
        s.job.filter = parse_filter(d.name);
        EXPECT_EQ(jobs_of(s)[0].filter[p.name], 12.5) << d.name;
        EXPECT_EQ(jobs_of(s)[1].filter[p.name], 1) << d.name << ": not known";
      }
}

TEST(SubmissionCodec, FramesThatCannotBeGivenAreRefusedByTheNameOfTheField) {
  const auto wrong = [](auto&& spoil) {
    Submission s = given();
    spoil(s);
    try {
      decode_submission(encode(s));
    } catch (const ProtocolError& error) {
      return std::string(error.what());
    }
    return std::string("none");
  };
  EXPECT_EQ(wrong([](auto&) {}), "none");
  EXPECT_THAT(wrong([](auto& s) { s.given.pop_back(); }), HasSubstr("given"));
  EXPECT_THAT(wrong([](auto& s) { s.given[1].given.planes = "no digest"; }), HasSubstr("given"));
  EXPECT_THAT(wrong([](auto& s) { s.given[1].given.planes[3] = 'x'; }), HasSubstr("given.planes"));
  EXPECT_THAT(wrong([](auto& s) { s.given[1].given.display = {}; }), HasSubstr("given.display"));
  EXPECT_THAT(wrong([](auto& s) { s.given[1].region = {0, 0, 65537, 1}; }), HasSubstr("crop"));
  EXPECT_THAT(wrong([](auto& s) { s.given[1].region = {1 << 30, 0, (1 << 30) + 2, 1}; }), HasSubstr("crop"));
  EXPECT_THAT(wrong([](auto& s) { s.given[0].diameter = -1; }), HasSubstr("given.diameter"));
  EXPECT_THAT(wrong([](auto& s) { s.given[0].light = NAN; }), HasSubstr("given.light"));
  EXPECT_THAT(wrong([](auto& s) { s.layers_for = "nlm"; }), HasSubstr("layers_for"));
  EXPECT_THAT(wrong([](auto& s) { s.job.scene.path = "a.json"; }), HasSubstr("scene"));
  EXPECT_THAT(wrong([](auto& s) { s.job.given = s.given[0].given; }), HasSubstr("crop"));
  EXPECT_THAT(wrong([](auto& s) {
                s.job.tile = {65536, 65536};
                s.given[0].region = {0, 0, 30000, 30000};
              }),
              HasSubstr("smaller tile"));
}

TEST(SubmissionCodec, EqualSubmissionsAreEqualBytes) {
  EXPECT_EQ(encode(decode_submission(encode(sample_submission()))), encode(sample_submission()));
}

TEST(SubmissionCodec, TheMostFramesAndNamesTravelAndOneFrameMoreDoesNot) {
  Submission s = sample_submission();
  s.frames.resize(kMaxFrames);
  for (int i = 0; i < kMaxFrames; ++i) s.frames[i] = i - kMaxFrames / 2;
  s.names.objects.assign(1 << 20, "chair 00000000");
  EXPECT_EQ(decode_submission(encode(s)), s);
  s.frames.push_back(kMaxFrames);
  EXPECT_THROW(decode_submission(encode(s)), Error);
  EXPECT_THAT([&] { validate(s); }, ThrowsMessage<Error>(HasSubstr("1 to 100000")));
}

TEST(SubmissionCodec, MoreNamesThanABlobHoldsAreRefusedWithWhatIsAccepted) {
  Submission s = sample_submission();
  s.names.objects.assign(1 << 19, std::string(256, 'x'));
  EXPECT_THAT([&] { encode(s); }, ThrowsMessage<Error>(HasSubstr("64 MiB")));
}

TEST(SubmissionCodec, WhatCannotBeSoIsRefusedByTheNameOfItsField) {
  EXPECT_THAT(complaint([](auto& s) { s.name.clear(); }), HasSubstr("name"));
  EXPECT_THAT(complaint([](auto& s) { s.name = std::string(257, 'x'); }), HasSubstr("name"));
  EXPECT_THAT(complaint([](auto& s) { s.priority = 101; }), HasSubstr("priority"));
  EXPECT_THAT(complaint([](auto& s) { s.after = {"a/b"}; }), HasSubstr("after"));
  EXPECT_THAT(complaint([](auto& s) { s.limits.seconds = -1; }), HasSubstr("limits.seconds"));
  EXPECT_THAT(complaint([](auto& s) { s.frames.clear(); }), HasSubstr("frames"));
  EXPECT_THAT(complaint([](auto& s) { s.frames = {1, 1}; }), HasSubstr("frames"));
  EXPECT_THAT(complaint([](auto& s) { s.cuts = {2, 2}; }), HasSubstr("cuts"));
  EXPECT_THAT(complaint([](auto& s) { s.cuts = {3, 2}; }), HasSubstr("cuts"));
  EXPECT_THAT(complaint([](auto& s) { s.facts.light = -1; }), HasSubstr("facts.light"));
  EXPECT_THAT(complaint([](auto& s) { s.names.objects = {std::string(257, 'x')}; }), HasSubstr("objects"));
  EXPECT_THAT(complaint([](auto& s) { s.compression = "zap"; }), HasSubstr("compression"));
  EXPECT_THAT(complaint([](auto& s) { s.exposure = NAN; }), HasSubstr("exposure"));
  EXPECT_THAT(complaint([](auto& s) { s.job.task_samples = 0; }), HasSubstr("task_samples"));
  EXPECT_THAT(complaint([](auto& s) { s.job.scene.path = std::string(5000, 'x'); }), HasSubstr("path"));
}

TEST(SubmissionCodec, WhatIsTooLongIsRefusedUnread) {
  EXPECT_THROW(decode_submission(std::string(kMaxSubmissionBytes + 1, '\0')), ProtocolError);
  Submission s = sample_submission();
  s.after.assign(100'000, "job");
  EXPECT_THAT([&] { decode_submission(encode(s)); }, ThrowsMessage<ProtocolError>(HasSubstr("head")));
}

void expect_damage_is_noticed_or_harmless(const std::string& whole) {
  std::mt19937 random{20261126};
  int good = 0, refused = 0;
  const auto read = [&](const std::string& bytes) {
    try {
      validate(decode_submission(bytes));
      ++good;
    } catch (const ProtocolError&) {
      ++refused;
    }
  };
  for (std::size_t n = 0; n < whole.size(); ++n) read(whole.substr(0, n));
  for (int i = 0; i < 40'000; ++i) {
    std::string bytes = whole;
    for (unsigned n = 1 + random() % 3; n > 0; --n)
      bytes[random() % bytes.size()] = static_cast<char>(random());
    read(bytes);
  }
  EXPECT_GT(refused, 10'000);
  EXPECT_GT(good, 1'000);
}

TEST(SubmissionCodec, DamagedBytesAreASubmissionOrAProtocolError) {
  expect_damage_is_noticed_or_harmless(encode(sample_submission()));
  expect_damage_is_noticed_or_harmless(encode(given()));
}

}  // namespace
}  // namespace tessera

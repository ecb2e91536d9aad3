// SPDX-License-Identifier: Apache-2.0
#include "proto/submission_codec.h"

#include <gmock/gmock.h>

#include <random>

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

TEST(SubmissionCodec, EqualSubmissionsAreEqualBytes) {
  EXPECT_EQ(encode(decode_submission(encode(sample_submission()))), encode(sample_submission()));
}

TEST(SubmissionCodec, AMillionFramesAndNamesTravel) {
  Submission s = sample_submission();
  s.frames.resize(1'000'000);
  for (int i = 0; i < 1'000'000; ++i) s.frames[i] = i - 500'000;
  s.names.objects.assign(1 << 20, "chair 00000000");
  EXPECT_EQ(decode_submission(encode(s)), s);
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

TEST(SubmissionCodec, DamagedBytesAreASubmissionOrAProtocolError) {
  const std::string whole = encode(sample_submission());
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

}  // namespace
}  // namespace tessera

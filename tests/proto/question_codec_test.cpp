// SPDX-License-Identifier: Apache-2.0
// Questions and answers as they travel.
#include <gmock/gmock.h>

#include <cmath>
#include <set>

#include "proto/codec.h"
#include "tests/proto/question_samples.h"

namespace tessera {
namespace {

using testing::StartsWith;

Question round_trip(const Question& q) { return std::get<Ask>(decode(encode(Ask{1, q}))).question; }
Reply round_trip(const Reply& r) { return std::get<Answer>(decode(encode(Answer{1, r}))).reply; }

std::string complaint(const Message& message) {
  try {
    decode(encode(message));
  } catch (const ProtocolError& error) {
    return error.what();
  }
  return "none";
}
std::string asked(const Question& q) { return complaint(Ask{1, q}); }
std::string answered(const Reply& r) { return complaint(Answer{1, r}); }

template <class Spoil>
std::string of_job(Spoil spoil) {
  JobSummary s = sample_summary();
  spoil(s);
  return answered(JobList{{s}});
}
template <class Spoil>
std::string of_frame(Spoil spoil) {
  FrameSummary s = sample_frame();
  spoil(s);
  return answered(JobDetail{sample_summary(), 0, {s}});
}
template <class Spoil>
std::string of_worker(Spoil spoil) {
  WorkerSummary s = sample_worker();
  spoil(s);
  return answered(WorkerList{{s}});
}

template <class Variant>
std::size_t kinds_of(const std::vector<Variant>& all) {
  std::set<std::size_t> kinds;
  for (const Variant& v : all) kinds.insert(v.index());
  return kinds.size();
}

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(QuestionCodec, TheSamplesAreOfEveryKind) {
  EXPECT_EQ(kinds_of(sample_questions()), std::variant_size_v<Question>);
  EXPECT_EQ(kinds_of(sample_replies()), std::variant_size_v<Reply>);
}

TEST(QuestionCodec, EveryFieldOfAQuestionTravels) {
  for (const Question& q : sample_questions()) EXPECT_EQ(round_trip(q), q) << q.index();
  EXPECT_EQ(std::get<Ask>(decode(encode(Ask{1ull << 60, ListJobs{}}))).number, 1ull << 60);
}

TEST(QuestionCodec, EveryFieldOfAnAnswerTravels) {
  for (const Reply& r : sample_replies()) EXPECT_EQ(round_trip(r), r) << r.index();
  EXPECT_EQ(std::get<Answer>(decode(encode(Answer{1ull << 60, Agreed{}}))).number, 1ull << 60);
}

TEST(QuestionCodec, WhatIsNotKnownTravelsAsThat) {
  JobSummary job = sample_summary();
  job.seconds_left.reset();
  EXPECT_EQ(round_trip(JobList{{job}}), Reply(JobList{{job}}));
  FrameSummary frame = sample_frame();
  frame.error.reset();
  frame.target.reset();
  frame.errors.clear();
  frame.cells.clear();
  frame.columns = 0;
  frame.image.clear();
  frame.preview.clear();
  EXPECT_EQ(round_trip(JobDetail{job, 0, {frame}}), Reply(JobDetail{job, 0, {frame}}));
  EXPECT_EQ(round_trip(Question(ListWorkers{})), Question(ListWorkers{}));
}

TEST(QuestionCodec, EveryStateAndVerbAndCodeTravels) {
  for (int i = 0; i <= static_cast<int>(JobState::cancelled); ++i)
    EXPECT_EQ(of_job([&](JobSummary& s) { s.state = static_cast<JobState>(i); }), "none");
  for (int i = 0; i <= static_cast<int>(FrameState::failed); ++i)
    EXPECT_EQ(of_frame([&](FrameSummary& s) { s.state = static_cast<FrameState>(i); }), "none");
  for (const Verb verb : {Verb::cancel, Verb::pause, Verb::resume, Verb::remove})
    EXPECT_EQ(asked(Control{"j", verb, 0}), "none");
  for (const ExitCode code : {ExitCode::internal_error, ExitCode::bad_usage, ExitCode::bad_input,
                              ExitCode::out_of_memory, ExitCode::no_device, ExitCode::unreachable,
                              ExitCode::job_failed, ExitCode::stopped_at_limit, ExitCode::interrupted})
    EXPECT_EQ(round_trip(Denied{code, "why"}), Reply(Denied{code, "why"}));
}

TEST(QuestionCodec, BlobsAreNamedByDigestsOnly) {
  for (const std::string& bad : {std::string(), std::string("../../etc/passwd"), std::string(64, 'G'),
                                 std::string(64, 'A'), std::string(63, 'a'), std::string(65, 'a')}) {
    EXPECT_THAT(asked(WhichLack{{bad}}), StartsWith("message: blobs"));
    EXPECT_THAT(asked(PutPiece{bad, 1, 0, "x"}), StartsWith("message: blob"));
    EXPECT_THAT(asked(GetPiece{bad, 0}), StartsWith("message: blob"));
    EXPECT_THAT(asked(Submit{"j", bad}), StartsWith("message: submission"));
    EXPECT_THAT(answered(Lacking{{{bad, 0}}}), StartsWith("message: blobs"));
    EXPECT_THAT(answered(Piece{bad, 1, 0, "x"}), StartsWith("message: blob"));
    if (bad.empty()) continue;
    EXPECT_THAT(of_frame([&](FrameSummary& s) { s.image = bad; }), StartsWith("message: image"));
    EXPECT_THAT(of_frame([&](FrameSummary& s) { s.preview = bad; }), StartsWith("message: preview"));
  }
}

TEST(QuestionCodec, JobsAndWorkersAreNamedAsTheyMayBe) {
  for (const std::string& bad : {std::string(), std::string(".hidden"), std::string("a/b"),
                                 std::string("a b"), std::string(65, 'x'), std::string("a\0", 2)}) {
    EXPECT_THAT(asked(Submit{bad, sha256("")}), StartsWith("message: job"));
    EXPECT_THAT(asked(ShowJob{bad, 0}), StartsWith("message: job"));
    EXPECT_THAT(asked(ListEvents{bad, 0}), StartsWith("message: job"));
    EXPECT_THAT(asked(Control{bad, Verb::cancel, 0}), StartsWith("message: job"));
    EXPECT_THAT(of_job([&](JobSummary& s) { s.job = bad; }), StartsWith("message: job"));
  }
  EXPECT_THAT(asked(ReleaseWorker{""}), StartsWith("message: worker"));
  EXPECT_THAT(asked(ReleaseWorker{"a b"}), StartsWith("message: worker"));
  EXPECT_THAT(asked(ListWorkers{"a b"}), StartsWith("message: after"));
  EXPECT_THAT(of_worker([](WorkerSummary& s) { s.id = "a b"; }), StartsWith("message: id"));
  EXPECT_THAT(of_worker([](WorkerSummary& s) { s.id = std::string(98, 'x'); }), StartsWith("message: id"));
}

TEST(QuestionCodec, PiecesLieWithinTheirBlobs) {
  const Digest a = sha256("a");
  EXPECT_EQ(asked(PutPiece{a, kPieceBytes, 0, std::string(kPieceBytes, 'x')}), "none");
  EXPECT_EQ(asked(PutPiece{a, 0, 0, ""}), "none");
  EXPECT_THAT(asked(PutPiece{a, kPieceBytes * 2, 0, std::string(kPieceBytes + 1, 'x')}),
              StartsWith("message: bytes"));
  EXPECT_THAT(asked(PutPiece{a, 3, 0, "four"}), StartsWith("message: offset"));
  EXPECT_THAT(asked(PutPiece{a, 3, 4, ""}), StartsWith("message: offset"));
  EXPECT_THAT(asked(PutPiece{a, 3, ~0ull, "x"}), StartsWith("message: offset"));
  EXPECT_THAT(asked(PutPiece{a, kMaxBlobBytes + 1, 0, "x"}), StartsWith("message: size"));
  EXPECT_THAT(asked(GetPiece{a, kMaxBlobBytes + 1}), StartsWith("message: offset"));
  EXPECT_THAT(answered(Piece{a, 3, 1, "abc"}), StartsWith("message: offset"));
  EXPECT_THAT(answered(Lacking{{{a, kMaxBlobBytes + 1}}}), StartsWith("message: have"));
}

TEST(QuestionCodec, ListsThatAreTooLongAreRefused) {
  const std::vector<Digest> blobs(kMaxListed + 1, sha256(""));
  EXPECT_THAT(asked(WhichLack{blobs}), StartsWith("message: blobs"));
  EXPECT_THAT(answered(Lacking{std::vector<Lacking::Blob>(kMaxListed + 1, {sha256(""), 0})}),
              StartsWith("message: blobs"));
  EXPECT_THAT(answered(JobList{std::vector(kMaxListed + 1, sample_summary())}), StartsWith("message: jobs"));
  EXPECT_THAT(answered(JobDetail{sample_summary(), 0, std::vector(kMaxListed + 1, sample_frame())}),
              StartsWith("message: frames"));
  EXPECT_THAT(answered(EventList{std::vector<JobEvent>(kMaxListed + 1, {1, 1, ""})}),
              StartsWith("message: events"));
  EXPECT_THAT(answered(WorkerList{std::vector(kMaxListed + 1, sample_worker())}),
              StartsWith("message: workers"));
}

TEST(QuestionCodec, NumbersOfQuestionsOutOfRangeAreRefused) {
  EXPECT_THAT(asked(Control{"j", Verb::set_priority, 101}), StartsWith("message: value"));
  EXPECT_THAT(asked(Control{"j", Verb::set_priority, -1}), StartsWith("message: value"));
  EXPECT_THAT(asked(Control{"j", Verb::verify, 0}), StartsWith("message: value"));
  EXPECT_THAT(asked(Control{"j", Verb::verify, 1'000'001}), StartsWith("message: value"));
  EXPECT_THAT(asked(Control{"j", Verb::cancel, 1}), StartsWith("message: value"));
  EXPECT_THAT(asked(Control{"j", static_cast<Verb>(6), 0}), StartsWith("message: verb"));
}

TEST(QuestionCodec, NumbersOfJobsOutOfRangeAreRefused) {
  EXPECT_THAT(of_job([](auto& s) { s.number = 0; }), StartsWith("message: number"));
  EXPECT_THAT(of_job([](auto& s) { s.name = std::string(257, 'x'); }), StartsWith("message: name"));
  EXPECT_THAT(of_job([](auto& s) { s.owner = std::string(257, 'x'); }), StartsWith("message: owner"));
  EXPECT_THAT(of_job([](auto& s) { s.state = static_cast<JobState>(6); }), StartsWith("message: state"));
  EXPECT_THAT(of_job([](auto& s) { s.priority = 101; }), StartsWith("message: priority"));
  EXPECT_THAT(of_job([](auto& s) { s.frames_done = ~0u; }), StartsWith("message: frames_done"));
  EXPECT_THAT(of_job([](auto& s) { s.submitted = -1; }), StartsWith("message: submitted"));
  EXPECT_THAT(of_job([](auto& s) { s.fraction = 1.5; }), StartsWith("message: fraction"));
  EXPECT_THAT(of_job([](auto& s) { s.fraction = kNaN; }), StartsWith("message: fraction"));
  EXPECT_THAT(of_job([](auto& s) { s.seconds = -1; }), StartsWith("message: seconds"));
  EXPECT_THAT(of_job([](auto& s) { s.seconds_left = kNaN; }), StartsWith("message: seconds_left"));
  EXPECT_THAT(answered(EventList{{{0, 1, ""}}}), StartsWith("message: number"));
  EXPECT_THAT(answered(EventList{{{1, -1, ""}}}), StartsWith("message: when"));
  EXPECT_THAT(answered(Denied{ExitCode::done, ""}), StartsWith("message: code"));
  EXPECT_THAT(answered(Denied{static_cast<ExitCode>(9), ""}), StartsWith("message: code"));
}

TEST(QuestionCodec, NumbersOfFramesOutOfRangeAreRefused) {
  EXPECT_THAT(of_frame([](auto& s) { s.state = static_cast<FrameState>(5); }), StartsWith("message: state"));
  EXPECT_THAT(of_frame([](auto& s) { s.round = -1; }), StartsWith("message: round"));
  EXPECT_THAT(of_frame([](auto& s) { s.tiles = -1; }), StartsWith("message: tiles"));
  EXPECT_THAT(of_frame([](auto& s) { s.tiles_done = 9; }), StartsWith("message: tiles_done"));
  EXPECT_THAT(of_frame([](auto& s) { s.fraction = -0.5; }), StartsWith("message: fraction"));
  EXPECT_THAT(of_frame([](auto& s) { s.acceptable_share = kNaN; }), StartsWith("message: acceptable_share"));
  EXPECT_THAT(of_frame([](auto& s) { s.seconds = INFINITY; }), StartsWith("message: seconds"));
  EXPECT_THAT(of_frame([](auto& s) { s.error = kNaN; }), StartsWith("message: error"));
  EXPECT_THAT(of_frame([](auto& s) { s.target = kNaN; }), StartsWith("message: target"));
  EXPECT_THAT(of_frame([](auto& s) { s.errors = {NAN}; }), StartsWith("message: errors"));
  EXPECT_THAT(of_frame([](auto& s) { s.columns = 3; }), StartsWith("message: cells"));
  EXPECT_THAT(of_frame([](auto& s) { s.columns = 0; }), StartsWith("message: cells"));
  EXPECT_THAT(of_frame([](auto& s) { s.cells.clear(); }), StartsWith("message: cells"));
  EXPECT_THAT(of_frame([](auto& s) { s.columns = 1025; }), StartsWith("message: columns"));
  EXPECT_THAT(of_frame([](auto& s) { s.cells[1] = static_cast<CellStatus>(3); }),
              StartsWith("message: cells"));
  EXPECT_THAT(of_frame([](auto& s) { s.cells[1] = static_cast<CellStatus>(255); }),
              StartsWith("message: cells"));
}

TEST(QuestionCodec, NumbersOfWorkersOutOfRangeAreRefused) {
  EXPECT_THAT(of_worker([](auto& s) { s.slots = -1; }), StartsWith("message: slots"));
  EXPECT_THAT(of_worker([](auto& s) { s.held = kMaxHeld + 1; }), StartsWith("message: held"));
  EXPECT_THAT(of_worker([](auto& s) { s.tasks_per_second = kNaN; }), StartsWith("message: tasks_per_second"));
  EXPECT_THAT(of_worker([](auto& s) { s.name = std::string(257, 'x'); }), StartsWith("message: name"));
  EXPECT_THAT(of_worker([](auto& s) { s.device_class = std::string(257, 'x'); }),
              StartsWith("message: device_class"));
}

TEST(QuestionCodec, TheLongestAnswersAreCutAndFitIntoAMessage) {
  const std::string novel(100'000, 'x');
  JobSummary job = sample_summary();
  job.job = std::string(64, 'j');
  job.name = job.owner = std::string(256, 'n');
  job.reason = novel;
  FrameSummary frame = sample_frame();
  frame.reason = novel;
  frame.errors.assign(10'000, 0.5f);
  frame.errors.back() = 0.125f;
  frame.columns = 128;  // of 8192 x 4352
  frame.cells.assign(128 * 68, CellStatus::accepted);
  const Reply detail = round_trip(JobDetail{job, 0, std::vector(kMaxListed, frame)});
  const auto& frames = std::get<JobDetail>(detail).frames;
  ASSERT_EQ(frames.size(), kMaxListed);
  EXPECT_EQ(frames[0].cells, frame.cells);
  EXPECT_EQ(frames[29].cells, frame.cells) << "30 of 8704 cells fit into 262144";
  EXPECT_TRUE(frames[30].cells.empty());
  EXPECT_EQ(frames[0].reason, std::string(1024, 'x'));
  EXPECT_EQ(frames[0].errors.size(), 256u);
  EXPECT_EQ(frames[0].errors.back(), 0.125f);

  const Reply jobs = round_trip(JobList{std::vector(kMaxListed, job)});
  EXPECT_EQ(std::get<JobList>(jobs).jobs[255].reason, std::string(1024, 'x'));
  const Reply events = round_trip(EventList{std::vector<JobEvent>(kMaxListed, {~0ull, 1, novel})});
  EXPECT_EQ(std::get<EventList>(events).events[255].text, std::string(1024, 'x'));
  WorkerSummary worker = sample_worker();
  worker.name = worker.device_class = std::string(256, 'n');
  worker.set_aside = novel;
  const Reply workers = round_trip(WorkerList{std::vector(kMaxListed, worker)});
  EXPECT_EQ(std::get<WorkerList>(workers).workers[255].set_aside, std::string(1024, 'x'));
  EXPECT_EQ(std::get<Denied>(round_trip(Denied{ExitCode::bad_usage, novel})).reason, std::string(4096, 'x'));
}

}  // namespace
}  // namespace tessera

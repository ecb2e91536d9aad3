// SPDX-License-Identifier: Apache-2.0
#include "worker/agent.h"

#include <gmock/gmock.h>

#include <sstream>

namespace tessera {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

Instant at(double s) { return Instant(std::chrono::microseconds(static_cast<std::int64_t>(s * 1e6))); }

std::string named(const Message& message) {
  std::ostringstream out;
  if (std::holds_alternative<Hello>(message)) out << "Hello";
  if (std::holds_alternative<Goodbye>(message)) out << "Goodbye";
  if (const auto* m = std::get_if<NeedJob>(&message)) out << "NeedJob " << m->id;
  if (const auto* m = std::get_if<RenderDone>(&message)) out << "RenderDone " << m->task << '.' << m->attempt;
  if (const auto* m = std::get_if<FilterDone>(&message)) out << "FilterDone " << m->task << '.' << m->attempt;
  if (const auto* m = std::get_if<TaskFailed>(&message))
    out << "TaskFailed " << m->task << '.' << m->attempt << ' ' << m->reason << (m->bad_input ? "!" : "");
  if (const auto* m = std::get_if<Heartbeat>(&message)) {
    out << "Heartbeat";
    for (const Held& h : m->held) out << ' ' << h.task << '.' << h.attempt;
  }
  return out.str();
}

// What the agent wants, in words.
std::vector<std::string> words(const std::vector<Agent::Command>& commands) {
  std::vector<std::string> all;
  for (const Agent::Command& c : commands) {
    std::ostringstream out;
    if (const auto* s = std::get_if<Agent::Send>(&c)) out << named(s->message);
    if (const auto* s = std::get_if<Agent::Start>(&c)) out << "start " << s->task.id << " in " << s->slot;
    if (const auto* s = std::get_if<Agent::Cancel>(&c)) out << "cancel " << s->slot;
    if (const auto* s = std::get_if<Agent::Stop>(&c)) out << "stop " << int(s->why) << s->reason;
    all.push_back(out.str());
  }
  return all;
}

class AgentTest : public testing::Test {
 protected:
  explicit AgentTest(AgentOptions options = {.slots = 2}) : agent(std::move(options)) {}

  std::vector<std::string> handle(Agent::Event event, double now) {
    return words(agent.handle(std::move(event), at(now)));
  }
  std::vector<std::string> tell(Message message, double now) {
    return handle(Agent::Told{std::move(message)}, now);
  }
  std::vector<std::string> assign(TaskId task, double now, Attempt attempt = 1, JobId job = 1) {
    return tell(Assign{{task, job, RenderTask{{0, 0, 1, 1}, {0, 8}}}, attempt, {}}, now);
  }
  std::vector<std::string> time(double now) { return handle(Agent::TimePassed{}, now); }
  void welcome() {
    handle(Agent::Started{}, 0);
    tell(Welcome{}, 0);
    tell(JobOffer{1, Job{}}, 0);
  }
  Agent agent;
};

TEST_F(AgentTest, SaysHelloLessAndLessOftenUntilItIsWelcome) {
  EXPECT_THAT(handle(Agent::Started{}, 0), ElementsAre("Hello"));
  std::vector<double> hellos;
  while (hellos.size() < 9) {
    const Instant next = *agent.next_deadline();
    EXPECT_THAT(words(agent.handle(Agent::TimePassed{}, next)), ElementsAre("Hello"));
    hellos.push_back(std::chrono::duration<double>(next.time_since_epoch()).count());
  }
  EXPECT_THAT(hellos,
              testing::Pointwise(testing::DoubleEq(), {0.1, 0.3, 0.7, 1.5, 3.1, 6.3, 12.7, 20.7, 28.7}));
  EXPECT_THAT(tell(Welcome{.heartbeat = Millis{500}, .idle_heartbeat = Millis{500}}, 30),
              ElementsAre("Heartbeat"));
  EXPECT_EQ(agent.next_deadline(), at(30.5));
}

TEST_F(AgentTest, HeartbeatsComeRegularlyAndNameAllThatIsInHand) {
  welcome();
  EXPECT_THAT(assign(7, 0.1), ElementsAre("start 7 in 0"));
  EXPECT_THAT(assign(8, 0.1), ElementsAre("start 8 in 1"));
  EXPECT_THAT(assign(9, 0.1, 4), IsEmpty());
  EXPECT_THAT(time(1), ElementsAre("Heartbeat 7.1 8.1 9.4"));
  EXPECT_THAT(time(1.5), IsEmpty());
  EXPECT_THAT(handle(Agent::Finished{0, RenderDone{}}, 1.6), ElementsAre("RenderDone 7.1", "start 9 in 0"));
  EXPECT_THAT(time(2), ElementsAre("Heartbeat 9.4 8.1"));
}

TEST_F(AgentTest, SpeaksSeldomWithNothingInHand) {
  handle(Agent::Started{}, 0);
  tell(JobOffer{1, Job{}}, 0);
  tell(Welcome{.heartbeat = Millis{1000}, .idle_heartbeat = Millis{8000}}, 0);
  EXPECT_EQ(agent.next_deadline(), at(8));
  assign(7, 3);
  EXPECT_EQ(agent.next_deadline(), at(4));
  EXPECT_THAT(time(4), ElementsAre("Heartbeat 7.1"));
  EXPECT_THAT(time(5), ElementsAre("Heartbeat 7.1"));
  handle(Agent::Finished{0, RenderDone{}}, 5.5);
  EXPECT_THAT(time(6), ElementsAre("Heartbeat"));
  EXPECT_EQ(agent.next_deadline(), at(14));
  assign(8, 13.5);
  EXPECT_EQ(agent.next_deadline(), at(14)) << "no later than it was to be anyway";
}

TEST_F(AgentTest, AResultCarriesTheNameOfItsTask) {
  welcome();
  assign(7, 0.1, 3);
  EXPECT_THAT(handle(Agent::Finished{0, FilterDone{}}, 1), ElementsAre("FilterDone 7.3"));
}

TEST_F(AgentTest, AFailureIsReportedAndTheSlotWorksOn) {
  welcome();
  for (TaskId id = 1; id <= 3; ++id) assign(id, 0.1);
  EXPECT_THAT(handle(Agent::Broke{1, "why", true}, 0.5), ElementsAre("TaskFailed 2.1 why!", "start 3 in 1"));
}

TEST_F(AgentTest, AsksForAJobItDoesNotKnowUntilItComes) {
  handle(Agent::Started{}, 0);
  tell(Welcome{}, 0);
  EXPECT_THAT(assign(7, 0.1), ElementsAre("NeedJob 1"));
  EXPECT_THAT(assign(8, 0.1), IsEmpty());
  EXPECT_THAT(assign(9, 0.1, 1, 5), ElementsAre("NeedJob 5"));
  EXPECT_THAT(time(1), ElementsAre("Heartbeat 7.1 8.1 9.1", "NeedJob 1", "NeedJob 5"));
  EXPECT_THAT(tell(JobOffer{5, Job{}}, 1.1), ElementsAre("start 9 in 0"));
  EXPECT_THAT(tell(JobOffer{1, Job{}}, 1.2), ElementsAre("start 7 in 1"));
}

TEST_F(AgentTest, TasksAreTakenEvenIfTheWelcomeWasLost) {
  handle(Agent::Started{}, 0);
  tell(JobOffer{1, Job{}}, 0.01);
  EXPECT_THAT(assign(7, 0.02), ElementsAre("start 7 in 0"));
  EXPECT_THAT(time(0.1), ElementsAre("Hello"));
}

TEST_F(AgentTest, ATaskThatIsAssignedTwiceIsDoneOnceUnderTheLastAttempt) {
  welcome();
  assign(1, 0.1, 1);
  EXPECT_THAT(assign(1, 0.2, 3), IsEmpty());
  EXPECT_THAT(assign(1, 0.3, 2), IsEmpty());
  EXPECT_THAT(handle(Agent::Finished{0, RenderDone{}}, 1), ElementsAre("RenderDone 1.3"));
}

TEST_F(AgentTest, ARevokedTaskIsCancelledOrDropped) {
  welcome();
  for (TaskId id = 1; id <= 4; ++id) assign(id, 0.1);
  EXPECT_THAT(tell(Revoke{3, 1}, 0.2), IsEmpty());
  EXPECT_THAT(tell(Revoke{2, 1}, 0.2), ElementsAre("cancel 1"));
  EXPECT_THAT(tell(Revoke{2, 1}, 0.2), IsEmpty());
  EXPECT_THAT(time(1), ElementsAre("Heartbeat 1.1 4.1"));
  EXPECT_THAT(handle(Agent::Ended{1}, 1.1), ElementsAre("start 4 in 1"));
}

TEST_F(AgentTest, TheResultOfARevokedTaskIsNotSent) {
  welcome();
  assign(1, 0.1);
  assign(2, 0.1);
  tell(Revoke{1, 1}, 0.2);
  tell(Revoke{2, 1}, 0.2);
  EXPECT_THAT(handle(Agent::Finished{0, RenderDone{}}, 0.3), IsEmpty());
  EXPECT_THAT(handle(Agent::Broke{1, "interrupted", false}, 0.3), IsEmpty());
}

TEST_F(AgentTest, ARevokeOfAnEarlierAttemptIsTooLate) {
  welcome();
  assign(1, 0.1, 2);
  EXPECT_THAT(tell(Revoke{1, 1}, 0.2), IsEmpty());
  EXPECT_THAT(tell(Revoke{9, 1}, 0.2), IsEmpty());
}

TEST_F(AgentTest, ATaskRevokedAndAssignedAgainStartsAnew) {
  welcome();
  assign(1, 0.1);
  assign(2, 0.1);
  tell(Revoke{1, 1}, 0.2);
  EXPECT_THAT(assign(1, 0.3, 2), IsEmpty());
  EXPECT_THAT(handle(Agent::Ended{0}, 0.4), ElementsAre("start 1 in 0"));
}

TEST_F(AgentTest, AJobThatIsOverTakesItsTasksAlong) {
  welcome();
  tell(JobOffer{2, Job{}}, 0.1);
  assign(1, 0.1, 1, 1);
  assign(2, 0.1, 1, 2);
  assign(3, 0.1, 1, 1);
  EXPECT_THAT(tell(JobOver{1}, 0.2), ElementsAre("cancel 0"));
  EXPECT_THAT(handle(Agent::Ended{0}, 0.3), IsEmpty());
  EXPECT_THAT(assign(4, 0.4), ElementsAre("NeedJob 1"));
}

TEST_F(AgentTest, SaysHelloAgainWhenItIsUnknownAndKeepsItsTasks) {
  welcome();
  assign(1, 0.1);
  EXPECT_THAT(tell(Unknown{}, 0.2), ElementsAre("Hello"));
  EXPECT_THAT(tell(Unknown{}, 0.2), IsEmpty()) << "it has just said so";
  EXPECT_THAT(tell(Welcome{}, 0.3), ElementsAre("Heartbeat 1.1"));
}

TEST_F(AgentTest, SaysHelloAgainWhenTheCoordinatorIsSilentForLong) {
  welcome();
  std::vector<std::string> said;
  while (agent.next_deadline() < at(600.5))
    for (const std::string& w : words(agent.handle(Agent::TimePassed{}, *agent.next_deadline())))
      said.push_back(w);
  EXPECT_EQ(std::ranges::count(said, "Hello"), 3) << "at 600, 600.1 and 600.3 seconds";
  EXPECT_EQ(std::ranges::count(said, "Heartbeat"), 600);
}

TEST_F(AgentTest, AGoodbyeCancelsAllAndStopsWhenTheLastSlotIsFree) {
  welcome();
  for (TaskId id = 1; id <= 3; ++id) assign(id, 0.1);
  EXPECT_THAT(handle(Agent::StopRequested{}, 0.2), ElementsAre("Goodbye", "cancel 0", "cancel 1"));
  EXPECT_THAT(assign(4, 0.2), IsEmpty());
  EXPECT_THAT(handle(Agent::Ended{0}, 0.3), IsEmpty());
  EXPECT_THAT(handle(Agent::StopRequested{}, 0.3), IsEmpty());
  EXPECT_THAT(handle(Agent::Finished{1, RenderDone{}}, 0.4), ElementsAre("stop 0"));
  EXPECT_EQ(agent.next_deadline(), std::nullopt);
}

TEST_F(AgentTest, AnIdleWorkerStopsAtOnce) {
  welcome();
  EXPECT_THAT(handle(Agent::StopRequested{}, 1), ElementsAre("Goodbye", "stop 0"));
}

TEST_F(AgentTest, ARefusedWorkerStopsWithTheReason) {
  handle(Agent::Started{}, 0);
  EXPECT_THAT(tell(Refused{"too old"}, 0.1), ElementsAre("stop 1too old"));
}

class ImpatientAgent : public AgentTest {
 protected:
  ImpatientAgent() : AgentTest({.slots = 1, .give_up = Millis{5'000}}) {}
};

TEST_F(ImpatientAgent, GivesUpOnACoordinatorThatDoesNotAnswer) {
  handle(Agent::Started{}, 0);
  EXPECT_THAT(time(4.9), ElementsAre("Hello"));
  EXPECT_EQ(agent.next_deadline(), at(5));
  EXPECT_THAT(time(5), ElementsAre("stop 2the coordinator does not answer"));
}

TEST_F(AgentTest, RemembersABoundedNumberOfJobs) {
  handle(Agent::Started{}, 0);
  tell(Welcome{}, 0);
  for (JobId job = 1; job <= 1000; ++job) tell(JobOffer{job, Job{}}, 0.1);
  EXPECT_THAT(assign(1, 0.2, 1, 1000), ElementsAre("start 1 in 0"));
  EXPECT_THAT(assign(2, 0.2, 1, 1), ElementsAre("NeedJob 1"));
}

}  // namespace
}  // namespace tessera

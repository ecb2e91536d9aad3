// SPDX-License-Identifier: Apache-2.0
#include "coordinator/held_questions.h"

#include <algorithm>
#include <utility>

namespace tessera {

void HeldQuestions::hold(HeldQuestion question) {
  const Peer from = question.from;
  held_.insert_or_assign(from, std::move(question));
}

std::optional<Instant> HeldQuestions::next(Instant now) const {
  if (held_.empty()) return std::nullopt;
  if (news_) return now;
  return std::ranges::min_element(held_, {}, [](const auto& h) { return h.second.until; })->second.until;
}

std::vector<HeldQuestion> HeldQuestions::due(Instant now,
                                             const std::function<bool(const Question&)>& may_wait) {
  const bool news = std::exchange(news_, false);
  std::vector<HeldQuestion> due;
  for (auto it = held_.begin(); it != held_.end();) {
    const HeldQuestion& q = it->second;
    const bool waits = now < q.until && (!news || may_wait(q.ask.question));
    if (!waits) due.push_back(std::move(it->second));
    it = waits ? std::next(it) : held_.erase(it);
  }
  return due;
}

}  // namespace tessera

// SPDX-License-Identifier: Apache-2.0
// Workers that only say what workers say: each has its own connection to the coordinator, takes tasks and
// answers with results of the right shape, at once or after the time that its speed makes of them. In a
// process of its own, so that a coordinator's processor time and memory can be told from theirs.
#pragma once

#include <sys/types.h>

#include <string>
#include <vector>

#include "core/task.h"

namespace tessera {

struct CrowdMember {
  double speed = 0;      // units of cost a second, see cost_of(); 0: it answers at once,
  double says = 0.0001;  // and says that it took so many seconds
};

// What a task takes: a pixel sample costs 1; filtering a pixel as much as the scheduler expects.
double cost_of(const Work& work);

class Crowd {
 public:
  // Forks. Precondition: this process has one thread.
  explicit Crowd(const std::vector<CrowdMember>& members);
  ~Crowd();  // ends the process
  Crowd(const Crowd&) = delete;
  Crowd& operator=(const Crowd&) = delete;

  // They say hello there. Once.
  void connect(const std::string& endpoint);

 private:
  pid_t process_ = 0;
  int pipe_ = -1;
};

}  // namespace tessera

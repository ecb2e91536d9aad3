// SPDX-License-Identifier: Apache-2.0
// A road inside one process that loses, delays, repeats and reorders messages by seed: for simulated farms.
// Every message goes through the codec. With a clock of one's own nothing ever waits, so a farm of state
// machines lives through hours in milliseconds; without, receive() waits as on a real road.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>

#include "proto/transport.h"

namespace tessera {

// Each message is lost, or arrives once or twice, each time after a delay of its own: that is what reorders.
struct Weather {
  std::uint64_t seed = 0;
  double loss = 0;    // probability, 0 to 1
  double repeat = 0;  // probability, 0 to 1
  Instant::duration delay_min{0}, delay_max{0};
};

// Thread-safe. The same seed and the same calls make the same deliveries.
class MemoryRoad {
 public:
  explicit MemoryRoad(const Weather& weather, std::function<Instant()> virtual_clock = {});
  ~MemoryRoad();

  // A peer on the road. A second one of the same name takes the first one's place;
  // mail for a peer that is not there (any more) is lost.
  std::unique_ptr<Transport> join(const Peer& name);

  // When the earliest message under way arrives.
  std::optional<Instant> next_arrival() const;

  struct Counts {
    std::uint64_t sent = 0, lost = 0, repeated = 0, received = 0, malformed = 0;
  };
  Counts counts() const;

  class State;

 private:
  std::shared_ptr<State> state_;  // shared with the endpoints, which may be closed after it
};

}  // namespace tessera

// SPDX-License-Identifier: Apache-2.0
// The OpenCL devices of one worker: each tile goes to the one that will probably have it done first, by the
// speeds measured so far (devices share a frame by their speeds in van de Vlasakker, Physically Accurate
// Noise Free Real-time Rendering, 2013). Any thread.
#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "worker/denoise/device.h"

namespace tessera {

struct DeviceLoad {
  double work = 0;              // that it has in hand, pixels
  double seconds_per_work = 0;  // measured; 0: not yet
};

// The device that would be done first with `work` more. One that was not measured yet counts as fast as the
// fastest, so that it soon is. Precondition: there is one.
std::size_t first_done(std::span<const DeviceLoad> devices, double work);

class DevicePool {
 public:
  // At least one.
  explicit DevicePool(std::vector<std::unique_ptr<Device>> devices);
  // As Device::open takes them; none: the first CPU.
  static DevicePool open(const std::vector<std::string>& which);
  DevicePool(DevicePool&&) noexcept;
  ~DevicePool();

  // A device while one tile is filtered on it.
  class Use {
   public:
    Use(DevicePool& pool, std::size_t index, double work);
    Use(const Use&) = delete;
    ~Use();
    Device& device() const;
    void done(double seconds);  // it went well, and took so long

   private:
    DevicePool& pool_;
    std::size_t index_;
    double work_;
  };
  Use use(double work) { return {*this, choose(work), work}; }

  std::vector<DeviceInfo> infos() const;
  DeviceLoad load(std::size_t index) const;

 private:
  struct State;
  std::size_t choose(double work);

  std::vector<std::unique_ptr<Device>> devices_;
  std::unique_ptr<State> state_;
};

}  // namespace tessera

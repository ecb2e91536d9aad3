// SPDX-License-Identifier: Apache-2.0
#include "worker/denoise/device_pool.h"

#include <algorithm>
#include <cassert>
#include <limits>

namespace tessera {
namespace {

constexpr double kNew = 0.25;  // weight of the latest measurement

}  // namespace

struct DevicePool::State {
  std::mutex mutex;  // guards the loads
  std::vector<DeviceLoad> loads;
};

std::size_t first_done(std::span<const DeviceLoad> devices, double work) {
  assert(!devices.empty());
  double fastest = std::numeric_limits<double>::infinity();
  for (const DeviceLoad& d : devices)
    if (d.seconds_per_work > 0) fastest = std::min(fastest, d.seconds_per_work);
  if (fastest == std::numeric_limits<double>::infinity()) fastest = 1;
  const auto end = [&](const DeviceLoad& d) {
    return (d.work + work) * (d.seconds_per_work > 0 ? d.seconds_per_work : fastest);
  };
  return static_cast<std::size_t>(std::ranges::min_element(devices, {}, end) - devices.begin());
}

DevicePool::DevicePool(std::vector<std::unique_ptr<Device>> devices)
    : devices_(std::move(devices)), state_(std::make_unique<State>()) {
  assert(!devices_.empty());
  state_->loads.resize(devices_.size());
}

DevicePool::DevicePool(DevicePool&&) noexcept = default;
DevicePool::~DevicePool() = default;

DevicePool DevicePool::open(const std::vector<std::string>& which) {
  std::vector<std::unique_ptr<Device>> devices;
  for (const std::string& one : which) devices.push_back(Device::open(one));
  if (devices.empty()) devices.push_back(Device::open(""));
  return DevicePool(std::move(devices));
}

std::size_t DevicePool::choose(double work) {
  const std::lock_guard lock(state_->mutex);
  const std::size_t index = first_done(state_->loads, work);
  state_->loads[index].work += work;
  return index;
}

DevicePool::Use::Use(DevicePool& pool, std::size_t index, double work)
    : pool_(pool), index_(index), work_(work) {}

DevicePool::Use::~Use() {
  const std::lock_guard lock(pool_.state_->mutex);
  pool_.state_->loads[index_].work -= work_;
}

Device& DevicePool::Use::device() const { return *pool_.devices_[index_]; }

void DevicePool::Use::done(double seconds) {
  const std::lock_guard lock(pool_.state_->mutex);
  double& rate = pool_.state_->loads[index_].seconds_per_work;
  const double now = seconds / work_;
  rate = rate > 0 ? (1 - kNew) * rate + kNew * now : now;
}

std::vector<DeviceInfo> DevicePool::infos() const {
  std::vector<DeviceInfo> infos;
  for (const auto& device : devices_) infos.push_back(device->info());
  return infos;
}

DeviceLoad DevicePool::load(std::size_t index) const {
  const std::lock_guard lock(state_->mutex);
  return state_->loads.at(index);
}

}  // namespace tessera

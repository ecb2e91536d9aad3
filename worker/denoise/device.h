// SPDX-License-Identifier: Apache-2.0
// OpenCL devices: which there are, one of them opened, programs built once per process with their build log.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace tessera {

struct DeviceInfo {
  std::string name, platform, version, driver;
  std::string kind;  // "cpu", "gpu" or "other"
  int compute_units = 0;
  int native_float_width = 1;
  std::uint64_t memory = 0;  // bytes
};

// In a stable order; the index is what --device takes. Empty where OpenCL finds none.
std::vector<DeviceInfo> list_devices();

class Device {
 public:
  // By index, or by a part of the name (case-insensitive), or "" for the first CPU. Throws Error(no_device)
  // that lists what there is.
  static std::unique_ptr<Device> open(const std::string& which);
  virtual ~Device() = default;
  virtual const DeviceInfo& info() const = 0;
};

}  // namespace tessera

// SPDX-License-Identifier: Apache-2.0
// Where a coordinator listens or is found, as users write it.
#pragma once

#include <string>
#include <string_view>

namespace tessera {

inline constexpr std::string_view kFarmAddress = "127.0.0.1:7711";
inline constexpr std::string_view kHttpAddress = "127.0.0.1:7712";

struct HostPort {
  std::string host;  // a name or an address; of IPv6 without its brackets
  int port = 0;      // 0: any that is free
};

// "HOST:PORT", "[ADDRESS]:PORT"; a lone HOST gets `port`. Throws Error(bad_usage) that names the option.
HostPort parse_host_port(std::string_view option, std::string_view text, int port);

// What ZeroMQ calls it: of HOST:PORT tcp://HOST:PORT; what begins with ipc:// or inproc:// stays.
std::string endpoint_of(std::string_view option, std::string_view text, bool listening);

}  // namespace tessera

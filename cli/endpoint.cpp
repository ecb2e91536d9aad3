// SPDX-License-Identifier: Apache-2.0
#include "cli/endpoint.h"

#include <fmt/format.h>

#include <charconv>

#include "cli/picture_options.h"

namespace tessera {
namespace {

constexpr int kFarmPort = 7711;
constexpr std::string_view kAccepted = "HOST:PORT, [IPV6]:PORT or ipc://PATH";

std::size_t end_of_host(std::string_view text) {
  if (text.starts_with('[')) {
    const std::size_t bracket = text.find(']');
    return bracket == text.npos ? text.npos : bracket + 1;
  }
  return std::min(text.size(), text.find(':'));
}

bool is_host(std::string_view host) {
  return !host.empty() && host.size() <= 255 &&
         host.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.-_*:[]") ==
             host.npos;
}

}  // namespace

HostPort parse_host_port(std::string_view option, std::string_view text, int port) {
  const std::size_t end = end_of_host(text);
  if (end == text.npos || !is_host(text.substr(0, end))) refuse_option(option, text, kAccepted);
  std::string_view host = text.substr(0, end), rest = text.substr(end);
  if (host.starts_with('[')) host = host.substr(1, host.size() - 2);
  if (rest.empty()) return {std::string(host), port};
  rest.remove_prefix(1);
  int given = -1;
  const auto [last, error] = std::from_chars(rest.data(), rest.data() + rest.size(), given);
  const bool whole = error == std::errc() && last == rest.data() + rest.size();
  if (text[end] != ':' || !whole || given < 0 || given > 65535) refuse_option(option, text, kAccepted);
  return {std::string(host), given};
}

std::string endpoint_of(std::string_view option, std::string_view text, bool listening) {
  if (text.starts_with("ipc://") || text.starts_with("inproc://")) return std::string(text);
  if (text.starts_with("tcp://")) text.remove_prefix(6);
  const HostPort at = parse_host_port(option, text, kFarmPort);
  const std::string port = at.port == 0 && listening ? "*" : std::to_string(at.port);
  return at.host.find(':') == std::string::npos ? fmt::format("tcp://{}:{}", at.host, port)
                                                : fmt::format("tcp://[{}]:{}", at.host, port);
}

}  // namespace tessera

// SPDX-License-Identifier: Apache-2.0
// The shape of a subcommand. The table in main.cpp is the only list of them; help and dispatch come from it.
#pragma once

#include <CLI/CLI.hpp>

#include <functional>
#include <string_view>

namespace tessera {

struct Subcommand {
  std::string_view name, summary;
  // Adds the options to the parser and returns what runs once they are parsed; its result is the exit code.
  std::function<int()> (*describe)(CLI::App&);
};

int run_list_devices();  // what `devices` does, and render --list-devices

std::function<int()> describe_render(CLI::App&);
std::function<int()> describe_denoise(CLI::App&);
std::function<int()> describe_cancel(CLI::App&);
std::function<int()> describe_compare(CLI::App&);
std::function<int()> describe_coordinator(CLI::App&);
std::function<int()> describe_fetch(CLI::App&);
std::function<int()> describe_jobs(CLI::App&);
std::function<int()> describe_pause(CLI::App&);
std::function<int()> describe_priority(CLI::App&);
std::function<int()> describe_remove(CLI::App&);
std::function<int()> describe_release(CLI::App&);
std::function<int()> describe_resume(CLI::App&);
std::function<int()> describe_submit(CLI::App&);
std::function<int()> describe_verify(CLI::App&);
std::function<int()> describe_watch(CLI::App&);
std::function<int()> describe_worker(CLI::App&);
std::function<int()> describe_workers(CLI::App&);
std::function<int()> describe_devices(CLI::App&);
std::function<int()> describe_filters(CLI::App&);
std::function<int()> describe_keygen(CLI::App&);
std::function<int()> describe_scene(CLI::App&);
std::function<int()> describe_schema(CLI::App&);

}  // namespace tessera

// SPDX-License-Identifier: Apache-2.0
#include "cli/config_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdlib>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/nearest.h"

namespace tessera {
namespace {

// Those that have a variable of the environment can be configured.
std::vector<std::string_view> names_in(const CLI::App& app) {
  std::vector<std::string_view> names;
  for (const CLI::Option* option : app.get_options())
    if (!option->get_envname().empty() && !option->get_lnames().empty())
      names.push_back(option->get_lnames().front());
  return names;
}

std::vector<CLI::ConfigItem> items_of(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) throw InputError(file.string(), "cannot be read", "a configuration file in TOML");
  try {
    return CLI::ConfigTOML().from_config(stream);
  } catch (const CLI::Error& e) {
    throw InputError(file.string(), e.what(), "a configuration file in TOML");
  }
}

}  // namespace

void read_config(const std::filesystem::path& file, const CLI::App& app) {
  for (const CLI::ConfigItem& item : items_of(file)) {
    if (item.name == "++" || item.name == "--") continue;  // where sections begin and end
    const CLI::Option* option = app.get_option_no_throw("--" + item.name);
    if (!item.parents.empty() || option == nullptr || option->get_envname().empty())
      throw InputError(file.string(), unknown("option", item.fullname(), names_in(app)),
                       listed(names_in(app)));
    setenv(option->get_envname().c_str(), fmt::format("{}", fmt::join(item.inputs, ",")).c_str(), 0);
  }
}

std::filesystem::path config_file(int argc, char** argv) {
  constexpr std::string_view kOption = "--config";
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    if (word == kOption && i + 1 < argc) return argv[i + 1];
    if (word.starts_with(kOption) && word.substr(kOption.size()).starts_with('='))
      return word.substr(kOption.size() + 1);
  }
  const char* set = std::getenv("TESSERA_CONFIG");
  return set == nullptr ? "" : set;
}

}  // namespace tessera

// SPDX-License-Identifier: Apache-2.0
// `tessera keygen`: a new key pair, in two files.
#include <fmt/format.h>

#include "cli/subcommand.h"
#include "core/error.h"
#include "proto/keys.h"

namespace tessera {
namespace {

int keygen(const std::string& output) {
  const std::filesystem::path stem = output;
  if (!stem.has_filename())
    throw Error(ExitCode::bad_usage, output + ": names no file; accepted: FOLDER/NAME");
  const KeyPair pair = make_key_pair();
  write_key_files(stem, pair);
  fmt::print("public-key {}\n", pair.public_key);
  return 0;
}

}  // namespace

std::function<int()> describe_keygen(CLI::App& app) {
  auto output = std::make_shared<std::string>();
  app.add_option("-o,--output", *output,
                 "Where: FOLDER/NAME makes NAME.key, which is secret, and NAME.pub, which others may have")
      ->required()
      ->type_name("FOLDER/NAME");
  app.footer(
      "On a coordinator: --key its NAME.key and --allow a file with a line for each key that it lets in:\n"
      "  worker rack1 PUBLIC-KEY\n"
      "  submitter,administrator ada PUBLIC-KEY\n"
      "Elsewhere: --key the own NAME.key and --server-key the coordinator's NAME.pub. See docs/SECURITY.md.");
  return [output] { return keygen(*output); };
}

}  // namespace tessera

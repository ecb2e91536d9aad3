// SPDX-License-Identifier: Apache-2.0
#include "cli/key_options.h"

namespace tessera {
namespace {

void add_key(CLI::App& app, KeyFiles& files) {
  app.add_option("--key", files.key, "Secret key of this process, a file that only its owner may read")
      ->envname("TESSERA_KEY")
      ->type_name("FILE");
}

}  // namespace

void add_server_key_options(CLI::App& app, KeyFiles& files) {
  add_key(app, files);
  app.add_option(
         "--allow", files.allow,
         "Who is let in, a key a line: worker,submitter,administrator NAME PUBLIC-KEY; read again when "
         "it changes")
      ->envname("TESSERA_ALLOW")
      ->type_name("FILE");
}

void add_client_key_options(CLI::App& app, KeyFiles& files) {
  add_key(app, files);
  app.add_option("--server-key", files.server_key,
                 "Public key of the coordinator; its old and its new one, too")
      ->envname("TESSERA_SERVER_KEY")
      ->type_name("FILE");
}

}  // namespace tessera

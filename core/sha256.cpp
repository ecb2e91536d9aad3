// SPDX-License-Identifier: Apache-2.0
#include "core/sha256.h"

#include <openssl/evp.h>

#include <algorithm>
#include <fstream>
#include <span>
#include <stdexcept>
#include <vector>

namespace tessera {
namespace {

EVP_MD_CTX* as_context(void* context) { return static_cast<EVP_MD_CTX*>(context); }

// Found once: OpenSSL searches its providers at each EVP_sha256().
const EVP_MD* algorithm() {
  static const std::unique_ptr<EVP_MD, decltype(&EVP_MD_free)> found(EVP_MD_fetch(nullptr, "SHA256", nullptr),
                                                                     EVP_MD_free);
  return found.get();
}

}  // namespace

void Sha256::Free::operator()(void* context) const { EVP_MD_CTX_free(as_context(context)); }

Sha256::Sha256() : context_(EVP_MD_CTX_new()) {
  if (!context_ || EVP_DigestInit_ex2(as_context(context_.get()), algorithm(), nullptr) != 1)
    throw std::runtime_error("SHA-256 is not available");
}

void Sha256::add(const void* data, std::size_t bytes) {
  EVP_DigestUpdate(as_context(context_.get()), data, bytes);
}

std::string Sha256::hex() {
  constexpr std::string_view kDigits = "0123456789abcdef";
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned size = 0;
  EVP_DigestFinal_ex(as_context(context_.get()), digest, &size);
  std::string text;
  text.reserve(2 * size);
  for (const unsigned char byte : std::span(digest, size)) {
    text += kDigits[byte >> 4];
    text += kDigits[byte & 15];
  }
  return text;
}

std::string sha256(std::string_view bytes) {
  Sha256 hash;
  hash.add(bytes.data(), bytes.size());
  return hash.hex();
}

std::string sha256_of_file(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  Sha256 hash;
  std::vector<char> buffer(std::size_t{1} << 20);
  while (stream) {
    stream.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
    hash.add(buffer.data(), static_cast<std::size_t>(stream.gcount()));
  }
  return stream.eof() ? hash.hex() : "";
}

bool is_digest(std::string_view text) {
  const auto digit = [](char c) { return ('0' <= c && c <= '9') || ('a' <= c && c <= 'f'); };
  return text.size() == 64 && std::ranges::all_of(text, digit);
}

}  // namespace tessera

// SPDX-License-Identifier: Apache-2.0
// A coordinator that knows blobs and nothing else, in simulated time: it takes and gives pieces as
// proto/questions.h says.
#pragma once

#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "proto/client.h"
#include "proto/memory_transport.h"

namespace tessera {

class BlobServer {
 public:
  std::map<Digest, std::string> whole, partial;
  std::uint64_t put_bytes = 0, put_pieces = 0, got_pieces = 0;
  std::vector<Instant> asked;  // when, of each question
  std::string spoil;           // added to each piece that goes out
  std::optional<Denied> denies;
  bool deaf = false;
  int crash_every = 0;   // questions after which it forgets half of what is partial; 0: never
  bool forgets = false;  // takes pieces and keeps nothing

  std::string put(std::string bytes) {
    const Digest digest = sha256(bytes);
    whole[digest] = std::move(bytes);
    return digest;
  }

  void serve(Transport& road, Instant now) {
    while (auto mail = road.receive(now)) {
      auto* ask = std::get_if<Ask>(&mail->message);
      if (!ask) continue;
      asked.push_back(now);
      if (deaf) continue;
      if (crash_every > 0 && asked.size() % static_cast<std::size_t>(crash_every) == 0)
        for (auto& [digest, bytes] : partial) bytes.resize(bytes.size() / 2);
      road.send(mail->from, Answer{ask->number, denies ? Reply(*denies) : std::visit(*this, ask->question)});
    }
  }

  Reply operator()(const WhichLack& q) {
    Lacking lacking;
    for (const Digest& d : q.blobs)
      if (!whole.contains(d)) lacking.blobs.push_back({d, partial[d].size()});
    return lacking;
  }
  Reply operator()(const PutPiece& q) {
    ++put_pieces;
    put_bytes += q.bytes.size();
    if (whole.contains(q.blob)) return Agreed{};
    std::string& bytes = partial[q.blob];
    if (q.offset > bytes.size()) return Lacking{{{q.blob, bytes.size()}}};
    if (q.offset + q.bytes.size() > bytes.size()) bytes.replace(q.offset, std::string::npos, q.bytes);
    if (bytes.size() < q.size) return Agreed{};
    const std::string all = std::move(bytes);
    partial.erase(q.blob);
    if (sha256(all) != q.blob) return Denied{ExitCode::bad_input, "the bytes are not those of the digest"};
    if (!forgets) whole[q.blob] = all;
    return Agreed{};
  }
  Reply operator()(const GetPiece& q) {
    ++got_pieces;
    const auto at = whole.find(q.blob);
    if (at == whole.end() || q.offset > at->second.size())
      return Denied{ExitCode::bad_usage, "there is no such blob, or it is shorter"};
    Piece piece{q.blob, at->second.size(), q.offset, at->second.substr(q.offset, kPieceBytes)};
    if (!spoil.empty() && !piece.bytes.empty()) piece.bytes.replace(0, 1, spoil);
    return piece;
  }
  template <class Other>
  Reply operator()(const Other&) {
    return Agreed{};
  }
};

// A client and a server on a road, whose time passes when the client waits.
class BlobWorld {
 public:
  explicit BlobWorld(const Weather& weather = {})
      : road_(weather, [this] { return now_; }), door_(road_.join("coordinator")) {}

  BlobServer server;

  FarmClient client(std::function<bool()> stop = {}) {
    ClientOptions options;
    options.stop = std::move(stop);
    options.now = [this] { return now_; };
    return FarmClient(std::make_unique<Waiting>(*this, road_.join("client-" + std::to_string(++clients_))),
                      options);
  }
  Instant now() const { return now_; }

 private:
  class Waiting : public Transport {
   public:
    Waiting(BlobWorld& world, std::unique_ptr<Transport> road) : world_(world), road_(std::move(road)) {}
    void send(const Peer& to, Message message) override { road_->send(to, std::move(message)); }
    std::optional<Mail> receive(Instant until) override {
      for (;;) {
        world_.server.serve(*world_.door_, world_.now_);
        if (auto mail = road_->receive(world_.now_)) return mail;
        const auto next = world_.road_.next_arrival();
        world_.now_ = std::max(world_.now_, next ? std::min(*next, until) : until);
        if (!next || *next > until) return std::nullopt;
      }
    }
    void wake() override {}

   private:
    BlobWorld& world_;
    std::unique_ptr<Transport> road_;
  };

  Instant now_{};
  int clients_ = 0;
  MemoryRoad road_;
  std::unique_ptr<Transport> door_;
};

// Different for every seed.
inline std::string noise(std::size_t bytes, unsigned seed) {
  std::string text(bytes, '\0');
  std::uint32_t x = seed * 2654435761u + 1;
  for (char& c : text) c = static_cast<char>((x = x * 1664525u + 1013904223u) >> 24);
  return text;
}

}  // namespace tessera

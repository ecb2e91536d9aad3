// SPDX-License-Identifier: Apache-2.0
#include "proto/rights.h"

#include <variant>

namespace tessera {
namespace {

template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;  // clang 14 has to be told

}  // namespace

bool may_say(const Identity& who, const Message& message) {
  return who.worker || std::holds_alternative<Ask>(message);
}

std::optional<std::string> why_not(const Identity& who, const Question& question) {
  const auto needs = [&](bool has, const char* roles) -> std::optional<std::string> {
    if (has) return std::nullopt;
    return "the key '" + who.name + "' may not ask this; accepted: keys of " + roles;
  };
  const auto submits = [&](const auto&) {
    return needs(who.submitter || who.administrator, "submitters and administrators");
  };
  return std::visit(Overloaded{
                        [](const auto&) -> std::optional<std::string> { return std::nullopt; },  // to look
                        [&](const WhichLack& q) { return submits(q); },
                        [&](const PutPiece& q) { return submits(q); },
                        [&](const Submit& q) { return submits(q); },
                        [&](const Control& q) { return submits(q); },
                        [&](const ReleaseWorker&) { return needs(who.administrator, "administrators"); },
                    },
                    question);
}

}  // namespace tessera

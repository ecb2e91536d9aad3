// SPDX-License-Identifier: Apache-2.0
// Checks a JSON value against a JSON Schema: the one place where keys, types and ranges of the native scene
// format are said is docs/scene.schema.json, and the messages are made from it.
#pragma once

#include <string>

#include "core/scene/json.h"

namespace tessera {

// Throws InputError at file:/json/pointer for the first thing in `value` that `schema` refuses. Understands
// what our schema uses of draft-07: type, properties, additionalProperties, required, items, minItems,
// maxItems, minimum, maximum, exclusiveMinimum, enum and const of strings, patterns "^(one|other)$", $ref to
// #/definitions, allOf, `anyOf` and `not` over required, and `oneOf` whose alternatives differ in a constant
// `type`. Any other keyword that could refuse a value throws std::logic_error.
void check_schema(const Json& value, const Json& schema, const std::string& file);

// What `schema`, a part of `root`, accepts, in words: "a number from 0 to 1".
std::string accepted(const Json& schema, const Json& root);

}  // namespace tessera

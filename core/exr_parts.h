// SPDX-License-Identifier: Apache-2.0
// The parts of an OpenEXR file as the layers of one image. Of core/exr: nobody else sees OpenEXR.
#pragma once

#include <OpenEXR/ImfAttribute.h>

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "core/exr.h"

namespace tessera {

struct ExrAttributes {
  std::map<std::string, std::unique_ptr<const Imf::Attribute>> by_name;
};

// Of a file of so many bytes whose headers were looked at (core/exr_header.h). Throws InputError as read_exr
// does, and what OpenEXR throws.
ExrImage read_exr_parts(const std::string& file, std::uintmax_t bytes, std::int64_t most_values);

}  // namespace tessera

// SPDX-License-Identifier: Apache-2.0
// The values inside messages, to Protobuf and back with every number checked. Private to the codec.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "proto/message.h"
#include "proto/tessera.pb.h"

namespace tessera {

// Throws ProtocolError{field, what} unless `good`.
void require(bool good, std::string_view field, std::string_view what);

void to_wire(const SampleRange&, wire::SampleRange&);
void to_wire(const RenderTask&, wire::RenderTask&);
void to_wire(const FilterTask&, wire::FilterTask&);
void to_wire(const Job&, wire::Job&);
// Region and number of planes.
void shape_to_wire(const Image&, wire::Planes&);
// Moves the image's floats to the end of `pixels`.
void to_wire(Image&&, wire::Planes&, Floats& pixels);

std::string text_from(const std::string&, std::size_t most, std::string_view field);
int whole_from(std::int64_t value, int low, int high, std::string_view field);
double seconds_from(double, std::string_view field);                         // finite, not negative
Region region_from(const wire::Region&, std::string_view field);             // with pixels, in a frame
SampleRange samples_from(const wire::SampleRange&, std::string_view field);  // a node of the sample tree
RenderTask task_from(const wire::RenderTask&);
FilterTask task_from(const wire::FilterTask&);
Job job_from(const wire::Job&);
// Of the floats that `planes` speaks of.
std::size_t bytes_of(const wire::Planes&, std::string_view field);
Image image_from(const wire::Planes&, std::span<const std::byte> bytes, std::string_view field);

}  // namespace tessera

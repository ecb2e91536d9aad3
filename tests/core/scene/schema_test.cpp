// SPDX-License-Identifier: Apache-2.0
// The schema that is published, our reader of it, and an independent validator (Valijson) agree.
#include "core/scene/schema.h"

#include <gtest/gtest.h>

#include <array>
#include <functional>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "core/scene/native/material_fields.h"
#include "core/scene/native/metals.h"
#include "tests/core/scene/folder.h"

namespace tessera {
namespace {

using nlohmann::json;

class SchemaAgreement : public testing::Test {
 protected:
  SchemaAgreement() : ours_(parse_json(scene_schema(), "schema")), theirs_json_(json::parse(scene_schema())) {
    valijson::SchemaParser(valijson::SchemaParser::kDraft7)
        .populateSchema(valijson::adapters::NlohmannJsonAdapter(theirs_json_), theirs_);
  }

  bool we_accept(const json& document) const {
    try {
      check_schema(parse_json(document.dump(), "f"), ours_, "f");
      return true;
    } catch (const InputError&) {
      return false;
    }
  }
  bool they_accept(const json& document) {
    return valijson::Validator().validate(theirs_, valijson::adapters::NlohmannJsonAdapter(document),
                                          nullptr);
  }

  Json ours_;
  json theirs_json_;
  valijson::Schema theirs_;
};

// Every value in `document`, by pointer.
std::vector<json::json_pointer> pointers_in(const json& document) {
  std::vector<json::json_pointer> pointers;
  const json flat = document.flatten();
  for (const auto& [pointer, value] : flat.items()) {
    json::json_pointer p(pointer);
    for (; !p.empty(); p.pop_back()) pointers.push_back(p);
  }
  return pointers;
}

json mutated(json document, std::mt19937& random) {
  static const std::vector<json> values{nullptr,
                                        true,
                                        -1,
                                        0,
                                        0.5,
                                        1,
                                        2,
                                        1e10,
                                        400,
                                        "x",
                                        "Y",
                                        "mirror",
                                        json::array(),
                                        json::object(),
                                        {1, 2, 3},
                                        {{"file", "x"}},
                                        {0.1, 0.2}};
  const auto pointers = pointers_in(document);
  const json::json_pointer at = pointers[random() % pointers.size()];
  json& parent = document[at.parent_pointer()];
  switch (random() % 4) {
    case 0:
      if (parent.is_object())
        parent.erase(at.back());
      else
        parent.erase(static_cast<std::size_t>(std::stoul(at.back())));
      break;
    case 1:
      if (parent.is_object())
        parent["unknown"] = 1;
      else
        parent.push_back(parent[0]);
      break;
    default:
      document[at] = values[random() % values.size()];
  }
  return document;
}

TEST_F(SchemaAgreement, OnScenesThatAreGood) {
  for (const auto& file : {kData / "all.json", kData / "full.json", kData / "../../../scenes/cornell.json",
                           kData / "../../../scenes/furnace.json"}) {
    const json document = json::parse(contents(file));
    EXPECT_TRUE(we_accept(document)) << file;
    EXPECT_TRUE(they_accept(document)) << file;
  }
}

TEST_F(SchemaAgreement, OnThousandsOfSpoiltScenes) {
  const std::array good{json::parse(contents(kData / "all.json")),
                        json::parse(contents(kData / "full.json"))};
  int refused = 0;
  for (unsigned seed = 0; seed < 3000; ++seed) {
    std::mt19937 random(seed);
    const json document = mutated(good[seed % 2], random);
    const bool ours = we_accept(document);
    ASSERT_EQ(ours, they_accept(document)) << "seed " << seed << "\n" << document.dump(1);
    refused += !ours;
  }
  EXPECT_GT(refused, 1000);
  EXPECT_LT(refused, 2900);
}

// A number without both ends could become an infinite float.
void expect_bounded(const json& part, const std::string& at) {
  if (part.is_object() && part.contains("type")) {
    const json& type = part["type"];
    const auto has = [&](const char* t) {
      return type == t || (type.is_array() && std::count(type.begin(), type.end(), t));
    };
    if (has("number") || has("integer")) {
      EXPECT_TRUE(part.contains("maximum")) << at;
      EXPECT_TRUE(part.contains("minimum") || part.contains("exclusiveMinimum")) << at;
    }
    EXPECT_TRUE(type != "object" || part.contains("additionalProperties")) << at;
    EXPECT_TRUE(!has("array") || part.contains("maxItems")) << at;
  }
  if (part.is_structured())
    for (const auto& [key, value] : part.items())
      if (key != "default") expect_bounded(value, at + "/" + key);
}

TEST(Schema, BoundsEveryNumberAndArrayAndClosesEveryObject) {
  expect_bounded(json::parse(scene_schema()), "");
}

TEST(Schema, StatesTheDefaultsThatTheReaderHas) {
  const json schema = json::parse(scene_schema());
  const auto& properties = schema["definitions"]["material"]["properties"];
  const Material m;
  const auto stated = [&](std::string_view key) { return properties[std::string(key)]["default"]; };
  for (const auto& [key, field] : kNumbers) EXPECT_EQ(stated(key).get<float>(), m.*field) << key;
  for (const auto& [key, field] : kFlags) EXPECT_EQ(stated(key).get<bool>(), m.*field) << key;
  for (const auto& [key, field] : kColors)
    for (int c = 0; c < 3; ++c) {
      const json value = stated(key);
      EXPECT_EQ((value.is_array() ? value[static_cast<std::size_t>(c)] : value).get<float>(), (m.*field)[c])
          << key;
    }
}

template <class Table>
void expect_names(const json& stated, const Table& known) {
  ASSERT_EQ(stated.size(), known.size());
  for (const auto& [name, value] : known)
    EXPECT_EQ(std::count(stated.begin(), stated.end(), name), 1) << name;
}

// Every key below `part`, with what is said of it.
void for_each_property(const json& part, const std::function<void(const std::string&, const json&)>& see) {
  if (!part.is_structured()) return;
  if (part.is_object() && part.contains("properties"))
    for (const auto& [key, property] : part["properties"].items()) see(key, property);
  for (const auto& [key, value] : part.items()) for_each_property(value, see);
}

std::string spaceless(std::string text) {
  std::erase(text, ' ');
  return text;
}

TEST(Schema, IsWhatTheDocumentSays) {
  std::vector<std::string> lines;
  std::stringstream document(contents(std::filesystem::path(TESSERA_SOURCE_DIR) / "docs/SCENE.md"));
  for (std::string line; std::getline(document, line);) lines.push_back(spaceless(line));
  for_each_property(json::parse(scene_schema()), [&](const std::string& key, const json& property) {
    const auto has = [](const std::string& line, const std::string& text) {
      return line.find(text) != line.npos;
    };
    const auto says = [&](const std::string& line) {
      return line.starts_with("|`" + key + "`|") &&
             (!property.contains("default") ||
              has(line, "|`" + spaceless(property["default"].dump()) + "`|")) &&
             (!property.contains("description") || has(line, spaceless(property["description"])));
    };
    EXPECT_TRUE(std::any_of(lines.begin(), lines.end(), says)) << key << ": " << property;
  });
}

TEST(Schema, NamesWhatTheReaderKnows) {
  const json schema = json::parse(scene_schema());
  const auto& properties = schema["definitions"]["material"]["properties"];
  expect_names(properties["type"]["enum"], kKinds);
  expect_names(properties["alpha_mode"]["enum"], kAlphas);
  expect_names(properties["metal"]["enum"], kMetals);
  EXPECT_EQ(schema["properties"]["light_groups"]["maxItems"], kMaxLightGroups);
}

}  // namespace
}  // namespace tessera

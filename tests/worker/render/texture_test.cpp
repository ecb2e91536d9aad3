// SPDX-License-Identifier: Apache-2.0
// Textures: what a lookup returns.
#include "worker/render/texture.h"

#include <gtest/gtest.h>

#include "tests/worker/render/chi_squared.h"
#include "tests/worker/render/textures.h"
#include "worker/render/mip_map.h"

namespace tessera::tracer {
namespace {

using tessera::testing::Random;
using Wrap = Texture::Wrap;

TEST_F(TextureTest, IsBilinearBetweenPixelCentresAndWraps) {
  add(4, 1, 1, {0, 1, 2, 3});
  const Textures textures(scene_, cache());
  const auto at = [&](float u, Wrap wrap) {
    return textures.lookup({.picture = 0, .wrap_u = wrap, .wrap_v = wrap}, {u, 0.3f}, 0)[0];
  };
  for (const Wrap w : {Wrap::repeat, Wrap::mirror, Wrap::clamp}) {
    EXPECT_FLOAT_EQ(at(0.125f, w), 0);
    EXPECT_FLOAT_EQ(at(0.5f, w), 1.5f);
  }
  EXPECT_FLOAT_EQ(at(0, Wrap::repeat), 1.5f);  // between the last and the first
  EXPECT_FLOAT_EQ(at(0, Wrap::clamp), 0);
  EXPECT_FLOAT_EQ(at(1, Wrap::mirror), 3);
  EXPECT_FLOAT_EQ(at(1.125f, Wrap::repeat), 0);
  EXPECT_FLOAT_EQ(at(-0.125f, Wrap::repeat), 3);
  EXPECT_FLOAT_EQ(at(1.125f, Wrap::mirror), 3);
  EXPECT_FLOAT_EQ(at(-0.375f, Wrap::mirror), 1);
  EXPECT_FLOAT_EQ(at(7, Wrap::clamp), 3);
  EXPECT_TRUE(std::isfinite(at(1e30f, Wrap::mirror)) && std::isfinite(at(-INFINITY, Wrap::repeat)));
  textures.require_sound();
}

TEST_F(TextureTest, TheTwoEdgesWrapEachInItsWay) {
  add(2, 2, 1, {1, 2, 3, 4});
  const Textures textures(scene_, cache());
  const Texture t{.picture = 0, .wrap_u = Wrap::repeat, .wrap_v = Wrap::clamp};
  EXPECT_FLOAT_EQ(textures.lookup(t, {1.25f, 5}, 0)[0], 3);
  EXPECT_FLOAT_EQ(textures.lookup(t, {1.75f, -5}, 0)[0], 2);
}

TEST_F(TextureTest, IsTheTexelItselfAtItsCentreAndRowZeroIsTheTop) {
  Random random(1);
  std::vector<float> pixels(70 * 130 * 3);  // more than one tile of the file, and odd levels
  for (float& v : pixels) v = random.number();
  add(70, 130, 3, pixels);
  const Textures textures(scene_, cache());
  for (int y = 0; y < 130; ++y)
    for (int x = 0; x < 70; ++x) {
      const Texel t = textures.lookup({.picture = 0}, {(x + 0.5f) / 70, (y + 0.5f) / 130}, 0);
      // The centre is where it is up to the rounding of 130 v.
      for (std::size_t c = 0; c < 3; ++c)
        ASSERT_NEAR(t[c], pixels[(std::size_t(y) * 70 + x) * 3 + c], 5e-5f) << x << ' ' << y;
    }
}

TEST_F(TextureTest, GreyPicturesAreGreyAndAlphaIsOneUnlessGiven) {
  add(1, 1, 2, {0.25f, 0.5f});
  add(1, 1, 3, {0.1f, 0.2f, 0.3f});
  add(1, 1, 4, {0.1f, 0.2f, 0.3f, 0.4f});
  add(1, 1, 1, {0.7f});
  const Textures textures(scene_, cache());
  const std::array<Texel, 4> expected{Texel{0.25f, 0.25f, 0.25f, 0.5f}, Texel{0.1f, 0.2f, 0.3f, 1},
                                      Texel{0.1f, 0.2f, 0.3f, 0.4f}, Texel{0.7f, 0.7f, 0.7f, 1}};
  for (std::size_t p = 0; p < 4; ++p)
    for (std::size_t c = 0; c < 4; ++c)
      EXPECT_FLOAT_EQ(textures.lookup({.picture = int(p)}, {0, 0}, 0)[c], expected[p][c]);
}

TEST_F(TextureTest, AConstantIsConstantAtEveryWidth) {
  add(37, 64, 1, std::vector<float>(37 * 64, 0.3f));
  const Textures textures(scene_, cache());
  for (float width = 1e-4f; width < 4; width *= 1.3f)
    EXPECT_NEAR(textures.lookup({.picture = 0}, {width * 7, 0.123f}, width)[0], 0.3f, 1e-6f) << width;
}

TEST_F(TextureTest, AWideFootprintSeesTheLinearMeanOfAnSrgbCheckerboard) {
  const auto checks = [](int x, int y) { return (x + y) % 2 ? 255 : 0; };
  place(folder_.write("checks.tga", targa(64, 64, checks)));
  const Textures textures(scene_, cache());
  EXPECT_NEAR(textures.lookup({.picture = 0}, {0.5f / 64, 0.5f / 64}, 0)[0], 0, 1e-6f);
  EXPECT_NEAR(textures.lookup({.picture = 0}, {1.5f / 64, 0.5f / 64}, 0)[0], 1, 1e-6f);
  for (const float width : {2.0f / 64, 0.1f, 0.7f, 1.0f, 100.0f})
    EXPECT_NEAR(textures.lookup({.picture = 0}, {0.31f, 0.77f}, width)[0], 0.5f, 1e-6f)
        << "and not 0.21, which is sRGB 128; width " << width;
  EXPECT_NEAR(textures.average({.picture = 0}).x, 0.5f, 1e-6f);
}

TEST_F(TextureTest, EncodingIsByRole) {
  const auto file = folder_.write("grey.tga", targa(4, 4, [](int, int) { return 188; }));
  const int srgb = place(file, Encoding::srgb), linear = place(file, Encoding::linear);
  const Textures textures(scene_, cache());
  const float half_ulp = 1.0f / 2048;  // relative, of a half float
  EXPECT_NEAR(textures.lookup({.picture = srgb}, {0.5f, 0.5f}, 0)[0], 0.502886f, 0.5f * half_ulp);
  EXPECT_NEAR(textures.lookup({.picture = linear}, {0.5f, 0.5f}, 0)[0], 188.0f / 255, 0.75f * half_ulp);
}

// Stripes a texel wide: all of the second level is grey.
TEST_F(TextureTest, WidthsAreMeasuredByTheAreaOfTexelsOfAPictureThatIsNotSquare) {
  std::vector<float> pixels;
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 64; ++x) pixels.push_back(x % 2 ? 1.0f : 0.0f);
  add(64, 16, 1, pixels);
  const Textures textures(scene_, cache());
  const float texel = 1 / std::sqrt(64.0f * 16);
  const auto at = [&](float width) { return textures.lookup({.picture = 0}, {0.5f / 64, 0.5f}, width)[0]; };
  EXPECT_NEAR(at(texel), 0, 1e-6f);
  EXPECT_NEAR(at(2 * texel), 0.5f, 1e-6f);
  EXPECT_GT(at(1.5f * texel), 0.1f);
  EXPECT_LT(at(1.5f * texel), 0.4f);
}

TEST_F(TextureTest, TheMeanOfAPictureIsTheSameInEverySize) {
  Random random(2);
  for (const auto& [width, height] : {std::pair{5, 3}, {17, 9}, {64, 64}, {99, 33}, {1, 7}, {6, 1}}) {
    Picture p{"noise", width, height, 2, {}};
    double sum[2] = {};
    for (int i = 0; i < width * height * 2; ++i) {
      p.pixels.push_back(random.number() < 0.1f ? 10.0f : 0.0f);
      sum[i % 2] += p.pixels.back();
    }
    const int levels = mip_levels(p);
    for (int level = 1; level < levels; ++level) p = half_size(p);
    ASSERT_EQ(p.pixels.size(), 2u);
    for (std::size_t c = 0; c < 2; ++c)
      EXPECT_NEAR(p.pixels[c], sum[c] / (width * height), 1e-5) << width << " x " << height;
  }
}

TEST_F(TextureTest, UdimTilesAreChosenByTheWholePartsOfUAndOneMinusV) {
  for (const auto& [number, grey] : {std::pair{1001, 51}, {1002, 102}, {1011, 153}})
    folder_.write("skin." + std::to_string(number) + ".tga",
                  targa(8, 8, [g = grey](int x, int y) { return x == 0 && y == 0 ? 255 : g; }));
  folder_.write("skin.100.tga", "no tile");
  place(folder_.path() / "skin.<UDIM>.tga", Encoding::linear);
  const Textures textures(scene_, cache());
  const auto at = [&](float u, float v) { return textures.lookup({.picture = 0}, {u, v}, 0); };
  EXPECT_NEAR(at(0.5f, 0.5f)[0], 0.2f, 1e-4f);
  EXPECT_NEAR(at(1.5f, 0.5f)[0], 0.4f, 2e-4f);
  EXPECT_NEAR(at(0.5f, -0.5f)[0], 0.6f, 3e-4f) << "the second row is above the first, and v goes down";
  EXPECT_NEAR(at(1.0f + 0.5f / 8, 0.5f / 8)[0], 1, 1e-5f) << "the top left corner of a tile";
  EXPECT_NEAR(at(1.001f, 0.5f)[0], 0.4f, 2e-4f) << "a tile ends at its edge";
  for (const Vec2& missing : {Vec2(2.5f, 0.5f), Vec2(-0.5f, 0.5f), Vec2(0.5f, 1.5f), Vec2(1.5f, -0.5f),
                              Vec2(1e30f, -1e30f), Vec2(NAN, 0.5f)})
    EXPECT_EQ(at(missing.x, missing.y), (Texel{0, 0, 0, 0}));
  textures.require_sound();
}

}  // namespace
}  // namespace tessera::tracer
